"""From a picture of a plan, RoomPlan and a pose log to a position, by three commands."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from palms.cli.app import app
from palms.io import open_dataset
from palms.sample import sample_folder

PHONE = sample_folder() / "phone"
SCALE_M = 0.05


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the three commands of the README wrote their results."""
    place = tmp_path_factory.mktemp("phone")
    commands = (
        f"plan convert {PHONE}/plan.png {place}/plan.csv --scale {SCALE_M}",
        f"locate {place}/plan.csv {PHONE}/room.json --json {place}/places.json",
        f"track {place}/plan.csv {PHONE}/room.json {PHONE}/poses.csv --json {place}/track.json",
    )
    for command in commands:
        done = CliRunner().invoke(app, command.split())
        assert done.exit_code == 0, done.output
    return place


@pytest.fixture(scope="module")
def case():
    (only,) = open_dataset(sample_folder()).cases
    return only


def in_map(case, points):
    """Points of the picture in the frame of the sample's plan; its margin is a metre."""
    return np.asarray(points, float) + case.plan().bounds_m[0] - 1.0


def test_the_scan_alone_lists_the_true_place(folder, case):
    places = json.loads((folder / "places.json").read_text())["candidates"]
    found = in_map(case, [[each["x_m"], each["y_m"]] for each in places])
    label = case.label()
    near = np.hypot(*(found - label.position_m).T) < 1.0
    assert near[:3].any()


def test_the_walk_ends_where_it_truly_did(folder, case):
    (trial,) = json.loads((folder / "track.json").read_text())["trials"]
    steps, truth = trial["steps"], case.walk().truth
    assert trial["localized_at_s"] is not None
    told = in_map(case, np.column_stack([steps["x_m"], steps["y_m"]]))
    time = np.array(steps["t_s"])
    there = np.column_stack([np.interp(time, truth.time_s, each) for each in truth.position_m.T])
    after = time >= trial["localized_at_s"]
    off = np.hypot(*(told - there)[after].T)
    assert np.mean(off < 1.0) > 0.95
    assert off[-1] < 0.5
    assert steps["stage"][-1] == "localized"
