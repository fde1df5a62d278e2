"""The Python client, and apps that push readings."""

import json

import httpx
import numpy as np
import pytest

import palms
from palms.client import Client
from palms.errors import InputError, PalmsError
from palms.inertial import dead_reckon
from palms.server import messages
from tests.server.conftest import hall, http, positions, scan_walls
from tests.server.test_reckoner import walked


def moves():
    before = np.zeros(2)
    for step, place in enumerate(np.array(positions()), 1):
        dx, dy = (place - before).tolist()
        yield palms.Move(0.5 * step, dx, dy)
        before = place


def test_a_session_through_the_client_is_the_localizer_s(server):
    scan = palms.Scan(np.array(scan_walls()))
    localizer = palms.Localizer(hall(), palms.Settings().with_particles(400), rng=7)
    localizer.observe(scan)
    client = Client(server)
    assert "hall" in [building.id for building in client.buildings()]
    with client.session("hall", seed=7, particles=400) as session:
        session.observe(scan)
        for move in moves():
            answer = session.move(move)
            expected = localizer.move(move)
        assert [answer.x_m, answer.y_m] == pytest.approx(expected.position_m.tolist())
        hinted = localizer.hint(palms.Hint(room="Study"))
        assert session.hint(palms.Hint(room="Study")).x_m == pytest.approx(hinted.position_m[0])
        assert session.events[0].kind == "scanning"
        with pytest.raises(InputError, match="nowhere"):
            session.hint(palms.Hint(room="nowhere"))
    with pytest.raises(PalmsError, match="no such session"):
        client.resume(session.welcome.session, session.key)


def test_a_connection_that_breaks_is_made_anew_and_nothing_is_lost_or_doubled(server):
    client = Client(server)
    whole = client.session("hall", seed=7, particles=400)
    broken = client.session("hall", seed=7, particles=400)
    for session in (whole, broken):
        session.observe(palms.Scan(np.array(scan_walls())))
    for number, move in enumerate(moves()):
        if number % 4 == 1:
            broken._socket.close()
        if number % 4 == 3:
            broken._socket.socket.close()
        assert broken.move(move) == whole.move(move)
    for session in (whole, broken):
        session.end()


def test_another_process_goes_on_with_a_session(server):
    client = Client(server)
    first = client.session("hall", seed=7, particles=400)
    first.observe(palms.Scan(np.array(scan_walls())))
    first.close()
    second = client.resume(first.welcome.session, first.key)
    assert second.welcome.next_seq == 2
    assert second.move(next(moves())).seq == 2
    second.pause()
    assert second.resume(same_frame=False, away_s=1.0).stage == "searching"
    second.end()


def test_who_looks_on_sees_estimates_until_the_end(server):
    client = Client(server)
    session = client.session("hall", seed=7, particles=400)
    session.observe(palms.Scan(np.array(scan_walls())))
    seen = client.watch(session.share(), receive=("estimates",), name="Ann")
    assert next(seen).role == "viewer"
    session.move(next(moves()))
    session.end()
    kinds = [type(each) for each in seen]
    assert messages.Estimate in kinds
    assert kinds[-1] is messages.Ended


def test_what_is_wrong_is_said_in_one_line(server, serve):
    with pytest.raises(PalmsError, match="building"):
        Client(server).session("nowhere")
    with pytest.raises(PalmsError, match="a PALMS server"):
        Client("http://127.0.0.1:9").buildings()
    with pytest.raises(PalmsError, match="a PALMS server"):
        Client("http://127.0.0.1:9").session("hall")
    with pytest.raises(PalmsError, match="no such"):
        Client(server).get("recordings/none")
    guarded = serve(token="a token that is long enough")
    with pytest.raises(PalmsError, match="token"):
        Client(guarded).session("hall")
    with Client(guarded, "a token that is long enough").session("hall") as session:
        assert session.welcome.level == "1"
    with pytest.raises(PalmsError, match="closed"):
        session.move(next(moves()))


def pushes(log, every_s):
    """A log as Sensor Logger pushes it."""
    readings = []
    for name, values in (
        ("TotalAcceleration", log.acceleration_m_s2),
        ("Gyroscope", log.rate_rad_s),
    ):
        for time, (x, y, z) in zip(log.time_s, values.tolist(), strict=True):
            item = {
                "name": name,
                "time": int((1.7e9 + time) * 1e9),
                "values": {"x": x, "y": y, "z": z},
            }
            readings.append((time, item))
    readings.sort(key=lambda each: each[0])
    last = log.time_s[-1]
    for number, start in enumerate(np.arange(0, last, every_s)):
        chunk = [item for time, item in readings if start <= time < start + every_s]
        yield {"messageId": number, "sessionId": "x", "deviceId": "y", "payload": chunk}


def test_readings_that_an_app_pushes_become_steps(server, phones):
    log = walked().log
    phone = phones(server)
    welcome = phone.hello(source="inertial", frame="own")
    phone.say({"type": "scan", "seq": 1, "t_s": 1.7e9, "planes": scan_walls()})
    phone.until("estimate", seq=1)
    url = f"{server}/api/v1/push/{welcome['session']}"
    right = {"Authorization": f"Bearer {welcome['key']}"}
    with httpx.Client(headers=right, timeout=60) as app:
        for body in pushes(log, 30.0):
            answer = app.post(url, json=body)
            assert answer.status_code == 200, answer.text
        ack = answer.json()
        assert app.post(url, json=body).json()["status"] == "repeated"
        assert app.post(url, json={"no": "payload"}).status_code == 422
        assert app.post(url, json={"payload": [None, {"name": []}]}).status_code == 200
    assert http.post(url, json=body).status_code == 404
    assert http.post(url, json=body, headers={"Authorization": "Bearer x"}).status_code == 404
    last = phone.until("estimate", seq=ack["seq"])
    assert last["walked_m"] == pytest.approx(dead_reckon(log).walked_m[-1], rel=0.05)
    assert json.dumps(last)
