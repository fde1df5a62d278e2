"""A LiDAR scan of a simulated world, as a phone's plane detection reports it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palms.evaluation.simulation.patches import merge_patches, noisy_planes
from palms.evaluation.simulation.rays import cast_rays
from palms.evaluation.simulation.settings import ScannerNoise
from palms.evaluation.simulation.world import World
from palms.geometry import (
    FloatArray,
    as_readonly,
    check_finite,
    distance_to_segments,
    rotate,
)
from palms.scan import Scan

__all__ = ["SimulatedScan", "take_scan"]

_BINS = 360  # ours: bearings of a scan's coverage
_RAYS_PER_BIN = 3  # ours
_VIEW_STEP_RAD = np.deg2rad(5.0)  # ours: turn between two frames


@dataclass(frozen=True, slots=True)
class SimulatedScan:
    """A scan and where it was really taken.

    Parameters
    ----------
    scan : Scan
        In the odom frame, whose origin is the observation point.
    position_m : array_like (2,)
        The observation point, in the map frame.
    drift_rad : float
        Turns odom vectors into map vectors.

    Examples
    --------
    >>> SimulatedScan(Scan([[[2, -2], [2, 2]]]), [10.0, 5.0], 0.3).position_m.tolist()
    [10.0, 5.0]
    """

    scan: Scan
    position_m: FloatArray
    drift_rad: float

    def __post_init__(self) -> None:
        position = check_finite(self.position_m, "the scan's true position", (2,))
        object.__setattr__(self, "position_m", position)

    def to_map(self, points_m: FloatArray) -> FloatArray:
        """Points (..., 2) of the odom frame in the map frame."""
        return rotate(points_m, self.drift_rad) + self.position_m


def take_scan(
    world: World,
    position_m: FloatArray,
    drift_rad: float,
    noise: ScannerNoise,
    rng: np.random.Generator,
) -> SimulatedScan:
    """Turn round with the phone in hand and report the walls that it saw.

    The phone moves on a circle and looks outwards; it starts at the observation point, in
    a random direction.

    Parameters
    ----------
    world : World
    position_m : array_like (2,)
        The observation point, in the map frame.
    drift_rad : float
        The session's drift: odom vectors turned by it are map vectors.
    noise : ScannerNoise
    rng : numpy.random.Generator

    Raises
    ------
    InputError
        When no wall was seen at all.

    Examples
    --------
    >>> from palms.evaluation.simulation.settings import WorldNoise
    >>> from palms.evaluation.simulation.world import make_world
    >>> from palms.floorplan import FloorPlan
    >>> square = FloorPlan([[[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, 0]]])
    >>> rng = np.random.default_rng(0)
    >>> world = make_world(square, WorldNoise.none(), rng)
    >>> taken = take_scan(world, [2.0, 1.0], 0.5, ScannerNoise.none(), rng)
    >>> len(taken.scan.walls_m), len(taken.scan.coverage_m)
    (4, 360)
    """
    here = check_finite(position_m, "the scan's position", (2,))
    reach = noise.range_m + 2 * noise.circle_max_m
    clear = ~world.is_glass | (rng.random(len(world.is_glass)) < noise.glass_seen_share)
    near = world.seen_m[clear & (distance_to_segments(here, world.seen_m) <= reach)]
    radius = rng.uniform(noise.circle_min_m, noise.circle_max_m)
    first = rng.uniform(-np.pi, np.pi)
    origins, bearings = _rays(here, radius, first, noise)
    range_m, index = cast_rays(origins, bearings, near)
    index[range_m > noise.range_m] = -1
    hits = origins + np.minimum(range_m, noise.range_m)[:, None] * _unit(bearings)
    patches = merge_patches(near, hits, index, noise.merge_gap_m)
    planes = noisy_planes(patches, here, noise, rng)
    free = _coverage(here, drift_rad, (origins, hits), noise)
    odom = rotate(planes - here, -drift_rad)
    scan = Scan(odom, coverage_m=as_readonly(free))
    return SimulatedScan(scan, here, drift_rad)


def _unit(bearings: FloatArray) -> FloatArray:
    return np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)


def _rays(
    here: FloatArray, radius: float, first: float, noise: ScannerNoise
) -> tuple[FloatArray, FloatArray]:
    """Origins (R, 2) and bearings (R,) of all rays, frame by frame."""
    centre = here - radius * _unit(np.array(first))
    frames = max(2, round(noise.turn_rad / _VIEW_STEP_RAD) + 1)
    looks = first + np.linspace(0.0, noise.turn_rad, frames)
    fan = np.arange(-noise.view_rad / 2, noise.view_rad / 2 + noise.ray_rad / 2, noise.ray_rad)
    origins = np.repeat(centre + radius * _unit(looks), len(fan), axis=0)
    return origins, (looks[:, None] + fan).ravel()


def _coverage(
    here: FloatArray, drift_rad: float, rays: tuple[FloatArray, FloatArray], noise: ScannerNoise
) -> FloatArray:
    """Free range (360,) by bearing in the odom frame; NaN where nobody looked."""
    import shapely

    origins, hits = rays
    per_frame = round(noise.view_rad / noise.ray_rad) + 1
    frames = origins.reshape(-1, per_frame, 2), hits.reshape(-1, per_frame, 2)
    fans = [np.concatenate([start[:1], ends]) for start, ends in zip(*frames, strict=True)]
    swept = shapely.union_all(shapely.make_valid(shapely.polygons(fans))).buffer(0.01)
    inner = (np.arange(_BINS * _RAYS_PER_BIN) + 0.5) * 2 * np.pi / (_BINS * _RAYS_PER_BIN)
    ends = here + (noise.range_m * _unit(inner + drift_rad))
    lines = shapely.linestrings(np.stack([np.broadcast_to(here, ends.shape), ends], axis=1))
    seen = shapely.intersection(lines, swept)
    start = shapely.Point(here)
    first = [_part_from(geometry, start) for geometry in seen]
    by_bin = np.array(first).reshape(_BINS, _RAYS_PER_BIN).min(axis=1)
    return np.where(by_bin > noise.circle_max_m, by_bin, np.nan)
