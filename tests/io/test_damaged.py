"""Damaged copies of good files give a PalmsError or a valid value, never anything else."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

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
from tests.io.damage import damaged, damages, outcome
from tests.io.floors import load_tool


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


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    make_good(folder)
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*") if path.is_file()
    }  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@settings(derandomize=True, deadline=None, max_examples=150)
@given(damages=damages)
def test_damaged_copies(tmp_path_factory, good, name, damages):
    folder = tmp_path_factory.getbasetemp() / "damaged"
    (folder / "Session_1").mkdir(parents=True, exist_ok=True)
    for each, content in good.items():
        (folder / each).write_bytes(content)
    read_from, readers, kind = CASES[name]
    (folder / name).write_bytes(damaged(good[name], damages))
    for read in readers:
        outcome(functools.partial(read, folder / read_from), kind, folder)


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
@given(damages=damages)
def test_damaged_copies_of_plans(tmp_path_factory, good_plans, name, damages):
    folder = tmp_path_factory.getbasetemp() / "damaged-plans"
    folder.mkdir(exist_ok=True)
    for each, content in good_plans.items():
        (folder / each).write_bytes(content)
    (folder / name).write_bytes(damaged(good_plans[name], damages))
    target = name.replace("map.png", "map.yaml")
    extra = {"scale": 0.05} if PLANS[name] in ("image", "svg") else {}
    for chosen in (PLANS[name], None):
        read = functools.partial(read_floorplan, folder / target, format=chosen, **extra)
        outcome(read, FloorPlan, folder)
