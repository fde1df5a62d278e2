"""A LiDAR scan of a simulated world, as a phone's plane detection reports it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.evaluation.simulation.patches import merge_patches, noisy_planes
from palms.evaluation.simulation.rays import cast_rays, rings_to_segments
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
    free = _coverage(here, _swept(here, origins, hits), noise.range_m, drift_rad)
    free[~_looked(first - drift_rad, noise)] = np.nan
    scan = Scan(rotate(planes - here, -drift_rad), coverage_m=as_readonly(free))
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


def _swept(here: FloatArray, origins: FloatArray, hits: FloatArray) -> FloatArray:
    """Outline, as segments, of all that the rays and the user's own body showed to be free."""
    import shapely

    starts, first = np.unique(origins, axis=0, return_index=True)
    fans = np.split(hits, np.sort(first)[1:])
    shapes = [
        shapely.Polygon(np.concatenate([origins[at : at + 1], fan]))
        for at, fan in zip(np.sort(first), fans, strict=True)
    ]
    body = shapely.MultiPoint([*starts, here]).convex_hull.buffer(0.02)
    area = shapely.union_all([*shapely.make_valid(shapes), body]).buffer(0.02).buffer(-0.02)
    rings = shapely.get_rings(shapely.get_parts(area))
    return rings_to_segments([shapely.get_coordinates(ring) for ring in rings])


def _coverage(
    here: FloatArray, outline: FloatArray, range_m: float, drift_rad: float
) -> FloatArray:
    """Free range (360,) by bearing in the odom frame, seen from the observation point."""
    count = _BINS * _RAYS_PER_BIN
    bearings = (np.arange(count) + 0.5) * 2 * np.pi / count + drift_rad
    free, _ = cast_rays(np.broadcast_to(here, (count, 2)), bearings, outline)
    return np.asarray(np.minimum(free, range_m).reshape(_BINS, _RAYS_PER_BIN).min(axis=1))


def _looked(first_rad: float, noise: ScannerNoise) -> npt.NDArray[np.bool_]:
    """Whether each bearing (360,) of the odom frame came into view."""
    middle = (np.arange(_BINS) + 0.5) * 2 * np.pi / _BINS
    turned = np.mod(middle - (first_rad - noise.view_rad / 2), 2 * np.pi)
    return np.asarray(turned <= noise.turn_rad + noise.view_rad)
