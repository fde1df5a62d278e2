"""How well found walls agree with true ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palms.geometry import FloatArray, directions, lengths

ALONG_M = 0.05  # of a wall, looked at one by one
NEAR_M, NEAR_RAD = 0.06, np.deg2rad(5.0)  # what may be the same wall
COVERED = 0.7  # of a wall's visible length, to count as found


@dataclass(frozen=True)
class Score:
    """Figures of one place.

    Attributes
    ----------
    covered : (K,) share of each true wall's length that found walls lie on
    offset_m, angle_rad : (K,) errors of the found wall that lies on most of it; NaN for none
    spurious : (N,) whether each found wall lies mostly on nothing that is there
    """

    covered: FloatArray
    offset_m: FloatArray
    angle_rad: FloatArray
    spurious: FloatArray


def score(truth: FloatArray, surfaces: FloatArray, found: FloatArray) -> Score:
    """Compare found walls (N, 2, 2) with true ones (K, 2, 2) and with all surfaces (M, 2, 2)."""
    covered, offset, angle = (
        np.zeros(len(truth)),
        np.full(len(truth), np.nan),
        np.full(len(truth), np.nan),
    )
    for k, wall in enumerate(truth):
        near = [lies_on(points_of(wall), other) for other in found]
        if not near:
            continue
        covered[k] = np.any(near, axis=0).mean()
        best = found[int(np.argmax([each.sum() for each in near]))]
        if covered[k] > 0:
            angle[k] = abs(_turn(wall, best))
            middle = points_of(wall)[np.max(near, axis=0)].mean(axis=0)
            offset[k] = abs(_across(middle[None], best)[0])
    spurious = [
        np.any([lies_on(points_of(wall), other) for other in surfaces], axis=0).mean() < 0.5
        for wall in found
    ]
    return Score(covered, offset, angle, np.array(spurious, float))


def points_of(wall: FloatArray) -> FloatArray:
    """Points along a wall, from its first end to its second."""
    count = max(2, int(lengths(wall[None])[0] / ALONG_M))
    share = (np.arange(count) + 0.5) / count
    return wall[0] + share[:, None] * (wall[1] - wall[0])


def lies_on(points: FloatArray, wall: FloatArray) -> np.ndarray:
    """Whether points of one wall lie on another that runs the same way."""
    if abs(_turn(points[[0, -1]], wall)) > NEAR_RAD:
        return np.zeros(len(points), bool)
    length = lengths(wall[None])[0]
    along = (points - wall[0]) @ (wall[1] - wall[0]) / length
    inside = (along >= -ALONG_M) & (along <= length + ALONG_M)
    return inside & (np.abs(_across(points, wall)) <= NEAR_M)


def _across(points: FloatArray, wall: FloatArray) -> FloatArray:
    run = (wall[1] - wall[0]) / lengths(wall[None])[0]
    return (points - wall[0]) @ np.array([-run[1], run[0]])


def _turn(a: FloatArray, b: FloatArray) -> float:
    first, second = directions(np.stack([a, b]))
    return float(np.mod(first - second + np.pi / 2, np.pi) - np.pi / 2)
