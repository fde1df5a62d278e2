"""Furniture along walls: boxes that hide walls, look like walls, and stand in the way."""

from __future__ import annotations

from typing import Any

import numpy as np

from palms.evaluation.simulation.settings import WorldNoise
from palms.geometry import FloatArray, lengths

__all__ = ["place_furniture"]

_WIDTH_M = (0.6, 1.8)  # simulation: cupboards, desks, sofas
_DEPTH_M = (0.3, 0.6)  # simulation: shelves to desks
_GAP_M = 0.03  # simulation: air between furniture and wall
_DOOR_M = 0.7  # ours: nothing stands this near to a door


def place_furniture(
    walls_m: FloatArray,
    thickness_m: FloatArray,
    areas: tuple[Any, FloatArray, Any],
    noise: WorldNoise,
    rng: np.random.Generator,
) -> FloatArray:
    """Put boxes along walls, clear of doors and of each other, with room to pass.

    Parameters
    ----------
    walls_m : ndarray (N, 2, 2)
        Centre lines of walls.
    thickness_m : ndarray (N,)
        Their thickness.
    areas : tuple
        Shapely area of the walls, segments (M, 2, 2) of doors and openings, shapely area
        of the inside.
    noise : WorldNoise
    rng : numpy.random.Generator

    Returns
    -------
    ndarray (K, 4, 2, 2)
        The four sides of each box.

    Examples
    --------
    >>> import shapely
    >>> wall, none = np.array([[[0.0, 0.0], [9.0, 0.0]]]), np.empty((0, 2, 2))
    >>> areas = shapely.Polygon(), none, shapely.box(0, 0, 9, 5)
    >>> noise = WorldNoise(furniture_per_m=1.0)
    >>> place_furniture(wall, np.array([0.1]), areas, noise, np.random.default_rng(1)).shape
    (3, 4, 2, 2)
    """
    import shapely

    solid, passages, inside = areas
    doorways = shapely.buffer(shapely.linestrings(passages), _DOOR_M)
    tree = shapely.STRtree([*shapely.get_parts(solid), *doorways])
    shapely.prepare(solid)
    boxes: list[FloatArray] = []
    taken: list[Any] = []
    for corners, front in _candidates(walls_m, thickness_m, noise, rng):
        body, clear = shapely.Polygon(corners), shapely.Polygon(front)
        meets = any(body.intersects(tree.geometries[i]) for i in tree.query(body))
        if meets or clear.intersects(solid) or not inside.contains(body):
            continue
        if any(body.intersects(a) or clear.intersects(b) for a, b in taken):
            continue
        boxes.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
        taken.append((clear.union(body), body))
    return np.array(boxes).reshape(-1, 4, 2, 2)


def _candidates(
    walls: FloatArray, thickness: FloatArray, noise: WorldNoise, rng: np.random.Generator
) -> list[tuple[FloatArray, FloatArray]]:
    """Corners (4, 2) of boxes and of the clear space in front of each."""
    length = lengths(walls)
    chosen = np.repeat(np.arange(len(walls)), rng.poisson(noise.furniture_per_m * length))
    count = len(chosen)
    width, depth = rng.uniform(*_WIDTH_M, count), rng.uniform(*_DEPTH_M, count)
    middle = rng.random(count) * length[chosen]
    side = rng.choice([-1.0, 1.0], count)
    result = []
    for k, wall in enumerate(chosen):
        along = (walls[wall, 1] - walls[wall, 0]) / length[wall]
        out = side[k] * np.array([-along[1], along[0]])
        foot = walls[wall, 0] + middle[k] * along + out * (thickness[wall] / 2 + _GAP_M)
        half = along * width[k] / 2
        back = out * depth[k]
        corners = np.array([foot - half, foot + half, foot + half + back, foot - half + back])
        front = corners[[3, 2]] + out * 0.01
        reach = corners[[2, 3]] + out * noise.furniture_clear_m
        result.append((corners, np.concatenate([front, reach])))
    return result
