import sys

import pytest

from palms.cli import _outputs
from palms.cli._outputs import check_file, check_folder, progress, table, write_result
from palms.errors import OutputError


def test_checks_leave_no_trace(tmp_path):
    check_file(tmp_path / "a.json")
    check_folder(tmp_path / "a" / "b" / "c")
    assert list(tmp_path.iterdir()) == []


def test_nothing_to_check():
    check_file(None)
    check_folder(None)


def test_relative_folder(tmp_path, monkeypatch):
    from pathlib import Path

    monkeypatch.chdir(tmp_path)
    check_folder(Path("out"))
    check_file(Path("a.json"))


def test_write_result_refuses_nan(tmp_path):
    with pytest.raises(OutputError):
        write_result({"x_m": float("nan")}, tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []


def test_text_to_the_left_numbers_to_the_right():
    assert table(["", "n"], [["a", "1"], ["bc", "-10"]]) == ["      n", "a     1", "bc  -10"]


def test_progress_is_silent_in_a_pipe(capsys):
    with progress(5, "Working") as advance:
        advance()
    assert capsys.readouterr() == ("", "")


def test_progress_on_a_terminal_goes_to_standard_error(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress(2, "Working") as advance:
        advance()
        advance()
    out, err = capsys.readouterr()
    assert out == ""
    assert "Working" in err


def test_probe_says_why(tmp_path, monkeypatch):
    def full(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(_outputs.Path, "touch", full)
    with pytest.raises(OutputError, match="No space left"):
        check_file(tmp_path / "a.json")
