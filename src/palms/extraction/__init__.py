"""Vertical walls and empty space from points and depth images.

::

    point cloud ──────────────────────────────> walls_from_points ─> walls
    depth images ─ DepthFrame ─ points_of ──────────┘
                        └────── free_ranges ──────────────────────> what is surely empty

Frames here have x and y on the ground and height as the third coordinate, in metres.

Examples
--------
>>> import numpy as np
>>> x, z = (v.ravel() for v in np.meshgrid(np.arange(0, 3, 0.02), np.arange(0, 2.4, 0.02)))
>>> len(walls_from_points(np.column_stack([x, 0 * x + 1.5, z])))
1
"""

from palms.extraction.columns import floor_height_m
from palms.extraction.depth import DepthFrame, points_of
from palms.extraction.empty import free_ranges
from palms.extraction.scans import scan_from_depth, scan_from_points
from palms.extraction.settings import ExtractionSettings
from palms.extraction.walls import Wall, walls_from_points

__all__ = [
    "DepthFrame",
    "ExtractionSettings",
    "Wall",
    "floor_height_m",
    "free_ranges",
    "points_of",
    "scan_from_depth",
    "scan_from_points",
    "walls_from_points",
]
