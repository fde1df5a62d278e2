"""Damaged copies of good files give a PalmsError or a valid value, never anything else."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import PalmsError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.io import (
    Label,
    RecordedWalk,
    Truth,
    read_floorplan,
    read_label,
    read_plan_csv,
    read_scan,
    read_scan_json,
    read_tracking,
    read_walk,
    write_floorplan,
    write_label,
    write_plan_csv,
    write_scan_json,
    write_tracking,
)
from palms.odometry import Odometry
from palms.scan import Scan
from tests.io.floors import load_tool

BYTES = [bytes([b]) for b in b'0e-.,;"[]{}:nN\n\x00\xff']


def make_good(folder: Path) -> None:
    square = [[[0, 0], [8, 0]], [[8, 0], [8, 5]], [[8, 5], [0, 5]], [[0, 5], [0, 0]]]
    classes = list(SegmentClass)
    hall = Room("Hall", [[0, 0], [8, 0], [8, 5]])
    write_plan_csv(FloorPlan(square, classes, (hall,)), folder / "plan.csv")
    scan = Scan([[[2, -2], [2, 2]], [[0, 3], [2, 3]]], (0.5, 0), [1.5, np.nan], 3.5, "9")
    write_scan_json(scan, folder / "Session_1")
    x = np.arange(1.0, 11.0)
    line = np.column_stack([x, 0.25 * x])
    walk = RecordedWalk(
        arkit=Odometry(0.5 * x, line, facing_rad=0 * x),
        ronin=Odometry(0.5 * x, line, frame="own", source="inertial"),
        start_m=(0.0, 0.0),
        session=("17",),
        truth=Truth(0.5 * x, line, 0 * x, ("G",) * 10),
    )
    write_tracking(walk, folder / "walk.json")
    write_label(Label((1.5, 2.5), 0.5), folder / "label.txt")


CASES = {
    "plan.csv": ("plan.csv", (read_plan_csv, read_floorplan), FloorPlan),
    "plan.rooms.geojson": ("plan.csv", (read_plan_csv,), FloorPlan),
    "Session_1/detectedPlanes.json": ("Session_1", (read_scan_json, read_scan), Scan),
    "Session_1/scan.json": ("Session_1", (read_scan_json,), Scan),
    "walk.json": ("walk.json", (read_tracking, read_walk), RecordedWalk),
    "truth.csv": ("walk.json", (read_tracking,), RecordedWalk),
    "label.txt": ("label.txt", (read_label,), Label),
}


@st.composite
def damage(draw):
    """A function from good to damaged bytes."""
    kind = draw(st.sampled_from(["flip", "cut", "drop", "insert", "repeat"]))
    at, other = draw(st.floats(0, 1)), draw(st.floats(0, 1))
    piece = draw(st.one_of(st.sampled_from(BYTES), st.binary(min_size=1, max_size=3)))
    count = draw(st.integers(1, 3))

    def apply(good: bytes) -> bytes:
        i = int(at * (len(good) - 1))
        j = min(i + 1 + int(other * 20), len(good))
        return {
            "flip": good[:i] + piece * count + good[i + len(piece) * count :],
            "cut": good[:i],
            "drop": good[:i] + good[j:],
            "insert": good[:i] + piece * count + good[i:],
            "repeat": good[:j] + good[i:],
        }[kind]

    return apply


@pytest.mark.parametrize("name", CASES)
@settings(derandomize=True, deadline=None, max_examples=150)
@given(damages=st.lists(damage(), min_size=1, max_size=3))
def test_damaged_copies(tmp_path_factory, name, damages):
    folder = tmp_path_factory.getbasetemp() / "damaged"
    folder.mkdir(exist_ok=True)
    (folder / "truth.csv").unlink(missing_ok=True)
    make_good(folder)
    read_from, readers, kind = CASES[name]
    content = (folder / name).read_bytes()
    for apply in damages:
        content = apply(content)
    (folder / name).write_bytes(content)
    for read in readers:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PalmsWarning)
            try:
                value = read(folder / read_from)
            except PalmsError as error:
                value = error
        text = str(value) if isinstance(value, PalmsError) else str(folder)
        assert "\n" not in text
        assert str(folder) in text
        assert isinstance(value, kind | PalmsError)


PLANS = {
    "floor.geojson": "geojson",
    "floor.imdf.zip": "imdf",
    "floor.dxf": "dxf",
    "floor-map.yaml": "ros",
    "floor-map.png": "ros",
    "tiny.png": "image",
    "floor.osm": "osm",
    "floor.svg": "svg",
    "floor.gpkg": "gpkg",
    "floor-shapes.zip": "shapefile",
}


def make_plans(folder: Path) -> None:
    """Small plans, so that many damaged copies can be read."""
    square = [[[0, 0], [8, 0]], [[8, 0], [8, 5]], [[8, 5], [0, 5]], [[0, 5], [0, 0]]]
    door = [[3, 0], [4, 0]]
    hall = Room("Hall", [[0, 0], [8, 0], [8, 5], [0, 5]])
    plan = FloorPlan(
        [*square, door], [0, 0, 0, 3, 1], (hall,), level="2", name="tiny", origin=Origin(30.0, 60.0)
    )
    tool = load_tool()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tool, "ORIGIN", plan.origin)
        write_floorplan(plan, folder / "floor.geojson")
        tool.write_imdf(plan, folder / "floor.imdf.zip")
        tool.write_dxf(plan, folder / "floor.dxf")
        tool.write_ros(plan, folder / "floor-map.yaml")
        tool.write_image(plan, folder / "tiny.png")
        tool.write_osm(plan, folder / "floor.osm")
        tool.write_svg(plan, folder / "floor.svg")
        tool.write_gpkg(plan, folder / "floor.gpkg")
        tool.write_shapefiles(plan, folder / "floor-shapes.zip")


@pytest.fixture(scope="module")
def good_plans(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plans")
    make_plans(folder)
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("name", PLANS)
@settings(derandomize=True, deadline=None, max_examples=60)
@given(damages=st.lists(damage(), min_size=1, max_size=3))
def test_damaged_copies_of_plans(tmp_path_factory, good_plans, name, damages):
    folder = tmp_path_factory.getbasetemp() / "damaged-plans"
    folder.mkdir(exist_ok=True)
    for each, content in good_plans.items():
        (folder / each).write_bytes(content)
    content = good_plans[name]
    for apply in damages:
        content = apply(content)
    (folder / name).write_bytes(content)
    target = name.replace("map.png", "map.yaml")
    extra = {"scale": 0.05} if PLANS[name] in ("image", "svg") else {}
    for chosen in (PLANS[name], None):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PalmsWarning)
            try:
                value = read_floorplan(folder / target, format=chosen, **extra)
            except PalmsError as error:
                value = error
        assert isinstance(value, FloorPlan | PalmsError)
        assert "\n" not in str(value) or isinstance(value, FloorPlan)
