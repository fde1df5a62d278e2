import numpy as np

from palms import Estimate, FloorPlan, Odometry, Room, Scan, Stage, Track
from palms.cli._inputs import Case
from palms.cli._words import at_the_end, how_sure, outcome, row, summary, where
from palms.io import RecordedWalk


def box(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


PLAN = FloorPlan(
    [[[0, 0], [40, 0]], [[0, 8], [40, 8]]],
    rooms=(
        Room("North corridor", box(0, 0, 40, 3)),
        Room("Room 215", box(0, 3, 5, 8)),
        Room("Room 216", box(5, 3, 10, 8)),
    ),
)
ODOMETRY = Odometry([1.0, 2.0, 3.0], [[1, 0], [2, 0], [3, 0]])
WALK = RecordedWalk(arkit=ODOMETRY, reference_m=[[np.nan, np.nan], [2.0, 4.0], [3.0, 4.0]])

CASE = Case(PLAN, Scan([[[2, -2], [2, 2]]]), WALK, ODOMETRY, "arkit", "scan", "walk")


def estimate(time_s, stage, x=2.0, y=4.5):
    return Estimate(
        time_s, stage, np.array([x, y]), p_within_2m=0.97, radius_68_m=0.3, radius_95_m=0.62
    )


def track(*stages):
    return Track(0, tuple(estimate(i + 1.0, Stage(stage)) for i, stage in enumerate(stages)))


def test_a_corridor_is_named_with_a_room_beside_it():
    assert where(PLAN, [6.0, 2.5]) == "North corridor, near Room 216 (x 6.0 m, y 2.5 m)"
    assert where(PLAN, [30.0, 1.0]) == "North corridor (x 30.0 m, y 1.0 m)"


def test_a_room_is_enough_and_outside_there_is_a_neighbour():
    assert where(PLAN, [2.0, 5.0]) == "Room 215 (x 2.0 m, y 5.0 m)"
    assert where(PLAN, [2.0, 9.0]) == "near Room 215 (x 2.0 m, y 9.0 m)"
    assert where(PLAN, [90.0, 90.0]) == "x 90.0 m, y 90.0 m"


def test_a_tiny_radius_is_not_zero():
    assert how_sure(Estimate(1.0, radius_95_m=0.01)) == "within 0.1 m with 95 %"


def test_nothing_known():
    assert how_sure(Estimate(1.0)) == "nothing is known"


def test_localized():
    assert outcome(track("searching", "localized", "localized"), CASE) == (
        "Localized after 2 m (2 s): Room 215 (x 2.0 m, y 4.5 m).",
        "How sure: within 0.6 m with 95 %. The truth was 0.5 m away.",
    )


def test_oriented_only():
    assert outcome(track("searching", "oriented", "oriented"), CASE) == (
        "Oriented after 2 m (2 s), but not localized in 3 m (3 s).",
        "",
    )


def test_never():
    assert outcome(track(*["searching"] * 3), CASE) == ("Not localized in 3 m (3 s).", "")


def test_without_a_reference_at_that_step():
    _, second = outcome(track("localized", "localized", "localized"), CASE)
    assert second == "How sure: within 0.6 m with 95 %."


def test_the_end_says_when_it_is_a_guess():
    lost, _ = at_the_end(track("searching", "localized", "lost"), CASE)
    assert lost.startswith("At the end, after 3 m (3 s), lost, so this is a guess: Room 215")
    sure, _ = at_the_end(track("searching", "localized", "localized"), CASE)
    assert "guess" not in sure


def test_without_a_belief_there_is_no_answer_at_the_end():
    assert at_the_end(Track(0, (Estimate(1.0),)), CASE)[0].endswith(": no answer.")


def test_summary_counts_those_that_never_localized():
    found, never = track("searching", "localized", "localized"), track(*["searching"] * 3)
    assert summary([found, never], CASE) == (
        "Localized in 1 of 2 trials, in the median after 2 m and 0.5 m off; "
        "0 of 1 more than 2 m off."
    )
    assert summary([never], CASE) == "Localized in 0 of 1 trials."


def test_row_of_a_table():
    assert row(track("searching", "localized", "localized"), CASE) == [
        "0", "2 m (2 s)", "Room 215 (x 2.0 m, y 4.5 m)", "97 %", "0.6 m", "0.5 m",
    ]  # fmt: skip
    assert row(track("searching", "searching", "searching"), CASE)[1:] == ["never", *"----"]
