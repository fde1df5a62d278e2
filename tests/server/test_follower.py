"""Same inputs, same state, to the bit."""

import json
from dataclasses import replace

import numpy as np
import pytest

from palms import rasterize
from palms.geodesy import Origin
from palms.server import messages
from palms.server.follower import Floor, Follower, Terms
from palms.server.naming import Namer
from tests.server.conftest import hall, odometry, positions, scan, scan_walls, whole_walk

PLAN = hall()
FLOOR = Floor(rasterize(PLAN), Namer(PLAN), "1")
TERMS = Terms(particles=300, seed=5)


def parsed(inputs):
    return [messages.parse_input(json.dumps(each)) for each in inputs]


def state(follower):
    """Everything that later answers depend on, as bytes."""
    belief = follower.localizer.belief
    arrays = () if belief is None else (
        belief.particles.position_m, belief.particles.drift_rad, belief.particles.weight,
        belief.particles.scale, belief.particles.label,
    )  # fmt: skip
    return (
        *(array.tobytes() for array in arrays), follower.estimate().model_dump_json(),
        follower.intake, None if belief is None else belief.doubt,
    )  # fmt: skip


MIXED = [
    *whole_walk(),
    {"type": "hint", "seq": 15, "room": "Study"},
    {"type": "hint", "seq": 16, "room": "nowhere"},
    scan(17, 120.0),
    {"type": "pause", "seq": 18},
    odometry(19, [9.0, 9.0]),
    {"type": "resume", "seq": 20, "same_frame": False},
    scan(21, 130.0),
    *(odometry(seq, place, 130.0 + seq) for seq, place in enumerate(positions(), 22)),
]


@pytest.mark.parametrize("cut", [0, 8, 17, 21, len(MIXED)])
def test_a_journal_replayed_at_any_point_goes_on_with_the_same_state(cut):
    live = Follower(FLOOR, TERMS)
    journal = []
    for message in parsed(MIXED[:cut]):
        journal.append(message.model_dump_json())
        live.apply(message)
    replayed = Follower(FLOOR, TERMS)
    for text in journal:
        replayed.apply(messages.parse_input(text))
    assert state(replayed) == state(live)
    for message in parsed(MIXED[cut:]):
        live.apply(message)
        replayed.apply(message)
    assert state(replayed) == state(live)


def after_restart(away_s=None, t_s=107.5):
    """The estimate after a new frame, and after its first position."""
    follower = Follower(FLOOR, Terms(particles=3000, seed=5))
    for message in parsed(whole_walk()):
        follower.apply(message)
    resume = {"type": "resume", "seq": 15, "same_frame": False, "away_s": away_s}
    at_once = follower.apply(parsed([resume])[0])
    assert [kind for kind, _ in at_once.events][:1] == ["restarted"]
    first = follower.apply(parsed([odometry(16, [7.0, 7.0], t_s)])[0])
    assert first.error is None
    return at_once.estimate, first.estimate


def test_a_new_frame_keeps_the_place_spread_by_the_time_away():
    short, _ = after_restart(0.0)
    told, after = after_restart(30.0)
    assert short.radius_68_m < 2.0 < told.radius_68_m
    assert (after.radius_68_m, after.walked_m) == (told.radius_68_m, told.walked_m)
    before, timed = after_restart(None, 107.0 + 30.0)
    assert before.radius_68_m == pytest.approx(short.radius_68_m)
    assert timed.radius_68_m == pytest.approx(told.radius_68_m, rel=0.2)
    assert timed.t_s == before.t_s  # the first position of a frame is no move
    _, reset = after_restart(None, 5.0)  # the phone's clock began anew
    assert reset.radius_68_m > short.radius_68_m


def test_moves_in_a_new_frame_are_those_of_its_own_positions():
    follower = Follower(FLOOR, Terms(particles=300, seed=5))
    for message in parsed(whole_walk()):
        walked_m = follower.apply(message).estimate.walked_m
    listed = [{"type": "resume", "seq": 15, "same_frame": False}]
    listed += [odometry(16 + k, [50.0 + 0.5 * k, 9.0], 110.0 + k) for k in range(4)]
    for message in parsed(listed):
        outcome = follower.apply(message)
    assert outcome.error is None
    assert outcome.estimate.walked_m == pytest.approx(walked_m + 1.5)


