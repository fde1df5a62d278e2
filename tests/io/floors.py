"""The sample floor in every format, and how far plans are apart."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import shapely

from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, lengths
from palms.io import FLOORPLANS, read_any, read_floorplan
from palms.sample import sample_folder

DATA = Path(__file__).parent / "data" / "plans"
ORIGIN = "origin=-122.0632,36.9996"
FILES = {
    "floor.geojson": (ORIGIN,),
    "floor-metres.geojson": (),
    "floor.imdf.zip": (ORIGIN,),
    "floor-picture.png": ("scale=0.05",),
    "floor-map.yaml": (),
    "floor.dxf": (),
    "floor.osm": (ORIGIN,),
    "floor.svg": ("scale=0.01",),
    "floor.pdf": ("ratio=200",),
    "floor.gpkg": (ORIGIN,),
    "floor-shapes.zip": (ORIGIN,),
    "floor.ifc": (),
}
RASTER = {"floor-picture.png": 1.0, "floor-map.yaml": 0.0}  # the margin in the file, in metres


def load_tool(name: str = "make_plan_files") -> ModuleType:
    """A script of the repository that makes files."""
    folder = str(Path(__file__).parents[2] / "tools")
    sys.path.insert(0, folder)
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(folder)


def sample() -> FloorPlan:
    return read_floorplan(sample_folder() / "maps" / "sample.csv")


def read_file(name: str, folder: Path = DATA) -> FloorPlan:
    return read_any(FLOORPLANS, folder / name, None, FILES[name])


def along(segments: FloatArray, step_m: float = 0.5) -> FloatArray:
    pieces = [
        a + np.linspace(0, 1, max(2, int(np.hypot(*(b - a)) / step_m)))[:, None] * (b - a)
        for a, b in segments
    ]
    return np.concatenate(pieces)


def apart_m(points: FloatArray, segments: FloatArray) -> FloatArray:
    """Distance of each point from the nearest segment."""
    tree = shapely.STRtree(shapely.linestrings(segments))
    _, apart = tree.query_nearest(
        shapely.points(points), return_distance=True, all_matches=False
    )  # fmt: skip
    return apart


def length_m(segments: FloatArray) -> float:
    return float(lengths(segments).sum())
