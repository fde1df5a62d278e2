"""The sample floor in every format, and how far plans are apart."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np

from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, distance_to_segments, lengths
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
}
RASTER = {"floor-picture.png": 1.0, "floor-map.yaml": 0.0}  # the margin in the file, in metres


def load_tool() -> ModuleType:
    """The script that makes the files."""
    path = Path(__file__).parents[2] / "tools" / "make_plan_files.py"
    spec = importlib.util.spec_from_file_location("make_plan_files", path)
    tool = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = tool
    try:
        spec.loader.exec_module(tool)
    finally:
        del sys.modules[spec.name]
    return tool


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
    return np.array([distance_to_segments(point, segments).min() for point in points])


def length_m(segments: FloatArray) -> float:
    return float(lengths(segments).sum())
