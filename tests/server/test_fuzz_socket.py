"""The socket under fire: no defect, no hang, no word of one session in another."""

import json

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.server.conftest import Phone, hall, http, odometry, positions, scan, whole_walk

NUMBERS = st.one_of(
    st.integers(-3, 30), st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([1e308, -1e308, 2**63, 2**53, 1e-320]),
)  # fmt: skip
JUNK = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4)
    | st.dictionaries(st.sampled_from(["t_s", "position_m", "pose", "matrix"]), inner, max_size=3),
    max_leaves=8,
)  # fmt: skip
TYPES = [
    "odometry", "scan", "hint", "level", "inertial", "pause", "resume", "share", "dismiss", "hello",
    "tell", "ask", "preferences",
]  # fmt: skip
KEYS = [
    "seq", "samples", "planes", "t_s", "form", "position_m", "pose", "room", "place_m", "radius_m",
    "probability", "readings", "same_frame", "ttl_s", "viewer", "building", "session", "key",
    "level", "change", "away_s",
    "text", "what", "units", "step_m", "language", "directions", "every_s", "details", "quiet",
]  # fmt: skip
GOOD = [
    *whole_walk(), {"type": "hint", "seq": 15, "room": "Study"},
    {"type": "level", "seq": 16, "t_s": 130.0, "level": "1"},
    {"type": "resume", "seq": 17, "same_frame": False},
]  # fmt: skip


@st.composite
def damaged(draw):
    """A good message with some of it changed, put in or taken out."""
    message = json.loads(json.dumps(draw(st.sampled_from(GOOD))))
    for _ in range(draw(st.integers(0, 3))):
        key = draw(st.sampled_from(KEYS))
        if draw(st.booleans()):
            message[key] = draw(JUNK)
        else:
            message.pop(key, None)
    if draw(st.booleans()):
        message["seq"] = draw(st.integers(1, 40))
    return message


MESSAGES = st.one_of(
    damaged(),
    st.builds(lambda kind, rest: {"type": kind} | rest, st.sampled_from(TYPES),
              st.dictionaries(st.sampled_from(KEYS), JUNK, max_size=4)),
    st.builds(lambda seq, x, y, t: odometry(seq, [x, y], t), st.integers(1, 30), NUMBERS, NUMBERS,
              NUMBERS),
    st.text(max_size=20),
)  # fmt: skip
QUICK = settings(
    max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)


@given(st.lists(MESSAGES, max_size=12))
@QUICK
def test_whatever_a_phone_sends_the_server_answers_and_others_go_on(server, messages):
    phone = Phone(server)
    welcome = phone.hello()
    for message in messages:
        phone.say(message if isinstance(message, str) else json.dumps(message))
    phone.say({"type": "share", "ttl_s": 5})  # answered in the end, whatever came before
    seen = []
    while not seen or seen[-1]["type"] != "link" or seen[-1]["expires_in_s"] != 5:
        seen.append(phone.next())
        assert not seen[-1].get("fatal"), seen[-1]
        assert seen[-1].get("code") != "defect"
    phone.close()
    again = Phone(server)
    back = again.hello(session=welcome["session"], key=welcome["key"])
    assert back["resumed"]
    again.say({"type": "end"})
    again.until("ended")
    again.close()
    assert "palms_defects_total 0" in http.get(f"{server}/metrics").text


@given(
    st.text(max_size=30) | st.dictionaries(st.sampled_from(["type", *KEYS]), JUNK).map(json.dumps)
)
@QUICK
def test_whatever_comes_first_is_answered(server, first):
    phone = Phone(server)
    phone.say(first)
    assert phone.next()["type"] in ("error", "welcome")
    phone.close()


@given(st.integers(0, 2**32), st.lists(st.integers(0, 2), min_size=42, max_size=42))
@settings(max_examples=3, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
def test_sessions_side_by_side_are_as_alone(server, seed, turns):
    def alone():
        phone = Phone(server)
        phone.hello(seed=seed)
        found = [phone.walk([message]) for message in whole_walk()]
        phone.close()
        return found

    expected = alone()
    phones = [Phone(server) for _ in range(3)]
    names = [
        phone.hello(seed=seed if n == 1 else seed + n)["session"] for n, phone in enumerate(phones)
    ]
    waiting = [whole_walk() for _ in phones]
    found = []
    for turn in [*turns, *[1] * 14]:
        if waiting[turn]:
            answer = phones[turn].walk([waiting[turn].pop(0)])
            found += [answer] if turn == 1 else []
    assert found == expected
    assert len(set(names)) == 3
    for phone in phones:
        phone.say({"type": "end"})
        phone.close()


def test_the_world_of_these_tests_is_one_that_can_be_walked():
    assert len(whole_walk()) == len(positions()) + 1
    assert scan()["planes"]
    assert hall().rooms
