"""What is said when: the rules hold whatever comes, in whatever order."""

import math
import re

from hypothesis import given, settings
from hypothesis import strategies as st

from palms.advice import Gap, View
from palms.voice import Moment, Preferences, understand
from palms.voice.narrator import OF_STAGE
from tests.voice.places import at, corridor, narrator

NAMES = ("corridor", "215", "217", "Lab")
ODD = st.sampled_from([math.nan, math.inf, -math.inf, 1e300, 0.0])
REAL = st.floats(-50.0, 50.0) | ODD
MOMENTS = st.builds(
    Moment,
    st.sampled_from(["searching", "oriented", "localized", "localized", "lost"]),
    st.floats(0.0, 500.0),
    st.none() | st.tuples(REAL, REAL) | st.tuples(st.floats(0, 30), st.floats(0, 6)),
    st.none() | st.floats(0.0, 60.0) | ODD,
    st.none() | st.floats(-math.pi, math.pi) | ODD,
    st.none() | st.floats(0.0, 3.0) | ODD,
    st.none() | st.sampled_from(["1", "2", "9"]),
    st.lists(st.floats(0.0, 1.0), max_size=5).map(tuple),
    st.floats(0.0, 1.0),
)
PREFERENCES = st.builds(
    Preferences,
    st.sampled_from(["metres", "feet", "steps"]),
    st.floats(0.2, 1.5),
    st.sampled_from(["en", "de", "tlh"]),
    st.sampled_from(["clock", "degrees", "words"]),
    st.floats(5.0, 30.0),
    st.booleans(),
    st.booleans(),
)
ACTS = st.one_of(
    st.sampled_from(["where", "details", "repeat", "near", "options"]),
    st.sampled_from(["pause", "resume", "restart", "tell", "scan", "replay"]),
    PREFERENCES,
    st.none(),
)
CLOCK = re.compile(r"o'clock|Uhr|degrees|Grad|ahead|behind|vor dir|hinter dir|links|rechts")
UNIT_M = {"metre": 1.0, "foot": 0.3048, "feet": 0.3048, "Meter": 1.0, "Fuß": 0.3048}


def acted(now, act, clock_s):
    """Do something to a narrator; return it and what it says."""
    if isinstance(act, Preferences):
        return now.preferring(act, clock_s)
    acts = {
        None: lambda: (now, None),
        "pause": lambda: now.pause(clock_s),
        "resume": lambda: now.resume(True, clock_s),
        "restart": lambda: now.resume(False, clock_s),
        "tell": lambda: now.note("the moon", understand("the moon", ()), clock_s),
        "scan": lambda: (now.scanned(View(3, False, (Gap(1.0, 2.0),)), None), None),
        "replay": lambda: (now.caught_up(now.moment), None),
    }
    return acts.get(act, lambda: now.answer(act, clock_s))()


def check_words(saying, moment, preferences):
    """What must hold of every sentence."""
    whole = f"{saying.text} {saying.details or ''}"
    if saying.kind != "answer" and saying.kind not in ("localized", "found", "place"):
        assert not any(name in whole for name in NAMES)
    if not any(name in whole for name in NAMES):
        return
    told = re.search(r"(?:to|Auf) (\d+) (\w+?)s?(?: genau)?\.", whole)
    if told is not None and moment.is_placed:
        unit = UNIT_M.get(told[2].rstrip("s"), preferences.step_m)
        assert int(told[1]) * unit >= moment.radius_95_m - 1e-6


def check_direction(saying, moment):
    if saying.kind in ("localized", "found", "place") and CLOCK.search(saying.details or ""):
        assert math.isfinite(moment.facing_rad)
        assert 2 * moment.spread_rad <= math.radians(15) + 1e-9


@given(st.lists(st.tuples(MOMENTS, st.floats(0.0, 8.0), ACTS), max_size=25), PREFERENCES)
@settings(max_examples=150, deadline=None)
def test_the_rules_hold_whatever_comes(steps, preferences):
    now, _ = narrator("1", "2").preferring(preferences, 0.0)
    clock_s, unasked_s, kept = 0.0, -math.inf, preferences
    for moment, passed_s, act in steps:
        clock_s += passed_s
        kept = act if isinstance(act, Preferences) else kept
        now, asked = acted(now, act, clock_s)
        if asked is not None and not now.moment.is_placed and act != "repeat":
            assert not any(name in asked.text for name in NAMES)
        now, saying = now.hear(moment, clock_s)
        if saying is None:
            continue
        assert clock_s - unasked_s >= (5.0 if saying.kind in OF_STAGE else kept.every_s)
        unasked_s = clock_s
        assert saying.text
        assert "\n" not in saying.text
        assert not (kept.quiet and saying.kind not in OF_STAGE)
        assert saying.kind not in ("localized", "found", "place") or moment.is_placed
        check_words(saying, moment, kept)
        check_direction(saying, moment)


def told(moments, every_s=6.0, **preferences):
    """Kinds and texts of what is said to moments that come so far apart."""
    now, found = narrator(**preferences), []
    for k, moment in enumerate(moments):
        now, saying = now.hear(moment, every_s * k)
        if saying is not None:
            found.append((saying.kind, saying.text))
    return found


