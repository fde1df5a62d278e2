"""Where one scan may have been taken: poses, each judged by itself, with their shares."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms.building import Atlas
from palms.geometry import FloatArray, as_readonly
from palms.heatmap import Candidates
from palms.hints import Hint
from palms.observation import (
    ScanPoints,
    empty_nats,
    rough_nats,
    scan_points,
    search,
    wall_nats,
)
from palms.particles import resample_systematic
from palms.randomness import RandomKey, as_key
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import ObservationSettings

__all__ = ["Posterior", "hinted", "judged", "posterior"]

_INDEX, _PLACE, _TURN, _CHOOSE = 0, 1, 2, 3  # purposes of random numbers
FEW = 500  # ours: poses that set what the others must reach


@dataclass(frozen=True, slots=True)
class Posterior:
    """Where a scan may have been taken, over an even prior inside the building.

    Parameters
    ----------
    drifts_rad : (K,)
        The drifts that were tried.
    position_m : (P, 2)
        Poses, map frame.
    drift_rad : (P,)
    label : (P,) int32
        Index of the tried drift that each belongs to.
    score : (P,)
        What the scan says about them, in nats.
    log_weight : (P,)
        Natural logarithm of each pose's share; the shares sum to 1.
    mass : float
        Share of the whole belief that they stand for; the plan may not show the scan's
        surroundings at all.
    drift_step_rad : float
        Between the tried drifts.
    log_mean : float
        Logarithm of the mean likelihood over the prior.
    points : ScanPoints
        What was judged.
    """

    drifts_rad: FloatArray
    position_m: FloatArray
    drift_rad: FloatArray
    label: npt.NDArray[np.int32]
    score: FloatArray
    log_weight: FloatArray
    mass: float
    drift_step_rad: float
    log_mean: float
    points: ScanPoints

    def __len__(self) -> int:
        return len(self.position_m)


def posterior(
    scan: Scan, raster: PlanRaster, settings: ObservationSettings | None = None
) -> Posterior:
    """Return where in the building a scan may have been taken, and how its frame lies.

    Parameters
    ----------
    scan : Scan
    raster : PlanRaster
    settings : ObservationSettings, optional

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> from palms.raster import rasterize
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[4, 4], [4, 2]]])
    >>> found = posterior(Scan(room - (2.1, 1.1)), rasterize(FloorPlan(room)))
    >>> (np.exp(found.log_weight) @ found.position_m).round(1).tolist()
    [2.1, 1.1]
    """
    settings = settings or ObservationSettings()
    points = scan_points(scan, settings)
    return judged(search(scan, raster, settings), points, raster, settings)


def hinted(
    found: Posterior, hint: Hint, raster: PlanRaster, atlas: Atlas | None = None
) -> Posterior:
    """Weigh a posterior by a hint; the share of the belief that lies anywhere is weighed, too.

    Parameters
    ----------
    found : Posterior
    hint : Hint
    raster : PlanRaster
        That of the atlas, where there is one.
    atlas : Atlas, optional
        Of a building of several levels.

    Raises
    ------
    InputError
        When the plan has no such room or level, or nothing inside lies near the place.
    """
    log_weight = found.log_weight + np.log(hint.ratio(found.position_m, raster, atlas))
    spoken = math.log(np.exp(log_weight - log_weight.max()).sum()) + float(log_weight.max())
    kept = found.mass * math.exp(spoken)  # any place has a ratio of 1 in the mean
    return replace(
        found, log_weight=as_readonly(log_weight - spoken), mass=kept / (kept + 1 - found.mass)
    )


def judged(
    candidates: Candidates, points: ScanPoints, raster: PlanRaster, settings: ObservationSettings
) -> Posterior:
    """Propose poses by the candidates, look at each roughly, and judge the better ones.

    A pose is judged with a probability that its rough likelihood, made flat, decides, and
    weighs the more the rarer it was (importance sampling in two stages). The poses are always
    the same: they stand for an integral, as the cells of a grid would, and every filter that
    starts from them draws for itself.

    Parameters
    ----------
    candidates : Candidates
        From `palms.observation.search`.
    points : ScanPoints
        The same scan.
    raster : PlanRaster
    settings : ObservationSettings
    """
    chance = np.exp(candidates.log_weight)
    index, position, drift = _proposed(candidates, chance, settings.n_proposals, as_key(0))
    rough = settings.rough_power * rough_nats(points, raster, position, drift, settings)
    worth = np.exp(rough - rough.max()) / chance[index]
    some = resample_systematic(worth / worth.sum(), settings.n_judged, as_key(_CHOOSE))
    index, position, drift, rare = index[some], position[some], drift[some], rough[some]
    score = _scores(points, raster, (position, drift), rare, settings)
    nats = settings.strength * score - rare
    top = float(nats.max())
    kept = np.flatnonzero(nats >= top - settings.keep_nats)
    share = np.exp(nats[kept] - top)
    mean = share.sum() / len(nats) * worth.mean() * chance.sum() / candidates.n_poses
    return Posterior(
        candidates.drifts_rad, as_readonly(position[kept]), as_readonly(drift[kept]),
        as_readonly(candidates.label[index[kept]], np.int32), as_readonly(score[kept]),
        as_readonly(np.log(share / share.sum())), 1 - settings.elsewhere,
        candidates.drift_step_rad, top + float(rough.max()) + math.log(mean), points,
    )  # fmt: skip


def _scores(
    points: ScanPoints,
    raster: PlanRaster,
    poses: tuple[FloatArray, FloatArray],
    rare: FloatArray,
    settings: ObservationSettings,
) -> FloatArray:
    """Judge poses (N,): -inf for those that are dropped as soon as their walls are known.

    Empty space can only speak against a pose, and the best few set what is to be reached.
    """
    position, drift = poses
    walls = wall_nats(points, raster, position, drift, settings)
    score, most = np.full(len(walls), -np.inf), settings.strength * walls - rare

    def judge(some: npt.NDArray[np.int64]) -> None:
        empty = empty_nats(points, raster, position[some], drift[some], settings)
        score[some] = walls[some] + empty

    judge(np.argsort(-most)[:FEW])
    least = float((settings.strength * score - rare).max()) - settings.keep_nats
    judge(np.flatnonzero(np.isinf(score) & (most >= least)))
    return score


def _proposed(
    candidates: Candidates, chance: FloatArray, n: int, key: RandomKey
) -> tuple[npt.NDArray[np.int64], FloatArray, FloatArray]:
    """Draw n cells by their chance, and a pose in each: index, position and drift."""
    index = resample_systematic(chance, n, key.child(_INDEX))
    position, drift, turn = np.empty((n, 2)), np.empty(n), np.empty((n, 1))
    loops.place(
        candidates.cells, candidates.drift_rad, index, candidates.grid.cell_size_m,
        candidates.grid.origin_m, key.child(_PLACE).word, position, drift,
    )  # fmt: skip
    loops.uniforms(key.child(_TURN).word, 1, turn)
    return index, position, drift + (turn[:, 0] - 0.5) * candidates.drift_step_rad
