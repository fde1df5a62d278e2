"""Four real clouds of phones' LiDAR, without a truth but our eyes."""

from __future__ import annotations

import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.real.radish import data_folder
from palms.errors import PalmsWarning
from palms.extraction import Wall, floor_height_m, walls_from_points
from palms.geometry import FloatArray, lengths
from palms.io.point_clouds import UP_AXES, find_up
from palms.plot.pipeline import draw_scan
from palms.plot.style import MUTED, frame_map, new_figure, styled


def folder() -> Path:
    """Where the clouds are."""
    return data_folder() / "lidar_clouds"


def load(path: Path) -> tuple[str, FloatArray]:
    """Axis that is up, and points with x, y on the ground and height."""
    points = np.load(path)["xyz_mm"] / 1000
    up = find_up(points)
    return up, points @ np.array(UP_AXES[up], float).T


def run() -> tuple[list[dict[str, Any]], Figure]:
    """Table rows and a picture of all clouds."""
    rows, drawn = [], []
    for path in sorted(folder().glob("*.npz")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PalmsWarning)
            up, points = load(path)
            walls_from_points(points)
            start = time.perf_counter()
            found = walls_from_points(points)
            seconds = time.perf_counter() - start
        ends = np.array([wall.ends_m for wall in found]).reshape(-1, 2, 2)
        spread = np.median([wall.spread_m for wall in found]) if found else np.nan
        rows.append(
            {
                "cloud": path.stem, "points": len(points), "up": up, "walls": len(found),
                "of which over 0.8 m": int((lengths(ends) > 0.8).sum()),
                "metres": f"{lengths(ends).sum():.1f}", "spread cm": f"{100 * spread:.1f}",
                "s": f"{seconds:.2f}",
            }
        )  # fmt: skip
        drawn.append((path.stem, points, found))
    return rows, picture(drawn)


@styled
def picture(drawn: list[tuple[str, FloatArray, list[Wall]]]) -> Figure:
    """Draw the points between knee and head, and the walls found."""
    figure = new_figure(11.0, 10.5)
    for axes, (name, points, found) in zip(figure.subplots(2, 2).flat, drawn, strict=True):
        height = points[:, 2] - floor_height_m(points[:, 2])
        band = points[(height > 0.3) & (height < 2.2), :2]
        frame_map(axes, points[:, :2].min(axis=0), points[:, :2].max(axis=0))
        axes.plot(*band[:: len(band) // 30_000 + 1].T, ",", color=MUTED, alpha=0.6)
        draw_scan(axes, np.array([wall.ends_m for wall in found]).reshape(-1, 2, 2))
        axes.set_title(f"{name}: {len(found)} walls")
    return figure
