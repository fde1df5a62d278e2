"""A scan to a template."""

import numpy as np
import shapely
from scipy import ndimage

from benchmarks.harness import Case
from benchmarks.world import scan
from palms.template import build_template, empty_triangles

CELL_M = 0.1


def plainly() -> None:
    """Walls by points, blurred; empty space by shapely."""
    walls = scan().relative_m
    half = int(np.abs(walls).max() / CELL_M) + 12
    bitmap = np.zeros((2 * half + 1, 2 * half + 1), np.float32)
    for start, end in walls:
        points = np.linspace(start, end, 200)
        column, row = np.round(points / CELL_M).astype(int).T + half
        bitmap[row, column] = 1
    ndimage.gaussian_filter(bitmap, 3)
    x, y = np.meshgrid(*2 * [CELL_M * np.arange(-half, half + 1)])
    for triangle in empty_triangles(walls, 0.9):
        shapely.contains_xy(shapely.Polygon(triangle), x, y)


def cases() -> list[Case]:
    return [
        Case("template RW - alpha CES", lambda: build_template(scan(), 0.4, CELL_M), None,
             plainly, "numpy, scipy, shapely")
    ]  # fmt: skip
