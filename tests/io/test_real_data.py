"""The authors' own walk, where the public data is at hand (PALMS_DATA or ../shared/data)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from palms.io import RecordedWalk, read_walk

DEFAULT = Path(__file__).parents[3] / "shared" / "data"
TRACKING = Path(os.environ.get("PALMS_DATA", DEFAULT)) / "palms_be" / "tracking.json"

pytestmark = pytest.mark.skipif(
    not TRACKING.is_file(), reason=f"no {TRACKING}; set PALMS_DATA to the public data"
)


@pytest.fixture(scope="module")
def walk() -> RecordedWalk:
    return read_walk(TRACKING)


def test_what_is_known_of_it(walk):
    assert len(walk) == 289
    assert walk.time_s[-1] == pytest.approx(167.7, abs=0.05)
    assert walk.odometry("arkit").walked_m[-1] == pytest.approx(186, abs=0.5)
    assert walk.has_reference.tolist() == [False] * 7 + [True] * 282
    np.testing.assert_allclose(walk.start_m, [63.28623, 55.21789])
    assert walk.reference_m[7].tolist() == [63.47327, 51.68606]
    assert walk.session == ()


def fit(walk: RecordedWalk, source: str) -> tuple[float, float, float]:
    """Scale, drift in degrees per minute and RMSE of a joint fit to the reference.

    Each move is turned by a heading that drifts linearly with time, then all is scaled,
    turned and shifted; plain least squares.
    """
    odometry, known = walk.odometry(source), walk.has_reference

    def residuals(p: np.ndarray) -> np.ndarray:
        x, y, angle, log_scale, rate = p  # by its logarithm: -1 would be a half turn
        turn = angle + rate * odometry.time_s
        c, s = np.cos(turn), np.sin(turn)
        dx, dy = odometry.displacements_m.T
        path = np.cumsum(np.column_stack([c * dx - s * dy, s * dx + c * dy]), axis=0)
        return (np.exp(log_scale) * path + [x, y] - walk.reference_m)[known].ravel()

    starts = [np.array([*walk.start_m, a, 0.0, 0.0]) for a in np.arange(0, 2 * np.pi, np.pi / 4)]
    best = min((least_squares(residuals, start) for start in starts), key=lambda f: f.cost)
    rmse = np.sqrt(2 * best.cost / known.sum())
    return float(np.exp(best.x[3])), float(np.degrees(best.x[4]) * 60), float(rmse)


@pytest.mark.parametrize(
    ("source", "scale", "drift", "rmse"),
    [("arkit", 1.008, -0.7, 1.5), ("ronin", 1.075, -4.6, 1.25)],
)
def test_the_stated_fit_is_reproduced(walk, source, scale, drift, rmse):
    found = fit(walk, source)
    assert found[0] == pytest.approx(scale, abs=0.003)
    assert found[1] == pytest.approx(drift, abs=0.2)
    assert found[2] == pytest.approx(rmse, abs=0.08)


def test_the_frame_is_not_mirrored(walk):
    """Negating keeps the handedness: the same fit of the mirrored walk is far worse."""
    odometry, known = walk.odometry("arkit"), walk.has_reference
    z = odometry.position_m[known] @ [1, 1j]
    reference = walk.reference_m[known] @ [1, 1j]

    def rmse(points: np.ndarray) -> float:
        design = np.column_stack([points, np.ones(len(points))])
        solution = np.linalg.lstsq(design, reference, rcond=None)[0]
        return float(np.sqrt(np.mean(np.abs(design @ solution - reference) ** 2)))

    assert rmse(z) < 2.5
    assert rmse(z.conj()) > 5
