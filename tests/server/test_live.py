"""The socket: sessions, order, viewers, limits."""

import json

import numpy as np
import pytest
from websockets.exceptions import InvalidStatus

import palms
from palms.server.limits import Limits
from palms.settings import Settings
from tests.server.conftest import (
    START,
    hall,
    http,
    new_store,
    odometry,
    positions,
    scan,
    scan_walls,
    whole_walk,
)


def test_a_walk_is_followed_as_the_localizer_does_it(server, phones):
    phone = phones(server)
    welcome = phone.hello()
    assert welcome["type"] == "welcome"
    assert (welcome["level"], welcome["next_seq"], welcome["resumed"]) == ("1", 1, False)
    last = phone.walk(whole_walk())
    localizer = palms.Localizer(hall(), Settings().with_particles(500), rng=1)
    localizer.observe(palms.Scan(np.array(scan_walls())))
    before = np.zeros(2)
    for step, place in enumerate(np.array(positions()), 1):
        localizer.move(palms.Move(0.5 + 0.5 * step, *(place - before).tolist()))
        before = place
    found = localizer.estimate
    assert [last["x_m"], last["y_m"]] == found.position_m.tolist()
    assert (last["stage"], last["p_within_1m"]) == (str(found.stage), found.p_within_1m)
    assert last["radius_95_m"] == found.radius_95_m
    truth = START + np.sum([[0.0, 1.5]], axis=0)
    assert np.linalg.norm(np.array([last["x_m"], last["y_m"]]) - truth) < 1
    assert last["room"] == "Study"
    assert last["t_s"] == 100.0 + 0.5 * 14


def test_each_input_is_acknowledged_once_it_is_stored_and_events_are_numbered(server, phones):
    phone = phones(server)
    phone.hello()
    for message in whole_walk():
        phone.say(message)
    got = []
    while not got or got[-1].get("seq") != 14 or got[-1]["type"] != "estimate":
        got.append(phone.next())
    acks = [each["seq"] for each in got if each["type"] == "ack"]
    assert acks == list(range(1, 15))
    events = [each for each in got if each["type"] == "event"]
    assert [each["number"] for each in events] == list(range(1, len(events) + 1))
    assert events[0]["kind"] == "scanning"
    assert [each["kind"] for each in events[1:]] == ["oriented"]


def test_repeated_inputs_change_nothing(server, phones):
    one, other = phones(server), phones(server)
    one.hello()
    other.hello()
    plain = one.walk(whole_walk())
    doubled = [message for message in whole_walk() for _ in range(2)]
    for message in doubled:
        other.say(message)
    statuses, last = [], None
    while len(statuses) < len(doubled):
        answer = other.next()
        if answer["type"] == "ack":
            statuses.append(answer["status"])
        if answer["type"] == "estimate":
            last = answer
    assert statuses.count("repeated") == len(doubled) // 2
    assert last == plain


def test_inputs_out_of_order_wait_for_those_before_them(server, phones):
    one, other = phones(server), phones(server)
    one.hello()
    other.hello()
    plain = one.walk(whole_walk())
    inputs = whole_walk()
    for message in [inputs[0], *reversed(inputs[1:])]:
        other.say(message)
    assert other.until("ack", seq=14)["status"] == "waiting"
    assert other.until("estimate", seq=14) == plain


def test_a_gap_that_is_too_wide_is_to_be_sent_again(serve, phones):
    phone = phones(serve(Limits(ahead=3)))
    phone.hello()
    for seq in (2, 3, 4):
        phone.say(odometry(seq, [0.0, 0.0]))
    refused = phone.until("error")
    assert (refused["code"], refused["seq"], refused["next_seq"]) == ("gap", 4, 1)
    assert not refused["fatal"]


def test_late_samples_are_no_moves_but_nothing_is_lost(server, phones):
    phone = phones(server)
    phone.hello()
    first = phone.walk([scan(), odometry(2, [0.3, 0.0], 101.0), odometry(3, [0.6, 0.0], 102.0)])
    late = phone.walk([odometry(4, [0.4, 0.0], 101.5)])
    assert late["n_late"] == 1
    assert late["x_m"] == first["x_m"]
    assert phone.walk([odometry(5, [0.9, 0.0], 103.0)])["walked_m"] == pytest.approx(0.9)


