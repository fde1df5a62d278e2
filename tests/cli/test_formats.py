"""One door: any format on any command, by recognising it or by name, with options."""

import json

import pytest

from palms.io import write_floorplan
from palms.io.plan_geojson import read_plan_geojson
from tests.io.floors import DATA
from tests.worlds import two_rooms


@pytest.fixture
def geojson(tmp_path):
    write_floorplan(two_rooms(), tmp_path / "plan.geojson")
    return tmp_path / "plan.geojson"


def test_locate_and_track_take_any_plan(palms, world, geojson, tmp_path):
    def candidates(plan, *options):
        result = palms("locate", plan, world.scan, "--json", "-", *options)
        assert result.exit_code == 0, result.output
        return json.loads(result.stdout)["candidates"]

    assert candidates(geojson) == candidates(world.plan)
    named = geojson.rename(tmp_path / "plan.txt")
    assert candidates(named, "--plan-format", "geojson") == candidates(world.plan)
    placed = candidates(named, "--plan-option", "origin=30,60", "--scan-format", "planes")
    assert {"lon", "lat"} <= set(placed[0])
    result = palms(
        "track", named, world.scan, world.walk, "--json", tmp_path / "t.json",
        "--plan-option", "origin=30,60", "--walk-format", "tracking", "--particles", 200,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    (trial,) = json.loads((tmp_path / "t.json").read_text())["trials"]
    assert trial["steps"]["lat"][-1] == pytest.approx(60, abs=0.001)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--plan-format", "dwg"), "one of csv, geojson"),
        (("--plan-option", "colour=red"), "option of format geojson: expected one of frame"),
        (("--option", "scale=wide"), "scale: expected a finite number"),
        (("--option", "scale"), "name=value"),
        (("--format", "image"), "expected a picture, got JSON"),
    ],
)
def test_formats_and_options_that_do_not_fit(palms_fails, geojson, arguments, says):
    assert says in palms_fails("plan", "info", geojson, *arguments)


def test_plan_info_says_what_looks_wrong(palms, geojson, tmp_path):
    facts = json.loads(palms("plan", "info", geojson, "--json", "-").stdout)
    assert facts["free_area_m2"] > 200
    assert any("no doors" in problem for problem in facts["problems"])
    assert "looks wrong" in palms("plan", "info", geojson).stdout


@pytest.mark.parametrize("suffix", [".csv", ".geojson", ".yaml"])
def test_convert_writes_what_is_read_again(palms, geojson, tmp_path, suffix):
    target = tmp_path / f"out{suffix}"
    told = palms("plan", "convert", geojson, target).stdout
    assert told.startswith(f"Written: {target}")
    facts = json.loads(palms("plan", "info", target, "--json", "-").stdout)
    assert facts["size_m"] == pytest.approx([20, 12], abs=0.06)


def test_convert_reports_each_repair(palms, geojson, tmp_path):
    target = tmp_path / "out.geojson"
    told = palms(
        "plan", "convert", geojson, target, "--snap", 0.02, "--merge", "--close-gaps", 0.2,
        "--crop", "0,0,15,20",
    ).stdout.splitlines()  # fmt: skip
    assert [line.split(":")[0] for line in told] == [
        "crop", "snap", "merge", "close-gaps", "Written",
    ]  # fmt: skip
    assert read_plan_geojson(target).size_m[0] == pytest.approx(15)


def test_convert_refuses_what_it_cannot_write(palms, palms_fails, geojson, tmp_path):
    assert "a name that ends in" in palms_fails("plan", "convert", geojson, tmp_path / "a.dwg")
    assert "create it first" in palms_fails("plan", "convert", geojson, tmp_path / "no" / "a.csv")
    wrong = palms("plan", "convert", geojson, tmp_path / "a.csv", "--crop", "1,2,3")
    assert wrong.exit_code == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan.geojson"]


def test_show_does_not_write_over_the_picture_that_it_reads(palms, tmp_path, monkeypatch):
    picture = tmp_path / "floor-picture.png"
    picture.write_bytes((DATA / picture.name).read_bytes())
    monkeypatch.chdir(tmp_path)
    told = palms("plan", "show", picture, "--option", "scale=0.05").stdout
    assert told == "Picture: floor-picture-plan.png\n"
    assert picture.read_bytes() == (DATA / picture.name).read_bytes()
