"""A depth camera turned round in a simulated world: images whose truth is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.evaluation.simulation.world import World
from palms.extraction import DepthFrame
from palms.geometry import FloatArray, check_finite, distance_to_segments, lengths, rotate

__all__ = ["DepthCamera", "DepthSequence", "take_depth"]

CEILING_M, LOW_M = 2.7, 0.75  # simulation: rooms; desks and chests
_CHUNK = 2_000_000  # ours: ray-segment pairs at a time, some 100 MB


@dataclass(frozen=True, slots=True)
class DepthCamera:
    """A phone's depth camera and how it is held.

    Parameters
    ----------
    columns, rows : int
        Of an image.
    view_rad : float
        Angle of view across.
    frames : int
        Images of a whole turn.
    height_m, circle_m : float
        Where the camera is held: above the floor, and from the axis of the turn.
    pitch_rad, pitch_sd_rad : float
        How far it looks down, and how much that varies (simulation).
    range_m : float
        Nothing is measured beyond (the maker's figure for phones: 5 m).
    noise_m, noise_share : float
        Standard deviation of depth, once and per metre (simulation: 3 mm and 0.7 %).
    edge_share : float
        Share of the pixels at edges that lie between the two surfaces (simulation).
    missing_share : float
        Share of the pixels without depth (simulation).
    drift_m, drift_rad : float
        How far the pose is off at the end of the turn (simulation: 1 cm, 0.2 degrees).

    Examples
    --------
    >>> DepthCamera.perfect(frames=12).noise_share
    0.0
    """

    columns: int = 64
    rows: int = 48
    view_rad: float = float(np.deg2rad(62.0))
    frames: int = 48
    height_m: float = 1.4
    circle_m: float = 0.35
    pitch_rad: float = float(np.deg2rad(8.0))
    pitch_sd_rad: float = float(np.deg2rad(4.0))
    range_m: float = 5.0
    noise_m: float = 0.003
    noise_share: float = 0.007
    edge_share: float = 0.5
    missing_share: float = 0.02
    drift_m: float = 0.01
    drift_rad: float = float(np.deg2rad(0.2))

    @classmethod
    def perfect(cls, **changes: float) -> DepthCamera:
        """Return the camera that errs in nothing, with some numbers changed."""
        exact = dict.fromkeys(
            ("noise_m", "noise_share", "edge_share", "missing_share", "drift_m", "drift_rad"), 0.0
        )
        return cls(**{**exact, **changes})  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class DepthSequence:
    """Depth images of one turn, and what they show.

    Parameters
    ----------
    frames : tuple of DepthFrame
        In the odom frame, whose origin is the axis of the turn; heights above the floor.
    surfaces_m : ndarray (N, 2, 2)
        Upright surfaces of the world that reach over a man's height, odom frame.
    seen_m : ndarray (K, 2, 2)
        The stretches of them that the rays met, odom frame.
    """

    frames: tuple[DepthFrame, ...]
    surfaces_m: FloatArray
    seen_m: FloatArray


def take_depth(
    world: World,
    position_m: npt.ArrayLike,
    drift_rad: float,
    camera: DepthCamera,
    rng: np.random.Generator,
) -> DepthSequence:
    """Turn round once with a depth camera in hand.

    Parameters
    ----------
    world : World
        Glass lets the rays through; furniture that is not seen whole is low.
    position_m : array_like (2,)
        The axis of the turn, in the map frame.
    drift_rad : float
        The session's drift: odom vectors turned by it are map vectors.
    camera : DepthCamera
    rng : numpy.random.Generator

    Examples
    --------
    >>> from palms.evaluation.simulation.settings import WorldNoise
    >>> from palms.evaluation.simulation.world import make_world
    >>> from palms.floorplan import FloorPlan
    >>> square = FloorPlan([[[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, 0]]])
    >>> rng = np.random.default_rng(0)
    >>> world = make_world(square, WorldNoise.none(), rng)
    >>> taken = take_depth(world, [2.0, 1.0], 0.5, DepthCamera(frames=12), rng)
    >>> len(taken.frames), len(taken.seen_m)
    (12, 4)
    """
    here = check_finite(position_m, "the scan's position", (2,))
    surfaces, heights = _surfaces(world, here, camera)
    surfaces = rotate(surfaces - here, -drift_rad)
    frames, marks = [], [np.empty((0, 3))]
    for bearing, pose in _poses(camera, rng):
        depth, met, places = _image(pose, camera, surfaces, heights)
        marks.append(np.column_stack([met, places])[met >= 0])
        depth = _spoilt(depth, camera, rng)
        focal = camera.columns / 2 / np.tan(camera.view_rad / 2)
        centre = np.array([camera.columns - 1, camera.rows - 1]) / 2
        frames.append(DepthFrame(depth, np.full(2, focal), centre, _drifted(pose, bearing, camera)))
    tall = heights >= CEILING_M
    seen = _stretches(surfaces, np.concatenate(marks), tall)
    return DepthSequence(tuple(frames), surfaces[tall], seen)


def _surfaces(world: World, here: FloatArray, camera: DepthCamera) -> tuple[FloatArray, FloatArray]:
    """Upright surfaces (N, 2, 2) nearby and their heights (N,)."""
    tall = world.seen_m[~world.is_glass]
    known = {tuple(row) for row in world.seen_m.reshape(-1, 4)}
    others = [row for row in world.blocking_m.reshape(-1, 4) if tuple(row) not in known]
    low = np.array(others).reshape(-1, 2, 2)
    surfaces = np.concatenate([tall, low])
    heights = np.repeat([CEILING_M, LOW_M], [len(tall), len(low)])
    near = distance_to_segments(here, surfaces) <= camera.range_m + 2 * camera.circle_m
    return surfaces[near], heights[near]


def _poses(camera: DepthCamera, rng: np.random.Generator) -> list[tuple[float, FloatArray]]:
    """Share of the turn and camera to ground, for each image."""
    first = rng.uniform(-np.pi, np.pi)
    poses = []
    for share in np.arange(camera.frames) / camera.frames:
        look = first + 2 * np.pi * share
        down = camera.pitch_rad + rng.normal(0.0, camera.pitch_sd_rad)
        ahead = np.array([np.cos(look) * np.cos(down), np.sin(look) * np.cos(down), -np.sin(down)])
        right = np.array([np.sin(look), -np.cos(look), 0.0])
        pose = np.eye(4)
        pose[:3, :3] = np.stack([right, np.cross(right, ahead), -ahead], axis=1)
        pose[:3, 3] = [
            camera.circle_m * np.cos(look), camera.circle_m * np.sin(look), camera.height_m
        ]  # fmt: skip
        poses.append((float(share), pose))
    return poses


def _drifted(pose: FloatArray, share: float, camera: DepthCamera) -> FloatArray:
    """Return the pose that the phone believes: off by what has gathered since the start."""
    turn = share * camera.drift_rad
    wrong = np.eye(4)
    wrong[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    wrong[:2, 3] = share * camera.drift_m * np.array([0.6, 0.8])
    return wrong @ pose


def _image(
    pose: FloatArray, camera: DepthCamera, surfaces: FloatArray, heights: FloatArray
) -> tuple[FloatArray, npt.NDArray[np.int64], FloatArray]:
    """Depth (h, w), the surface that each ray met (h * w,) and where on the ground (h * w, 2)."""
    focal = camera.columns / 2 / np.tan(camera.view_rad / 2)
    right = (np.arange(camera.columns) - (camera.columns - 1) / 2) / focal
    down = (np.arange(camera.rows) - (camera.rows - 1) / 2) / focal
    x, y = np.meshgrid(right, -down)
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3) @ pose[:3, :3].T
    eye = pose[:3, 3]
    with np.errstate(divide="ignore"):
        depth = np.where(rays[:, 2] < 0, -eye[2], CEILING_M - eye[2]) / rays[:, 2]
    met = np.full(len(rays), -1)
    size = max(1, _CHUNK // max(len(surfaces), 1))
    for start in range(0, len(rays), size) if len(surfaces) else ():
        part = slice(start, start + size)
        hit = _upright(rays[part], eye, surfaces, heights)
        nearest = hit.argmin(axis=1)
        shortest = hit[np.arange(len(hit)), nearest]
        met[part] = np.where(shortest < depth[part], nearest, -1)
        depth[part] = np.minimum(depth[part], shortest)
    depth[depth * np.linalg.norm(rays, axis=1) > camera.range_m] = np.nan
    met[np.isnan(depth)] = -1
    places = eye[:2] + depth[:, None] * rays[:, :2]
    return depth.reshape(x.shape), met, places


def _upright(
    rays: FloatArray, eye: FloatArray, surfaces: FloatArray, heights: FloatArray
) -> FloatArray:
    """Depth (R, N) at which rays meet upright surfaces; infinity where they do not."""
    ux, uy, uz = (rays[:, k, None] for k in range(3))
    ex, ey = (surfaces[:, 1] - surfaces[:, 0]).T
    ax, ay = (surfaces[:, 0] - eye[:2]).T
    cross = ux * ey - uy * ex
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (ax * ey - ay * ex) / cross
        share = (ax * uy - ay * ux) / cross
        height = eye[2] + depth * uz
        meets = (depth > 0) & (share >= -1e-9) & (share <= 1 + 1e-9)
        meets &= (height >= 0) & (height <= heights)
    return np.where(meets, depth, np.inf)


def _spoilt(depth: FloatArray, camera: DepthCamera, rng: np.random.Generator) -> FloatArray:
    """Give depth (h, w) a sensor's errors."""
    spoilt = depth.copy()
    with np.errstate(invalid="ignore"):
        edge = np.abs(np.diff(depth, axis=1)) > 0.3
    mixed = edge & (rng.random(edge.shape) < camera.edge_share)
    share = rng.random(edge.shape)
    between = share * depth[:, :-1] + (1 - share) * depth[:, 1:]
    spoilt[:, :-1] = np.where(mixed, between, depth[:, :-1])
    spoilt += rng.normal(0.0, 1.0, depth.shape) * (camera.noise_m + camera.noise_share * depth)
    spoilt[rng.random(depth.shape) < camera.missing_share] = np.nan
    return np.round(spoilt, 3)


def _stretches(
    surfaces: FloatArray, marks: FloatArray, tall: npt.NDArray[np.bool_], gap_m: float = 0.3
) -> FloatArray:
    """Stretches (K, 2, 2) of tall surfaces that rays met without a gap."""
    found = [np.empty((0, 2, 2))]
    length = lengths(surfaces)
    for index in np.unique(marks[:, 0]).astype(int):
        if not tall[index]:
            continue
        start = surfaces[index, 0]
        along = (surfaces[index, 1] - start) / length[index]
        places = np.sort((marks[marks[:, 0] == index, 1:] - start) @ along)
        for part in np.split(places, np.flatnonzero(np.diff(places) > gap_m) + 1):
            if part[-1] > part[0]:
                found.append((start + part[[0, -1], None] * along)[None])
    return np.concatenate(found)
