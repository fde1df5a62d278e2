"""Pictures and ROS maps."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image, ImageDraw

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan
from palms.geometry import lengths, rotate
from palms.io import FLOORPLANS, read_any, write_floorplan
from palms.io.plan_image import dark_of, load_grey, read_plan_image
from palms.io.plan_ros import read_plan_ros
from palms.io.vectorize import walls_of
from tests.io.floors import DATA, along, apart_m, length_m, sample

CORNERS = np.array([[2.0, 3.5], [12, 3.5], [12, 10.5], [2, 10.5]])
ROOM = np.stack([CORNERS, np.roll(CORNERS, -1, axis=0)], axis=1)


def draw(segments, angle=0.0, pixel_m=0.05, width=5, **options):
    """A picture of walls, turned about (7, 7), 14 by 14 m."""
    turned = rotate(segments - [7, 7], angle) + [7, 7]
    image = Image.new("L", (round(14 / pixel_m), round(14 / pixel_m)), 255)
    pen = ImageDraw.Draw(image)
    for ends in turned:
        pen.line([(x / pixel_m, (14 - y) / pixel_m) for x, y in ends], fill=0, width=width)
    return image, turned


def save(image, path, kind="PNG"):
    image.save(path, kind)
    return path


@pytest.mark.parametrize("degrees", [0, 3, 17, 30, 45, 61, 88])
@pytest.mark.parametrize("width", [1, 3, 6])
def test_walls_at_any_angle(tmp_path, degrees, width):
    image, truth = draw(ROOM, np.radians(degrees), width=width)
    plan = read_plan_image(save(image, tmp_path / "a.png"), scale=0.05)
    assert apart_m(along(truth, 0.2), plan.segments_m).max() < 0.1
    assert apart_m(along(plan.segments_m, 0.2), truth).max() < 0.1
    assert length_m(plan.segments_m) == pytest.approx(34, abs=1)


def test_round_walls_are_followed(tmp_path):
    t = np.linspace(0, 2 * np.pi, 60)
    circle = np.column_stack([8 + 4 * np.cos(t), 6 + 4 * np.sin(t)])
    image, truth = draw(np.stack([circle[:-1], circle[1:]], axis=1), width=4)
    plan = read_plan_image(save(image, tmp_path / "a.png"), scale=0.05)
    off = np.abs(np.hypot(*(along(plan.segments_m, 0.1) - [8, 6]).T) - 4)
    assert np.quantile(off, 0.95) < 0.15
    assert length_m(plan.segments_m) > 0.7 * length_m(truth)


def test_a_gap_stays_a_gap(tmp_path):
    gap = np.array([[[2.0, 6], [7, 6]], [[8, 6], [14, 6]]])
    plan = read_plan_image(save(draw(gap)[0], tmp_path / "a.png"), scale=0.05)
    assert sorted(np.round(plan.segments_m[:, :, 0], 1).ravel()) == pytest.approx(
        [2, 7, 8, 14], abs=0.11
    )


def test_thin_strokes_and_text_are_removed(tmp_path):
    image, truth = draw(ROOM, width=8)
    pen = ImageDraw.Draw(image)
    pen.text((120, 90), "Kitchen 12", fill=0)
    pen.rectangle((90, 130, 120, 150), outline=0)
    pen.arc((60, 60, 100, 100), 0, 90, fill=0)
    path = save(image, tmp_path / "a.png")
    assert apart_m(along(read_plan_image(path, scale=0.05).segments_m), truth).max() < 0.1
    kept = read_plan_image(path, scale=0.05, min_stroke=1, text_size=1, min_wall=0.2)
    assert apart_m(along(kept.segments_m), truth).max() > 1


def test_scale_by_two_points_and_their_distance(tmp_path):
    path = save(draw(ROOM)[0], tmp_path / "a.png")
    by_points = read_plan_image(path, points=(40, 60, 240, 60), distance=10.0)
    assert np.array_equal(by_points.segments_m, read_plan_image(path, scale=0.05).segments_m)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "scale=METRES per pixel, or points="),
        ({"points": (0, 0, 9, 9)}, "its scale"),
        ({"points": (3, 3, 3, 3), "distance": 1.0}, "two points apart"),
        ({"points": (0, 0, 9, 9), "distance": -1.0}, "metres above 0"),
        ({"scale": 0.0}, "above 0"),
        ({"scale": 0.05, "threshold": 2.0}, "between 0 and 1"),
        ({"scale": 100.0}, "multiply by 0.00"),
        ({"scale": 0.05, "invert": True, "min_wall": 50.0}, "no straight dark stroke"),
    ],
)
def test_options_that_do_not_fit(tmp_path, options, words, says):
    path = save(draw(ROOM)[0], tmp_path / "a.png")
    with pytest.raises(InputError) as caught:
        read_plan_image(path, **options)
    says(caught.value, words)


@pytest.mark.parametrize("kind", ["JPEG", "GIF", "BMP", "TIFF", "WEBP", "PPM"])
def test_kinds_of_pictures(tmp_path, kind):
    image, truth = draw(ROOM)
    path = save(image, tmp_path / f"a.{kind.lower()}", kind)
    plan = read_any(FLOORPLANS, path, None, ["scale=0.05"])
    assert apart_m(along(plan.segments_m), truth).max() < 0.1


@pytest.mark.parametrize("mode", ["RGBA", "P", "LA", "1", "RGB", "I;16"])
def test_modes_of_pictures(tmp_path, mode):
    image, truth = draw(ROOM)
    if mode == "I;16":
        image = Image.fromarray(np.asarray(image).astype(np.uint16) * 257)
    elif mode == "RGBA":  # walls on a ground that is transparent black
        alpha = Image.fromarray(255 - np.asarray(image))
        image = Image.merge("RGBA", (Image.new("L", image.size, 0),) * 3 + (alpha,))
    else:
        image = image.convert(mode)
    plan = read_plan_image(save(image, tmp_path / "a.png"), scale=0.05)
    assert apart_m(along(plan.segments_m), truth).max() < 0.1


def test_light_walls_on_dark_ground(tmp_path):
    image, truth = draw(ROOM)
    path = save(Image.fromarray(255 - np.asarray(image)), tmp_path / "a.png")
    assert (
        apart_m(along(read_plan_image(path, scale=0.05, invert=True).segments_m), truth).max() < 0.1
    )


def test_a_picture_of_absurd_size_is_refused_unread(put, says):
    header = struct.pack(">IIBBBBB", 60_000, 60_000, 8, 0, 0, 0, 0)

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    bomb = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"\0" * 99))
    with pytest.raises(FormatError) as caught:
        read_plan_image(put("bomb.png", bomb), scale=0.05)
    says(caught.value, "bomb.png")


def test_large_pictures_are_reduced_and_keep_their_scale(tmp_path, monkeypatch):
    monkeypatch.setattr(load_grey, "__defaults__", (20_000,))
    image, truth = draw(ROOM, width=12)
    plan = read_plan_image(save(image, tmp_path / "a.png"), scale=0.05)
    assert apart_m(along(plan.segments_m), truth).max() < 0.25


def test_blank_pictures_have_no_walls():
    assert walls_of(np.zeros((50, 50), bool), 5).shape == (0, 2, 2)
    assert walls_of(np.ones((50, 50), bool), 5).shape == (0, 2, 2)
    assert not dark_of(np.ones((5, 5), np.float32)).any()


@pytest.fixture
def ros(tmp_path):
    """Write a ROS map of some cells."""

    def write(values, **changes):
        Image.fromarray(values).save(tmp_path / "map.pgm")
        keys = {"image": "map.pgm", "resolution": "0.05", "origin": "[1.0, 2.0, 0.0]",
                "negate": "0", "occupied_thresh": "0.65", "free_thresh": "0.196"}  # fmt: skip
        lines = [f"{k}: {v}\n" for k, v in (keys | changes).items() if v is not None]
        (tmp_path / "map.yaml").write_text("".join(lines))
        return tmp_path / "map.yaml"

    return write


def cells(occupied=0, free=254):
    values = np.full((100, 200), free, np.uint8)
    values[20:22, 10:190] = occupied  # near the top: y = 2 + (100 - 21) * 0.05
    return values


def test_the_top_row_comes_first_and_the_origin_is_the_lower_left(ros):
    (wall,) = read_plan_ros(ros(cells())).segments_m
    assert np.sort(wall[:, 0]) == pytest.approx([1 + 10 * 0.05, 1 + 190 * 0.05], abs=0.05)
    assert wall[:, 1] == pytest.approx(2 + 79 * 0.05, abs=0.03)


def test_yaw_turns_about_the_origin(ros):
    straight = read_plan_ros(ros(cells())).segments_m
    turned = read_plan_ros(ros(cells(), origin="[1.0, 2.0, 0.5]")).segments_m
    expected = rotate(straight - [1, 2], 0.5) + [1, 2]
    np.testing.assert_allclose(turned, expected, atol=1e-9)


def test_negate_and_thresholds(ros):
    (wall,) = read_plan_ros(ros(cells(255, 0), negate="1")).segments_m
    assert lengths(wall[None])[0] == pytest.approx(9, abs=0.1)
    with pytest.raises(FormatError, match="occupied_thresh"):
        read_plan_ros(ros(cells(120, 254)))
    read_plan_ros(ros(cells(120, 254), occupied_thresh="0.5"))


@pytest.mark.parametrize(
    "origin", ["\n- 1.0\n- 2.0\n- 0.0", "[1, 2, 0]  # pose", "[1.0,2.0,0.0]", "[1.0, 2.0]"]
)
def test_forms_of_yaml(ros, origin):
    assert read_plan_ros(ros(cells(), origin=origin)).bounds_m[0][0] == pytest.approx(1.5, abs=0.06)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"resolution": None}, "no resolution"),
        ({"resolution": "0"}, "above 0"),
        ({"resolution": "wide"}, "'wide'"),
        ({"origin": "[1, x, 0]"}, "origin"),
        ({"origin": "&a [*a, *a, *a]"}, "origin"),
        ({"image": "../../etc/map.pgm"}, "beside the map"),
        ({"image": "none.pgm"}, "none.pgm"),
        ({"occupied_thresh": "nan"}, "occupied_thresh"),
    ],
)
def test_wrong_maps(ros, says, changes, words):
    with pytest.raises(InputError) as caught:
        read_plan_ros(ros(cells(), **changes))
    says(caught.value, words)


def test_a_written_map_is_read_again_within_a_cell(tmp_path):
    plan = FloorPlan(rotate(ROOM, 0.3))
    write_floorplan(plan, tmp_path / "a.yaml")
    again = read_plan_ros(tmp_path / "a.yaml")
    assert apart_m(along(again.segments_m, 0.1), plan.segments_m).max() < 0.05
    assert apart_m(along(plan.segments_m, 0.1), again.segments_m).max() < 0.1
    grey = np.asarray(Image.open(tmp_path / "a.pgm"))
    assert set(np.unique(grey)) == {0, 205, 254}


def test_the_picture_of_the_sample_is_read_without_its_words_and_swings():
    picture = Image.open(io.BytesIO((DATA / "floor-picture.png").read_bytes()))
    plan = read_plan_image(DATA / "floor-picture.png", scale=0.05)
    assert length_m(plan.segments_m) == pytest.approx(length_m(sample().blocking_m), rel=0.01)
    dark = 1 - np.asarray(picture.convert("L"), float) / 255
    assert dark.sum() * 0.05**2 > 1.02 * 0.2 * length_m(plan.segments_m)  # there is more in it