def test_what_is_wrong_with_an_input_is_said_and_the_session_goes_on(server, phones):
    phone = phones(server)
    phone.hello()
    phone.say({"type": "hint", "seq": 1, "room": "No such room"})
    error = phone.until("error")
    assert (error["code"], error["seq"], error["fatal"]) == ("input", 1, False)
    assert "Study" in error["text"]
    phone.say({"type": "scan", "seq": 2, "t_s": 1.0, "planes": []})
    assert "wall" in phone.until("error")["text"]
    phone.say('{"type": "odometry", "seq": 3, "samples": [{"t_s": "soon"}]}')
    assert "t_s" in phone.until("error", code="message")["text"]
    phone.say({"type": "dance"})
    assert phone.until("error")["code"] == "message"
    assert phone.walk([scan(3)])["x_m"] is not None


@pytest.mark.parametrize(
    ("first", "code"),
    [
        ("no json", "message"),
        ({"type": "pause", "seq": 1}, "protocol"),
        ({"type": "hello", "building": "hall", "protocol": "palms-live/99"}, "protocol"),
        ({"type": "hello", "building": "nowhere"}, "unknown"),
        ({"type": "hello", "building": "hall", "level": "99"}, "unknown"),
        ({"type": "hello", "building": "hall", "method": "oracle"}, "unknown"),
        ({"type": "hello", "building": "hall", "particles": 1_000_000}, "full"),
        ({"type": "hello", "session": "nobody", "key": "none"}, "unknown"),
        ({"type": "hello", "role": "viewer", "view": "guess"}, "forbidden"),
    ],
)
def test_a_hello_that_cannot_be_answered_ends_the_conversation(server, phones, first, code):
    phone = phones(server)
    phone.say(first)
    error = phone.next()
    assert (error["type"], error["code"], error["fatal"]) == ("error", code, True)
    assert phone.rest()[0] == []


def test_a_client_comes_back_to_its_session(server, phones):
    phone = phones(server)
    welcome = phone.hello()
    inputs = whole_walk()
    half = phone.walk(inputs[:7])
    phone.close()
    again = phones(server)
    back = again.hello(session=welcome["session"], key=welcome["key"], building=None)
    assert (back["resumed"], back["next_seq"], back["key"]) == (True, 8, None)
    assert again.until("estimate") == half
    whole = phones(server)
    whole.hello()
    assert again.walk(inputs[7:]) == whole.walk(inputs)


def test_another_key_opens_nothing(server, phones):
    phone, thief = phones(server), phones(server)
    welcome = phone.hello()
    assert thief.hello(session=welcome["session"], key="x" * 32)["code"] == "unknown"
    other = phones(server).hello()
    third = phones(server)
    assert third.hello(session=welcome["session"], key=other["key"])["code"] == "unknown"


def test_who_comes_back_replaces_the_old_connection(server, phones):
    phone = phones(server)
    welcome = phone.hello()
    again = phones(server)
    assert again.hello(session=welcome["session"], key=welcome["key"])["resumed"]
    assert phone.rest()[0][-1] == {"type": "ended", "reason": "replaced", "recording": None}
    again.walk([scan()])