def test_an_input_that_cannot_be_used_leaves_the_answer_as_it_was():
    follower = Follower(FLOOR, TERMS)
    for message in parsed(whole_walk()):
        before = follower.apply(message).estimate
    outcome = follower.apply(parsed([{"type": "hint", "seq": 15, "room": "nowhere"}])[0])
    assert "nowhere" in outcome.error
    assert outcome.estimate.model_copy(update={"seq": 14}) == before


def test_planes_of_ar_sessions_are_walls():
    walls = np.array(scan_walls())
    webxr, arkit = [], []
    for (x0, z0), (x1, z1) in walls * [1, -1]:
        half = 0.5 * float(np.hypot(x1 - x0, z1 - z0))
        along = np.array([x1 - x0, 0.0, z1 - z0]) / (2 * half)
        normal = np.cross(along, [0.0, -1.0, 0.0])
        matrix = np.eye(4)
        matrix[:3, :3] = np.stack([along, normal, np.cross(along, normal)], axis=1)
        matrix[:3, 3] = [(x0 + x1) / 2, 1.0, (z0 + z1) / 2]
        columns = matrix.T.reshape(-1).tolist()
        corners = [[s * half, 0.0, t] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        polygon = [{"x": x, "y": y, "z": z} for x, y, z in corners]
        webxr.append({"polygon": polygon, "pose": {"matrix": columns}, "orientation": "vertical"})
        size = {"width": 2 * half, "height": 2.0, "rotationOnYAxis": 0.0}
        arkit.append({"transform": columns, "center": [0, 0, 0], "planeExtent": size,
                      "alignment": "vertical"})  # fmt: skip
    answers = []
    for form, planes in (("walls", scan_walls()), ("webxr", webxr), ("arkit", arkit)):
        follower = Follower(FLOOR, TERMS)
        follower.apply(parsed([scan() | {"form": form, "planes": planes}])[0])
        for message in parsed(whole_walk()[1:]):
            outcome = follower.apply(message)
        answers.append([outcome.estimate.x_m, outcome.estimate.y_m])
    assert np.allclose(answers[1], answers[0], atol=0.3)
    assert np.allclose(answers[2], answers[1])


def test_longitude_and_latitude_where_the_plan_knows():
    plan = replace(PLAN, origin=Origin(11.0, 48.0))
    follower = Follower(Floor(rasterize(plan), Namer(plan), "1"), TERMS)
    for message in parsed(whole_walk()):
        found = follower.apply(message).estimate
    place = plan.origin.to_local([[found.lon, found.lat]])[0]
    assert np.allclose(place, [found.x_m, found.y_m], atol=0.01)


def test_facing_is_turned_into_the_map_and_said_with_its_spread():
    follower = Follower(FLOOR, TERMS)
    for message in whole_walk():
        for sample in message.get("samples", ()):
            sample["facing_rad"] = 1.0
        found = follower.apply(parsed([message])[0]).estimate
    assert found.facing_rad == pytest.approx(1.0 + found.drift_rad)
    assert 0 <= found.drift_spread_rad < 1.5


@pytest.mark.parametrize(
    ("walls", "error"),
    [
        ([[[-9e4, 2.0 + 0.01 * i], [9e4, 2.0]] for i in range(12)], None),
        ([[[-9e4, 2.0 + 0.01 * i], [9e4, 2.0]] for i in range(300)], "at most"),
        ([[[1.0, 2.0], [1.0, 2.2 + 0.001 * i]] for i in range(1000)], "at most"),
        ([[[500.0, 2.0], [501.0, 2.0]]], "at least one"),
        ([[[1.0, 2.0], [1.0, 2.0]]], "at least one"),
    ],
)
def test_a_scan_of_absurd_walls_is_cut_or_refused(walls, error):
    follower = Follower(FLOOR, TERMS)
    outcome = follower.apply(parsed([scan() | {"planes": walls}])[0])
    assert not outcome.is_defect
    assert (outcome.error is None) == (error is None)
    assert error is None or error in outcome.error
    if error is None:
        assert np.abs(outcome.scan.walls_m).max() <= 30.0


def test_a_far_jump_costs_no_time_and_no_belief():
    follower = Follower(FLOOR, TERMS)
    for message in parsed([*whole_walk(), odometry(15, [9e4, 9e4]), odometry(16, [9e4, 9e4 + 1])]):
        outcome = follower.apply(message)
    assert outcome.error is None
    assert outcome.estimate.x_m is not None
