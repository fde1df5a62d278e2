"""Places: the few spots that many candidate cells stand for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.building import Atlas
from palms.geometry import FloatArray, wrap_angle
from palms.heatmap import Candidates
from palms.posterior import Posterior

__all__ = ["Place", "find_places", "place_on_level"]

SEPARATION_M = 1.0  # ours: as p_within_1m, one place
SEPARATION_RAD = 0.35  # ours: 20 degrees
DUST = 1e-6  # ours: cells of less than this of the best one's share are left out


class Place(NamedTuple):
    """A spot where the scan may have been taken.

    Attributes
    ----------
    x_m, y_m : float
        In the map frame.
    drift_rad : float
        In (-pi, pi].
    p : float
        Probability that the cells around it stand for.
    score : float
        Of its best cell, as in the heatmap.
    level : str or None
        In a building of several levels.
    """

    x_m: float
    y_m: float
    drift_rad: float
    p: float
    score: float
    level: str | None = None


def place_on_level(place: Place, atlas: Atlas) -> Place:
    """Return a place of an atlas as one in the map, with its level.

    Parameters
    ----------
    place : Place
    atlas : Atlas
        Of a building of several levels.
    """
    here = np.array([[place.x_m, place.y_m]])
    x, y = atlas.folded(here)[0]
    level = atlas.names[int(atlas.level_of(here)[0])]
    return place._replace(x_m=float(x), y_m=float(y), level=level)


def find_places(
    candidates: Candidates | Posterior, separation_m: float = SEPARATION_M
) -> tuple[Place, ...]:
    """Gather candidate cells around the best of them, those of other drifts apart.

    Going down the scores, a cell that no peak has within `separation_m` becomes a peak; every
    other cell belongs to the nearest of the peaks before it. A drift that differs by
    `SEPARATION_RAD` counts as far as `separation_m`. Cells of hardly any share are left out.

    Parameters
    ----------
    candidates : Candidates or Posterior
    separation_m : float
        Above 0.

    Returns
    -------
    tuple of Place
        Most probable first, equal ones by score; their probabilities sum to the
        candidates' mass.

    Examples
    --------
    >>> from palms.grid import Grid
    >>> cells, label = np.array([[0, 0], [0, 1], [0, 40]], np.int32), np.zeros(3, np.int32)
    >>> found = Candidates(
    ...     Grid((0, 0), 0.1, (50, 50)), np.zeros(1), cells, label,
    ...     np.array([3, 2, 1], np.float32), np.log([0.5, 0.3, 0.2]),
    ... )
    >>> [(round(place.x_m, 2), round(place.p, 2)) for place in find_places(found)]
    [(0.05, 0.8), (4.05, 0.2)]
    """
    if not len(candidates):
        return ()
    share = np.exp(candidates.log_weight - candidates.log_weight.max())
    share *= min(candidates.mass, 1.0) / share.sum()
    index = np.flatnonzero(share >= DUST * share.max())
    index = index[np.argsort(-candidates.score[index], kind="stable")]
    position, drift = candidates.position_m[index], candidates.drift_rad[index]
    reach = separation_m / SEPARATION_RAD
    turned = reach * np.stack([np.cos(drift), np.sin(drift)], axis=1)
    peaks, owner = _peaks(np.concatenate([position, turned], axis=1), separation_m)
    p = np.bincount(owner, share[index], minlength=len(peaks))
    places = (
        Place(
            float(position[i, 0]), float(position[i, 1]), float(wrap_angle(float(drift[i]))),
            float(p[k]), float(candidates.score[index[i]]),
        )
        for k, i in enumerate(peaks)
    )  # fmt: skip
    return tuple(sorted(places, key=lambda place: (-place.p, -place.score)))


def _peaks(position: FloatArray, separation_m: float) -> tuple[list[int], npt.NDArray[np.int64]]:
    """Peaks among points (N, D) in order of score, and each point's peak.

    Each peak looks at the points of a strip around it, across the longer side of them all.
    """
    nearest = np.full(len(position), np.inf)
    owner = np.zeros(len(position), np.int64)
    peaks: list[int] = []
    along = position[:, np.ptp(position[:, :2], axis=0).argmax()]
    order = np.argsort(along)
    reach = separation_m * (1 + 1e-6)
    first, last = (np.searchsorted(along[order], along + side) for side in (-reach, reach))
    for i in range(len(position)):
        if nearest[i] < np.inf:
            continue
        near = order[first[i] : last[i]]
        near = near[near >= i]
        away = np.linalg.norm(position[near] - position[i], axis=1)
        mine = (away <= separation_m) & (away < nearest[near])
        nearest[near[mine]], owner[near[mine]] = away[mine], len(peaks)
        peaks.append(i)
    return peaks, owner
