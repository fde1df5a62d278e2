"""Secrets, tickets, links, names, limits."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.errors import InputError, SettingsError
from palms.server.gate import Gate
from palms.server.limits import Limits, Meter

TOKEN = "a token that is long enough"


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


@given(st.text(max_size=60))
def test_no_other_header_is_the_operator_s(header):
    gate = Gate(TOKEN)
    right = header.strip().lower() == f"bearer {TOKEN}"
    assert gate.is_operator(header) == right
    assert not gate.is_operator(None)
    assert Gate().is_operator(header)


def test_a_ticket_opens_once_and_not_for_ever():
    clock = Clock()
    gate = Gate(TOKEN, now_s=clock)
    ticket, late = gate.ticket("walker", None, 60.0), gate.ticket("walker", None, 60.0)
    assert gate.redeem(ticket).role == "walker"
    assert gate.redeem(ticket) is None
    clock.now = 61.0
    assert gate.redeem(late) is None


def test_a_link_opens_often_until_it_expires_or_is_revoked():
    clock = Clock()
    gate = Gate(TOKEN, now_s=clock)
    link, other = gate.link("s1", 60.0), gate.link("s2", 60.0)
    assert gate.linked(link).session == gate.linked(link).session == "s1"
    gate.revoke("s1")
    assert gate.linked(link) is None
    assert gate.linked(other).session == "s2"
    clock.now = 61.0
    assert gate.linked(other) is None
    assert gate.linked(gate.ticket("viewer", "s2", 60.0)) is None


def test_tickets_do_not_fill_the_memory():
    gate = Gate(TOKEN)
    first = gate.ticket("walker", None, 60.0)
    for _ in range(10_001):
        last = gate.ticket("walker", None, 60.0)
    assert gate.redeem(first) is None
    assert gate.redeem(last) is not None


@pytest.mark.parametrize(
    ("host", "known"),
    [
        ("127.0.0.1:8000", True), ("[::1]:8000", True), ("192.168.1.7:8000", True),
        ("localhost:8000", True), ("Palms.local", True), ("evil.example:8000", False),
        ("127.0.0.1.evil.example", False), ("", False), (None, False), ("[bad", False),
        ("a@evil.example", False),
    ],
)  # fmt: skip
def test_names_that_the_server_goes_by(host, known):
    assert Gate(hosts=("palms.local",)).knows_host(host) is known


def test_origins_are_the_server_s_own_and_those_it_was_told():
    gate = Gate(origins=("https://map.example/",))
    assert gate.knows_origin(None, "a:1", "http")
    assert gate.knows_origin("http://a:1", "a:1", "http")
    assert gate.knows_origin("https://map.example", "a:1", "http")
    for other in ("https://a:1", "http://a:2", "null", "https://map.example.evil"):
        assert not gate.knows_origin(other, "a:1", "http")


def test_a_short_token_is_refused():
    with pytest.raises(InputError, match="16 characters"):
        Gate("short")


@pytest.mark.parametrize(
    "text", ["sessions=0", "sessions=many", "colour=3", "sessions", "idle_s=nan"]
)
def test_limits_that_are_none_are_refused(text):
    with pytest.raises(SettingsError):
        Limits().with_texts([text])


def test_limits_are_set_by_name():
    limits = Limits().with_texts(["sessions=7", "idle-s=2.5"])
    assert (limits.sessions, limits.idle_s) == (7, 2.5)


@given(st.lists(st.floats(0, 3), min_size=1, max_size=60))
def test_no_more_messages_get_through_than_allowed(gaps):
    meter, now, times = Meter(5.0, 4), 0.0, []
    for gap in gaps:
        now = max(now + gap, times[-1] if times else 0.0)
        times.append(now + meter.wait_s(now))
    for first in range(len(times)):
        for last in range(first + 4, len(times)):
            assert times[last] - times[first] >= (last - first - 4) / 5.0 - 1e-6
