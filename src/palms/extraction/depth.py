"""Depth images: the points that they show, and the space that their rays prove empty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from palms.errors import InputError
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray, as_readonly, check_finite

__all__ = ["DepthFrame", "points_of", "step_of"]

_ENOUGH_PIXELS = 2_000_000  # ours: of a whole turn; more only take time
MIN_DEPTH_M = 0.1  # ours: nearer is the user's own hand


@dataclass(frozen=True, slots=True)
class DepthFrame:
    """One depth image and the camera that took it.

    Parameters
    ----------
    depth_m : array_like (h, w)
        Distance along the camera's axis, by row (from the top) and column; NaN or 0 where
        nothing was measured.
    focal_px, centre_px : array_like (2,)
        Focal lengths and principal point, x and y, for an image of this size.
    pose : array_like (4, 4)
        Camera to ground: x right, y up and z backwards in the camera become x and y on the
        ground and height.

    Raises
    ------
    InputError
        When a shape is wrong, the pose is no rotation and translation, or a focal length
        is not above 0.

    Examples
    --------
    >>> level = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 1.4], [0, 0, 0, 1]]
    >>> frame = DepthFrame(np.full((3, 3), 2.0), [3, 3], [1, 1], level)
    >>> frame.ends_m()[1, 1].tolist()
    [0.0, 2.0, 1.4]
    """

    depth_m: FloatArray
    focal_px: FloatArray
    centre_px: FloatArray
    pose: FloatArray

    def __post_init__(self) -> None:
        depth = as_readonly(self.depth_m)
        if depth.ndim != 2 or min(depth.shape) < 2:
            raise InputError(
                "depth image", expected="at least 2 x 2 pixels", got=f"shape {depth.shape}"
            )
        object.__setattr__(self, "depth_m", depth)
        for name in ("focal_px", "centre_px"):
            object.__setattr__(self, name, check_finite(getattr(self, name), name, (2,)))
        pose = check_finite(self.pose, "camera pose", (4, 4))
        object.__setattr__(self, "pose", pose)
        rotation = pose[:3, :3]
        if np.abs(rotation @ rotation.T - np.eye(3)).max() > 0.05 or np.linalg.det(rotation) < 0:
            raise InputError(
                "camera pose", expected="a rotation and a translation", got="another matrix"
            )
        if (self.focal_px <= 0).any():
            raise InputError(
                "focal length", expected="above 0 pixels", got=str(self.focal_px.min())
            )

    @property
    def camera_m(self) -> FloatArray:
        """Where the camera was (3,): on the ground, and its height."""
        return self.pose[:3, 3]

    def ends_m(self, step: int = 1) -> FloatArray:
        """Return where the rays of every `step`-th pixel end (h, w, 3); NaN: not measured."""
        depth = self.depth_m[::step, ::step]
        rows, columns = self.depth_m.shape
        known = np.where(depth >= MIN_DEPTH_M, depth, np.nan)
        right = (np.arange(0, columns, step) - self.centre_px[0]) / self.focal_px[0]
        down = (np.arange(0, rows, step) - self.centre_px[1]) / self.focal_px[1]
        in_camera = np.stack(
            np.broadcast_arrays(right * known, -down[:, None] * known, -known), axis=-1
        )
        return np.asarray(in_camera @ self.pose[:3, :3].T + self.pose[:3, 3])


def step_of(frames: Sequence[DepthFrame]) -> int:
    """Return which rows and columns of images are enough: every first, second, ...

    Examples
    --------
    >>> level = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 1.4], [0, 0, 0, 1]]
    >>> frame = DepthFrame(np.full((192, 256), 2.0), [200, 200], [128, 96], level)
    >>> step_of([frame] * 20), step_of([frame] * 90)
    (1, 2)
    """
    pixels = sum(frame.depth_m.size for frame in frames)
    return max(1, int(np.ceil(np.sqrt(pixels / _ENOUGH_PIXELS))))


def points_of(
    frames: Sequence[DepthFrame], settings: ExtractionSettings, step: int = 1
) -> FloatArray:
    """Return what depth images show as points (P, 3), without edges and what is far.

    Parameters
    ----------
    frames : sequence of DepthFrame
    settings : ExtractionSettings
    step : int
        Only every so manieth row and column.

    Examples
    --------
    >>> level = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 1.4], [0, 0, 0, 1]]
    >>> frame = DepthFrame(np.full((4, 4), 2.0), [3, 3], [1, 1], level)
    >>> points_of([frame], ExtractionSettings()).shape
    (16, 3)
    """
    parts = [np.empty((0, 3))]
    for frame in frames:
        ends = frame.ends_m(step)
        good = _smooth(frame, settings, step) & np.isfinite(ends[..., 0])
        good &= frame.depth_m[::step, ::step] <= settings.range_m
        parts.append(ends[good])
    return np.concatenate(parts)


def _smooth(frame: DepthFrame, settings: ExtractionSettings, step: int) -> np.ndarray:
    """Whether pixels (h, w) lie on a surface, and not on the edge between two."""
    depth = np.where(frame.depth_m >= MIN_DEPTH_M, frame.depth_m, np.nan)
    steepest = np.tan(settings.grazing_rad) / frame.focal_px.min()
    good = np.ones(depth.shape, bool)
    with np.errstate(invalid="ignore"):
        for axis in (0, 1):
            jump = np.abs(np.diff(depth, axis=axis)) > np.maximum(
                steepest * np.take(depth, range(1, depth.shape[axis]), axis=axis), 0.02
            )
            for part in (np.s_[1:], np.s_[:-1]):
                where = (part, slice(None)) if axis == 0 else (slice(None), part)
                good[where] &= ~jump
    return good[::step, ::step]
