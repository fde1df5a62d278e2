import pytest

from palms.errors import InputError, PalmsWarning
from palms.io import write_json
from palms.io.events import Event, read_events, write_events

EVENTS = (
    Event(3.0, "hint", room="Room 215", level="2", is_right=False),
    Event(4.0, "hint", position_m=(1.0, 2.0), radius_m=5.0, is_right=True),
    Event(5.0, "scan", session="Session_7_scan2"),
    Event(6.0, "jump", shift_m=(0.5, -1.0), turn_rad=0.2),
    Event(7.0, "level", level="3"),
)


def test_what_is_written_is_read(tmp_path):
    path = tmp_path / "events.json"
    write_events(EVENTS[::-1], path)
    assert read_events(path) == EVENTS


def test_unknown_keys_are_ignored_and_unknown_kinds_reported_once(tmp_path):
    path = tmp_path / "events.json"
    rows = [{"t_s": t, "kind": "earthquake"} for t in (1, 2)]
    write_json(path, [*rows, {"t_s": 9, "kind": "level", "level": 4, "mood": "bad"}])
    with pytest.warns(PalmsWarning, match="'earthquake' are not known") as noted:
        (event,) = read_events(path)
    assert len(noted) == 1
    assert (event.time_s, event.level) == (9.0, "4")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ({}, "expected a list of events"),
        ([3], "event 0: expected an object with t_s and kind"),
        ([{"kind": "scan"}], "event 0: expected an object with t_s"),
        ([{"t_s": "soon", "kind": "scan"}], "event 0, t_s"),
        ([{"t_s": 1, "kind": "hint", "position_m": [1]}], "event 0, position_m"),
    ],
)
def test_a_damaged_file_is_named_with_its_event(tmp_path, content, says):
    path = tmp_path / "events.json"
    write_json(path, content)
    with pytest.raises(InputError, match=says):
        read_events(path)


def test_an_event_has_a_known_kind_and_a_time():
    with pytest.raises(InputError, match="scan, jump, level, hint"):
        Event(1.0, "party")
    with pytest.raises(InputError, match="a time in seconds"):
        Event(float("nan"), "scan")