def walk(*xs, **others):
    return [at(x, 1.0, walked_m=40.0 + x, **others) for x in xs]


LOST = Moment("lost", 60.0, (5.0, 1.0), 20.0)
SEARCHING = Moment("searching", 0.0, (5.0, 1.0), 20.0, shares=(0.4, 0.3, 0.2))


def test_lost_and_found_are_said_and_in_time():
    found = told([*walk(1, 4), LOST, *walk(21, 24)])
    assert [kind for kind, _ in found] == ["progress", "localized", "lost", "found"]
    assert found[2][1] == "Position uncertain. Please scan again."
    assert found[3][1] == "Found again: probably East corridor, near Lab."


def test_who_is_quiet_tells_only_changes_of_the_stage():
    found = told([SEARCHING, *walk(1, 4, 15, 24), LOST], quiet=True)
    assert [kind for kind, _ in found] == ["localized", "lost"]


def test_what_is_no_longer_so_is_not_said_late():
    """Lost and found again within the five seconds: nobody is alarmed about what has passed."""
    moments = [*walk(1, 2, 3, 4, 5, 6), LOST, *walk(7, 8, 9, 10, 11)]
    found = told(moments, every_s=1.0)
    assert [kind for kind, _ in found] == ["progress", "localized"]


def test_one_that_is_sure_for_a_while_is_told_without_probably():
    found = [text for kind, text in told(walk(1, 4, 15, 24, 27)) if kind != "progress"]
    assert found[0] == "Found: probably East corridor, near Room 215."
    assert found[-1] == "East corridor, near Lab."


def test_after_a_doubt_only_a_scan_makes_sure_again():
    doubt = Moment("oriented", 45.0, (5.0, 1.0), 5.0)
    now = narrator()
    for k, moment in enumerate([*walk(1, 4), doubt, *walk(6, 9, 27, 28)]):
        now, _ = now.hear(moment, 6.0 * k)
    assert now.answer("where", 60.0)[1].text.startswith("Probably")
    now = now.scanned(View(9, False, ()), None)
    assert not now.answer("where", 61.0)[1].text.startswith("Probably")


def test_in_one_room_another_neighbour_is_told_after_a_while():
    found = told([*walk(1, 4), *walk(5.2, 6.0, 6.5), *walk(14, 23.5)])
    places = [text for kind, text in found if kind == "place"]
    assert places == ["Probably East corridor.", "East corridor, near Lab."]


def test_progress_is_told_when_places_become_fewer_or_after_a_while():
    def at_m(walked_m, *shares):
        return Moment("searching", walked_m, (5.0, 1.0), 20.0, shares=shares)

    moments = [
        at_m(0, 0.2, 0.1), at_m(1, 0.4, 0.3, 0.2), at_m(6, 0.4, 0.3, 0.2), at_m(12, 0.3, 0.3, 0.3),
        at_m(18, 0.5, 0.4), at_m(24, 0.4, 0.4), at_m(39, 0.5, 0.4),
    ]  # fmt: skip
    assert [text for _, text in told(moments)] == [
        "Many places possible.", "Three places possible.", "Two places possible.",
        "Two places possible.",
    ]  # fmt: skip


def test_a_poor_scan_says_where_to_turn():
    gap, moment = Gap(-math.pi / 2, 2.0), SEARCHING
    for facing, words in [
        (0.0, "to the right"), (math.pi, "to the left"), (math.pi / 2, "behind you"),
        (None, "round"),
    ]:  # fmt: skip
        _, saying = narrator().scanned(View(1, True, (gap,)), facing).hear(moment, 9.0)
        assert saying.text.startswith("Only one wall seen.")
        assert words in saying.text
        assert saying.details == "Three places possible."
    _, saying = narrator().scanned(View(9, True, ()), 0.0).hear(moment, 9.0)
    assert saying.text == "Scan taken, nine walls. Three places possible."
    assert "corner" in saying.details


def test_repeat_says_it_again_and_how_long_ago_when_one_has_walked_on():
    now, saying = narrator().hear(SEARCHING, 0.0)
    now, again = now.answer("repeat", 1.0)
    assert (again.text, again.details) == (saying.text, saying.details)
    now, _ = now.hear(at(5.0, 1.0, walked_m=9.0), 3.0)
    assert now.answer("repeat", 12.0)[1].text == "12 seconds ago: Three places possible."
    assert narrator().answer("repeat", 0.0)[1].text == "Nothing was said yet."


def test_questions_while_searching_name_no_place():
    now, _ = narrator().hear(SEARCHING, 0.0)
    for what in ("where", "details", "near", "options"):
        _, saying = now.answer(what, 1.0)
        assert saying.text
        assert not any(name in f"{saying.text} {saying.details}" for name in NAMES)
    _, saying = now.answer("options", 1.0)
    assert saying.details == "Walk on 10 metres, or tell me a room name or number."


def test_details_that_are_wanted_are_part_of_the_text():
    _, saying = narrator(details=True).hear(SEARCHING, 0.0)
    assert saying.text.startswith("Three places possible. Walk on")
    assert saying.details is None


def test_the_plan_of_these_tests_has_the_rooms_that_they_speak_of():
    assert all(any(name in room.name for room in corridor().rooms) for name in NAMES)
