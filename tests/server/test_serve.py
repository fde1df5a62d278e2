"""``palms serve`` where it cannot."""

import socket
import sys

import pytest
from typer.testing import CliRunner

from palms.cli.app import app
from palms.errors import PalmsError
from palms.server.application import Setup
from palms.server.gate import Gate
from palms.server.running import Place, in_background
from palms.server.store import FILE


def fails(*arguments):
    result = CliRunner().invoke(app, ["serve", *map(str, arguments)])
    assert result.exit_code == 1, result.output
    (line,) = [each for each in result.stderr.splitlines() if "note:" not in each]
    assert line.startswith("palms: error: ")
    return line


@pytest.fixture(autouse=True)
def cold(monkeypatch):
    monkeypatch.setattr("palms.cli.serve._warm_up", lambda: None)
    before = sys.getswitchinterval()
    yield
    sys.setswitchinterval(before)


def test_what_is_missing_is_named_with_its_extra(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    assert "palms-localization[server]" in fails("--data", tmp_path)


def test_options_that_cannot_be_are_said_in_one_line(tmp_path):
    data = ("--data", tmp_path / "data")
    assert "colour" in fails(*data, "--limit", "colour=3")
    assert "sessions" in fails(*data, "--limit", "sessions=-1")
    (tmp_path / "token").write_text("short\n")
    assert "16 characters" in fails(*data, "--token-file", tmp_path / "token")
    assert "both" in fails(*data, "--tls-cert", tmp_path / "token")
    both = ("--tls-cert", tmp_path / "token", "--tls-key", tmp_path / "token")
    assert "certificate" in fails(*data, *both)
    assert "address" in fails(*data, "--host", "203.0.113.7")


def test_an_open_gate_is_for_this_machine_alone(tmp_path):
    setup = Setup(tmp_path / "data", Gate())
    with pytest.raises(PalmsError, match="a token"), in_background(setup, Place("0.0.0.0", 0)):
        pass


def test_a_port_in_use_and_a_store_of_others_are_said_in_one_line(tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert "free" in fails("--data", tmp_path / "data", "--port", port)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / FILE).write_bytes(b"rubbish" * 1000)
    assert "store of palms" in fails("--data", tmp_path / "other", "--port", 0)
    (tmp_path / "file").write_text("")
    assert "folder" in fails("--data", tmp_path / "file")
