"""A small world as files, and the command as a function."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from typer.testing import CliRunner

from palms.cli.app import app
from palms.io import write_plan_csv, write_scan_json
from tests.worlds import seen_from, two_rooms, walk

START = np.array([2.0, 2.0])
STEPS = [*[[0.3, 0.0]] * 4, *[[0.0, 0.3]] * 5, *[[-0.3, 0.0]] * 4]
DRIFT = 0.4


def write_walk(path, **changes):
    odometry = walk(STEPS, DRIFT)
    reference = START + np.cumsum(STEPS, axis=0)
    content = {
        "ARKit_raw_2D": (-odometry.position_m).tolist(),
        "RoNIN_raw_2D": (1.1 * odometry.position_m).tolist(),
        "time_intervals": np.diff(odometry.time_s, prepend=0).tolist(),
        "ARKit_PF": [START.tolist(), *reference[7:].tolist()],
        "session_id": 7,
    }
    content = {key: value for key, value in (content | changes).items() if value is not None}
    path.write_text(json.dumps(content))
    return path


def write_world(folder):
    plan = two_rooms()
    write_plan_csv(plan, folder / "plan.csv")
    session = folder / "Session_7"
    session.mkdir()
    near = np.linalg.norm(plan.segments_m.mean(axis=1) - START, axis=1) < 5
    scan = seen_from(START, plan.segments_m[near], DRIFT)
    write_scan_json(replace(scan, session="7"), session)
    return SimpleNamespace(
        folder=folder,
        plan=folder / "plan.csv",
        scan=session,
        walk=write_walk(folder / "walk.json"),
        steps=len(STEPS),
    )


@pytest.fixture(scope="session")
def world(tmp_path_factory):
    """A plan, a scan and a walk of 13 steps; not to be changed."""
    return write_world(tmp_path_factory.mktemp("world"))


@pytest.fixture
def own_world(tmp_path):
    """The same, to be damaged."""
    return write_world(tmp_path)


@pytest.fixture(scope="session")
def palms():
    """Run the command in this process: result with exit_code, stdout and stderr."""
    runner = CliRunner()

    def run(*arguments):
        return runner.invoke(app, [str(each) for each in arguments])

    return run


@pytest.fixture(scope="session")
def palms_fails(palms):
    """Run a command that must fail with one line; return the line."""

    def run(*arguments):
        result = palms(*arguments)
        assert result.exit_code == 1, result.output
        assert result.stdout == ""
        lines = result.stderr.splitlines()
        assert len(lines) == 1, result.stderr
        assert lines[0].startswith("palms: error: ")
        assert "Traceback" not in result.stderr
        return lines[0]

    return run
