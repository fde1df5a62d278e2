"""What was asked for, on simulated turns whose truth is known (all figures: docs/results.md)."""

import numpy as np
import pytest

from benchmarks.walls import simulated
from benchmarks.walls.score import COVERED, score
from palms.evaluation.simulation import DepthCamera


@pytest.fixture(scope="module")
def scores():
    simulated_camera, simulated.CAMERA = simulated.CAMERA, DepthCamera(columns=96, rows=72)
    try:
        return [simulated.run(kind, place) for kind in simulated.BUILDINGS for place in range(4)]
    finally:
        simulated.CAMERA = simulated_camera


def test_walls_are_found_where_they_are(scores):
    found = np.concatenate([s.covered >= COVERED for s, _, _ in scores])
    offset = np.concatenate([s.offset_m for s, _, _ in scores])[found]
    angle = np.concatenate([s.angle_rad for s, _, _ in scores])[found]
    assert len(found) > 50
    assert found.mean() >= 0.95
    assert np.quantile(offset, 0.95) <= simulated.OFFSET_M
    assert np.quantile(angle, 0.9) <= simulated.ANGLE_RAD


def test_what_is_found_is_there(scores):
    assert np.concatenate([s.spurious for s, _, _ in scores]).mean() <= 0.05


def test_the_score_tells_right_from_wrong():
    truth = np.array([[[0.0, 0.0], [2.0, 0.0]], [[0.0, 3.0], [2.0, 3.0]]])
    found = np.array([[[0.0, 0.01], [2.0, 0.01]], [[5.0, 0.0], [5.0, 2.0]]])
    result = score(truth, truth, found)
    assert result.covered.tolist() == [1.0, 0.0]
    assert result.offset_m[0] == pytest.approx(0.01)
    assert result.spurious.tolist() == [0.0, 1.0]
