"""A real server process, killed in the middle: nothing is lost, and the state is the same."""

import json
import re
import signal
import ssl
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from tests.server.conftest import Phone, new_store, scan, whole_walk

INPUTS = [*whole_walk(), {"type": "hint", "seq": 15, "room": "Study"}, scan(16, 120.0)]


class Served:
    """``palms serve`` in a process of its own."""

    def __init__(self, folder, *options):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "palms", "serve", "--port", "0", "--data", folder, *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        line = self.process.stdout.readline()
        found = re.search(r"https?://[\w.:]+", line)
        assert found, line + self.process.stderr.read()
        self.url = found.group()
        self.said = line

    def kill(self):
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def served(tmp_path):
    """Start servers over one folder; those that still run are killed in the end."""
    folder, started = new_store(tmp_path / "data"), []

    def start(*options):
        started.append(Served(folder, *options))
        return started[-1]

    yield start
    for each in started:
        each.kill()


def frames(phone, seq):
    """Particles after an input, all of them."""
    while not phone.frames or phone.frames[-1].seq < seq:
        phone.next()
    return phone.frames[-1]


def test_kill_9_in_the_middle_and_the_state_is_the_same_to_the_bit(served):
    first = served()
    phone, other = Phone(first.url), Phone(first.url)
    hello = {"receive": ["estimates", "particles"], "particles": 1000, "max_particles": 1000}
    welcome = phone.hello(**hello)
    other.hello(**hello)
    whole = other.walk(INPUTS)
    particles = frames(other, 16)
    before = phone.walk(INPUTS[:9])
    for message in INPUTS[9:]:
        phone.say(message)  # whatever of it is stored when the server dies
    phone.until("ack", seq=11)
    first.kill()
    second = served()
    again = Phone(second.url)
    back = again.hello(session=welcome["session"], key=welcome["key"], **hello)
    assert back["resumed"]
    assert 12 <= back["next_seq"] <= 17  # all that was acknowledged is there
    restored = again.until("estimate")
    assert restored["seq"] == back["next_seq"] - 1
    again.say(json.dumps(INPUTS[9]))
    assert again.until("ack")["status"] == "repeated"
    assert before["seq"] < restored["seq"]
    last = again.walk(INPUTS[back["next_seq"] - 1 :]) if back["next_seq"] <= 16 else restored
    assert last == whole
    found = frames(again, 16)
    assert found.position_m.tobytes() == particles.position_m.tobytes()
    assert found.label.tobytes() == particles.label.tobytes()


def test_another_address_speaks_tls_and_needs_the_token_that_is_shown(served):
    server = served("--host", "0.0.0.0", "--tls")
    assert server.url.startswith("https://")
    assert "SHA-256" in server.process.stdout.readline()
    token = re.search(r"once: (\S+)", server.process.stdout.readline()).group(1)
    with pytest.raises(httpx.ConnectError):
        httpx.get(server.url + "/health")
    folder = Path(server.process.args[7])
    trust = ssl.create_default_context(cafile=folder / "tls" / "certificate.pem")
    operator = {"Authorization": f"Bearer {token}"}
    with httpx.Client(base_url=server.url, verify=trust, timeout=60) as rest:
        assert rest.get("/health").status_code == 200
        assert rest.get("/health", headers={"Host": "elsewhere.example"}).status_code == 421
        assert rest.get("/api/v1/sessions").status_code == 401
        assert rest.get("/api/v1/sessions", headers=operator).status_code == 200
    phone = Phone(server.url, ssl=trust, additional_headers=operator)
    phone.hello()
    assert phone.walk(whole_walk()[:3])["x_m"] is not None
    assert (folder / "tls" / "key.pem").stat().st_mode & 0o077 == 0
    server.process.send_signal(signal.SIGTERM)
    assert phone.rest()[1] in (1012, 1001)
    errors = server.process.communicate(timeout=120)[1]
    assert server.process.returncode in (0, -signal.SIGTERM)
    assert "Traceback" not in errors
