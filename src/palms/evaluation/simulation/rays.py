"""Rays against segments, and which segments lie on one line."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from palms.geometry import FloatArray, directions

__all__ = ["cast_rays", "group_lines", "rings_to_segments"]

_CHUNK = 1_000_000  # ours: ray-segment pairs at a time, some 50 MB


def cast_rays(
    origins_m: FloatArray, bearings_rad: FloatArray, segments_m: FloatArray
) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """Follow rays to the first segment that each meets.

    Parameters
    ----------
    origins_m : ndarray (R, 2)
        Where the rays start.
    bearings_rad : ndarray (R,)
        Where they go.
    segments_m : ndarray (N, 2, 2)
        What they may meet, in the same frame.

    Returns
    -------
    range_m : ndarray (R,)
        Distance to the first segment; infinity where there is none.
    index : ndarray (R,)
        That segment; -1 where there is none.

    Examples
    --------
    >>> wall = np.array([[[2.0, -1.0], [2.0, 1.0]]])
    >>> ranges, index = cast_rays(np.zeros((2, 2)), np.array([0.0, 3.0]), wall)
    >>> ranges.tolist(), index.tolist()
    ([2.0, inf], [0, -1])
    """
    count = len(origins_m)
    range_m, index = np.full(count, np.inf), np.full(count, -1, np.int64)
    if not len(segments_m):
        return range_m, index
    size = max(1, _CHUNK // len(segments_m))
    for start in range(0, count, size):
        part = slice(start, start + size)
        distance = _distances(origins_m[part], bearings_rad[part], segments_m)
        nearest = distance.argmin(axis=1)
        range_m[part] = distance[np.arange(len(nearest)), nearest]
        index[part] = np.where(np.isfinite(range_m[part]), nearest, -1)
    return range_m, index


def _distances(origins: FloatArray, bearings: FloatArray, segments: FloatArray) -> FloatArray:
    """Distance (R, N) along each ray to each segment, infinity where they do not meet."""
    ux, uy = np.cos(bearings)[:, None], np.sin(bearings)[:, None]
    ex, ey = (segments[:, 1] - segments[:, 0]).T
    ax = segments[:, 0, 0] - origins[:, :1]
    ay = segments[:, 0, 1] - origins[:, 1:]
    cross = ux * ey - uy * ex
    with np.errstate(divide="ignore", invalid="ignore"):
        along_ray = (ax * ey - ay * ex) / cross
        along_segment = (ax * uy - ay * ux) / cross
        meets = (along_ray > 0) & (along_segment >= -1e-9) & (along_segment <= 1 + 1e-9)
    return np.where(meets, along_ray, np.inf)


def group_lines(segments_m: FloatArray, offset_m: float, angle_rad: float) -> npt.NDArray[np.int64]:
    """Find the straight lines on which segments lie.

    Parameters
    ----------
    segments_m : ndarray (N, 2, 2)
    offset_m, angle_rad : float
        Two segments lie on one line when their directions differ by at most `angle_rad`
        and the middle of the shorter is at most `offset_m` off the longer one's line.

    Returns
    -------
    ndarray (N,)
        A number for each segment, equal where they share a line, directly or by others.

    Examples
    --------
    >>> a, b, c = [[0, 0], [1, 0]], [[3, 0], [9, 0]], [[0, 0], [0, 1]]
    >>> group_lines(np.array([a, b, c], float), 0.05, 0.03).tolist()
    [0, 0, 1]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(segments_m):
        return np.empty(0, np.int64)
    angle = directions(segments_m)
    turn = np.abs(np.mod(angle[:, None] - angle[None] + np.pi / 2, np.pi) - np.pi / 2)
    middle = segments_m.mean(axis=1)
    normal = np.column_stack([-np.sin(angle), np.cos(angle)])
    off = np.abs(np.einsum("jk,ijk->ij", normal, middle[:, None] - middle[None]))
    length = np.linalg.norm(segments_m[:, 1] - segments_m[:, 0], axis=1)
    longer = np.where(length[:, None] <= length[None], off, off.T)
    i, j = np.nonzero((turn <= angle_rad) & (longer <= offset_m))
    links = coo_array((np.ones(len(i)), (i, j)), shape=turn.shape)
    return np.asarray(connected_components(links, directed=False)[1], np.int64)


def rings_to_segments(rings: list[FloatArray]) -> FloatArray:
    """Return the sides (N, 2, 2) of closed rings (M, 2), whose last point is the first.

    Examples
    --------
    >>> rings_to_segments([np.array([[0, 0], [1, 0], [0, 1], [0, 0]], float)]).shape
    (3, 2, 2)
    """
    sides = [np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings]
    return np.concatenate([np.empty((0, 2, 2)), *sides])