def test_viewers_see_what_they_ask_for_and_the_walker_knows(server, phones):
    phone, viewer = phones(server), phones(server)
    phone.hello()
    phone.walk(whole_walk()[:5])
    phone.say({"type": "share", "ttl_s": 60})
    view = phone.until("link")["view"]
    wants = ["estimates", "events", "particles", "heatmaps"]
    viewer.say({"type": "hello", "role": "viewer", "view": view, "receive": wants, "name": "Ann"})
    seat = viewer.next()
    assert (seat["role"], seat["key"]) == ("viewer", None)
    assert phone.until("viewers")["viewers"][0]["name"] == "Ann"
    path = viewer.until("path")
    assert len(path["x_m"]) == 5
    phone.walk(whole_walk()[5:])
    assert viewer.until("estimate", seq=14)["stage"] == "oriented"
    while len({type(frame) for frame in viewer.frames}) < 2:
        viewer.next()
    viewer.say(scan(15))
    assert viewer.until("error")["code"] == "forbidden"
    phone.say({"type": "dismiss", "viewer": seat["viewer"]})
    assert viewer.rest()[0][-1]["reason"] == "dismissed"
    assert phone.until("viewers")["viewers"] == []
    late = phones(server)
    late.say({"type": "hello", "role": "viewer", "view": view})
    assert late.next()["code"] == "forbidden"


def test_particles_show_where_the_belief_is(server, phones):
    phone = phones(server)
    phone.hello(receive=["estimates", "particles", "heatmaps"], max_particles=300)
    last = phone.walk(whole_walk())
    while not phone.frames or getattr(phone.frames[-1], "seq", 0) != 14:
        phone.next()
    shown = phone.frames[-1]
    assert shown.position_m.shape == (300, 2)
    away = np.linalg.norm(shown.position_m - [last["x_m"], last["y_m"]], axis=1)
    assert np.quantile(away, 0.68) == pytest.approx(last["radius_68_m"], abs=0.15)
    best = next(frame for frame in phone.frames if hasattr(frame, "png") and frame.number == 0)
    assert best.png.startswith(b"\x89PNG")


def test_an_end_ends_it_for_all_and_leaves_nothing(server, phones, rest):
    phone, viewer = phones(server), phones(server)
    welcome = phone.hello()
    phone.walk(whole_walk()[:3])
    viewer.say({"type": "hello", "role": "viewer", "session": welcome["session"]})
    viewer.next()
    phone.say({"type": "end"})
    assert phone.until("ended")["recording"] is None
    assert viewer.rest()[0][-1]["reason"] == "ended"
    again = phones(server)
    assert again.hello(session=welcome["session"], key=welcome["key"])["code"] == "unknown"
    listed = rest.get("/api/v1/sessions").json()["sessions"]
    assert welcome["session"] not in [each["session"] for each in listed]


def test_a_pause_leaves_out_and_a_new_frame_keeps_the_place(server, phones):
    phone = phones(server)
    phone.hello()
    phone.walk(whole_walk())
    phone.walk([{"type": "pause", "seq": 15}])
    still = phone.walk([odometry(16, [50.0, 50.0])])
    assert still["walked_m"] == pytest.approx(3.9)
    anew = phone.walk([{"type": "resume", "seq": 17, "same_frame": False}])
    assert anew["stage"] == "searching"
    assert abs(anew["x_m"] - still["x_m"]) + abs(anew["y_m"] - still["y_m"]) < 1.0
    assert phone.walk([scan(18, 150.0)])["x_m"] is not None


def test_beyond_the_limit_new_sessions_are_refused_and_old_ones_go_on(serve, phones):
    url = serve(Limits(sessions=2))
    first, second, third = phones(url), phones(url), phones(url)
    welcome = first.hello()
    second.hello()
    refused = third.hello()
    assert (refused["code"], refused["fatal"]) == ("full", True)
    assert "2 sessions" in refused["text"]
    assert third.rest()[1] == 1013
    assert first.walk(whole_walk())["stage"] == "oriented"
    first.close()
    back = phones(url)
    assert back.hello(session=welcome["session"], key=welcome["key"])["resumed"]
    second.say({"type": "end"})
    second.rest()
    assert phones(url).hello()["type"] == "welcome"


def test_limits_of_one_client_hold(serve, phones):
    url = serve(Limits(message_bytes=5000, inputs=3, viewers=1))
    phone = phones(url)
    welcome = phone.hello()
    for number in range(2):
        viewer = phones(url)
        viewer.say({"type": "hello", "role": "viewer", "session": welcome["session"]})
        assert viewer.next()["type"] == ("error" if number else "welcome")
    for message in whole_walk()[:4]:
        phone.say(message)
    assert phone.until("error", seq=4)["code"] == "full"
    large = phones(url)
    large.hello()
    large.say(json.dumps({"type": "pause", "seq": 1, "padding": "x" * 6000}))
    assert large.rest()[1] == 1009


