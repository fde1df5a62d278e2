import json
import math

import pytest


@pytest.fixture(scope="module")
def document(palms, world):
    result = palms("locate", world.plan, world.scan, "--top", 4, "--json", "-")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_each_field_is_as_the_interface_says(document):
    assert document["schema"] == "palms-locate/1"
    assert (document["plan"], document["scan"]) == ("plan", "Session_7")
    assert document["method"] == "palms"
    assert 1 <= len(document["candidates"]) <= 4
    for each in document["candidates"]:
        assert each.keys() == {"x_m", "y_m", "drift_rad", "p", "level", "room"}
        assert -math.pi < each["drift_rad"] <= math.pi
    p = [each["p"] for each in document["candidates"]]
    assert p == sorted(p, reverse=True)
    assert sum(p) <= 1 + 1e-9


def test_true_place_is_among_them(palms, world):
    result = palms("locate", world.plan, world.scan, "--top", 1000, "--json", "-")
    candidates = json.loads(result.stdout)["candidates"]
    assert sum(each["p"] for each in candidates) == pytest.approx(0.9, abs=1e-3)  # else anywhere
    assert any(
        math.dist((each["x_m"], each["y_m"]), (2.0, 2.0)) < 0.5
        and abs(each["drift_rad"] - 0.4) < 0.05
        for each in candidates
    )


def test_table_has_a_line_for_each_place(palms, world):
    lines = palms("locate", world.plan, world.scan, "--top", 3).stdout.splitlines()
    assert lines[0].split() == ["place", "x", "y", "drift", "probability"]
    assert [line.split()[0] for line in lines[1:4]] == ["1", "2", "3"]
    assert all("°" in line and "%" in line for line in lines[1:4])


def test_picture_and_file(palms, world, tmp_path):
    png, path = tmp_path / "a.png", tmp_path / "a.json"
    result = palms("locate", world.plan, world.scan, "--png", png, "--json", path)
    assert result.exit_code == 0, result.output
    assert png.read_bytes().startswith(b"\x89PNG")
    assert json.loads(path.read_text())["schema"] == "palms-locate/1"
    assert str(png) in result.stdout


def test_methods_differ(palms, world, document):
    arguments = ("locate", world.plan, world.scan, "--top", 4, "--json", "-")
    other = json.loads(palms(*arguments, "--method", "authors").stdout)
    assert other["method"] == "authors"
    assert other["candidates"] != document["candidates"]


def test_no_place_is_wrong_usage(palms, world):
    assert palms("locate", world.plan, world.scan, "--top", 0).exit_code == 2


def test_how_much_the_scan_tells_is_said_and_written(palms, world, tmp_path):
    path = tmp_path / "places.json"
    result = palms("locate", world.plan, world.scan, "--json", path)
    advice = json.loads(path.read_text())["advice"]
    assert advice["n_walls"] >= 3
    assert 0 < advice["mass"] <= 1
    assert f"{advice['n_walls']} walls" in result.output
