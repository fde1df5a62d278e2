"""Real floor plans, where the public data is at hand (PALMS_DATA or ../shared/data)."""

from __future__ import annotations

import itertools
import json
import os
from pathlib import Path

import numpy as np
import pytest
from shapely import Polygon

from palms.errors import InputError
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, read_any, read_floorplan, read_levels
from tests.io.floors import along, apart_m, length_m

DEFAULT = Path(__file__).parents[3] / "shared" / "data"
DATA = Path(os.environ.get("PALMS_DATA", DEFAULT))

pytestmark = pytest.mark.skipif(
    not (DATA / "westport").is_dir(), reason=f"no plans in {DATA}; set PALMS_DATA"
)


@pytest.mark.parametrize(("floor", "doors"), [("gf", 36), ("3", 122), ("4", 122)])
def test_an_office_with_doors_and_windows(floor, doors):
    plan = read_floorplan(DATA / "westport" / f"floor-{floor}.geojson.gz")
    known = np.loadtxt(
        DATA / "westport" / f"walls_{floor}.csv", delimiter=",", skiprows=1, usecols=range(4)
    )
    extent = np.ptp(known.reshape(-1, 2), axis=0)  # the outline too, which is no wall
    assert (plan.size_m <= 1.003 * extent).all()  # theirs are metres of a sphere
    assert (plan.size_m >= 0.7 * extent).all()
    assert abs(len(plan.of_class(SegmentClass.DOOR)) - doors) <= 6
    assert length_m(plan.of_class(SegmentClass.GLASS)) > 30


def test_the_levels_of_a_university():
    folder = DATA / "imdf_spbstu"
    listed = json.loads((folder / "levels.json").read_text())
    with pytest.raises(InputError, match="8 that fit"):
        read_floorplan(folder)
    for level in listed:
        plan = read_floorplan(folder, level=level["level"], language="en")
        assert plan.level == level["name"]
        assert plan.name == level["building"]
        known = np.loadtxt(folder / level["file"], delimiter=",", skiprows=1).reshape(-1, 2, 2)
        extent = np.array(level["extent"])  # of the level's outline, which is no wall, too
        assert (plan.size_m <= extent + 0.05).all()
        assert (plan.size_m >= 0.85 * extent).all()
        assert abs(len(plan.of_class(SegmentClass.DOOR)) - level["openings"]) <= 2
        assert length_m(plan.blocking_m) < length_m(known)  # there, shared edges count twice


def test_all_levels_of_a_university_lie_in_one_frame():
    folder = DATA / "imdf_spbstu"
    listed = json.loads((folder / "levels.json").read_text())
    levels = read_levels(folder, language="en")
    assert [each.ordinal for each in levels] == sorted(each["ordinal"] for each in listed)
    assert len({each.plan.origin for each in levels}) == 1
    for building in {each["building"] for each in listed}:
        floors = [Polygon(e.plan.outline_m) for e in levels if e.plan.name == building]
        for below, above in itertools.pairwise(floors):  # above each other, not side by side
            shared = below.intersection(above).area
            assert shared > 0.9 * min(below.area, above.area)


def mall_size_m(floor: str):
    info = json.loads((DATA / "mall" / floor / "floor_info.json").read_text())
    return [info["map_info"]["width"], info["map_info"]["height"]]


def mall_drawn(floor: str):
    """Segments of a floor from its GeoJSON, in the mall's frame."""
    drawn = read_floorplan(DATA / "mall" / floor / "geojson_map.json")
    low, high = drawn.bounds_m
    return (drawn.segments_m - low) / (high - low) * mall_size_m(floor)


def mall_seen(floor: str):
    """Segments of a floor from its picture, in the mall's frame; metres a pixel."""
    from PIL import Image

    path = DATA / "mall" / floor / "floor_image.png"
    with Image.open(path) as picture:
        scale = mall_size_m(floor)[0] / picture.width
    return read_any(FLOORPLANS, path, None, [f"scale={scale}"]).segments_m, scale


@pytest.mark.parametrize("floor", ["F2", "F3", "F4"])
def test_the_mall_and_its_picture_agree(floor):
    """A thumbnail of 0.3 m a pixel with names all over it: two pixels, for most of the walls."""
    drawn, (seen, pixel_m) = mall_drawn(floor), mall_seen(floor)
    found = apart_m(along(drawn, 1.0), seen)
    spurious = apart_m(along(seen, 1.0), drawn)
    assert np.mean(found < 2 * pixel_m) > 0.6
    assert np.mean(spurious < 2 * pixel_m) > 0.7


@pytest.mark.parametrize("floor", ["F2", "F3", "F4"])
def test_the_mall_has_the_walls_that_are_known(floor):
    known = np.loadtxt(DATA / "mall" / floor / "walls.csv", delimiter=",", skiprows=1)
    drawn = mall_drawn(floor)
    assert np.quantile(apart_m(along(known.reshape(-1, 2, 2), 1.0), drawn), 0.99) < 0.1
    assert np.quantile(apart_m(along(drawn, 1.0), known.reshape(-1, 2, 2)), 0.95) < 0.05