def test_who_says_nothing_is_let_go_and_may_come_back(serve, phones, tmp_path):
    silent = phones(serve(Limits(hello_s=0.05)))
    assert silent.next()["code"] == "slow"
    url = serve(Limits(idle_s=0.05), folder=new_store(tmp_path / "other"))
    idle = phones(url)
    welcome = idle.hello()
    assert idle.rest()[0][-1]["code"] == "slow"
    assert phones(url).hello(session=welcome["session"], key=welcome["key"])["resumed"]


def test_sockets_are_counted(serve, phones):
    url = serve(Limits(sockets=1))
    phone = phones(url)
    phone.hello()
    assert phones(url).next()["code"] == "full"
    phone.walk(whole_walk()[:2])


def test_a_client_who_is_too_quick_is_read_more_slowly(serve, phones):
    url = serve(Limits(messages_per_s=40, burst=5))
    phone = phones(url)
    phone.hello()
    last = phone.walk(whole_walk())
    assert last["seq"] == 14
    text = http.get(url + "/metrics").text
    assert "palms_inputs_total 14" in text


def test_pages_of_others_and_unknown_names_are_refused(server, phones):
    with pytest.raises(InvalidStatus) as refused:
        phones(server, additional_headers={"Origin": "https://evil.example"})
    assert refused.value.response.status_code == 403
    assert phones(server, additional_headers={"Origin": server}).hello()["type"] == "welcome"
    answer = http.get(server + "/health", headers={"Host": "evil.example"})
    assert answer.status_code == 421
    assert http.get(server + "/health", headers={"Origin": "null"}).status_code == 403
    assert http.get(server + "/health", headers={"Origin": server}).status_code == 200


def test_with_a_token_nobody_walks_without_it_or_a_ticket(serve, phones):
    token = "a token that is long enough"
    url = serve(token=token)
    operator = {"Authorization": f"Bearer {token}"}
    assert phones(url).hello()["code"] == "forbidden"
    assert phones(url, additional_headers={"Authorization": "Bearer x"}).hello()["code"]
    welcome = phones(url, additional_headers=operator).hello()
    assert welcome["type"] == "welcome"
    made = http.post(url + "/api/v1/tickets", json={"role": "walker"}, headers=operator).json()
    assert phones(url).hello(ticket=made["ticket"])["type"] == "welcome"
    assert phones(url).hello(ticket=made["ticket"])["code"] == "forbidden"
    wanted = {"role": "viewer", "session": welcome["session"]}
    look = http.post(url + "/api/v1/tickets", json=wanted, headers=operator).json()["ticket"]
    assert phones(url).hello(ticket=look)["code"] == "forbidden"
    only = http.post(url + "/api/v1/tickets", json={"building": "hall"}, headers=operator).json()
    assert phones(url).hello(ticket=only["ticket"], building="sample")["code"] == "forbidden"
    only = http.post(url + "/api/v1/tickets", json={"building": "hall"}, headers=operator).json()
    mine = phones(url).hello(ticket=only["ticket"], building=None)
    key = {"Authorization": f"Bearer {mine['key']}"}
    assert http.get(url + "/api/v1/buildings/hall/plan", headers=key).status_code == 200
    assert http.get(url + "/api/v1/buildings/other/plan", headers=key).status_code == 401
    assert http.get(url + "/api/v1/buildings/hall/plan").status_code == 401
    for private in ("sessions", "recordings", "backup", "buildings"):
        assert http.get(f"{url}/api/v1/{private}").status_code == 401
    assert http.get(url + "/metrics").status_code == 401
    assert http.get(url + "/health").status_code == 200
    assert http.delete(url + "/api/v1/buildings/hall").status_code == 401
