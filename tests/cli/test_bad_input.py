"""Every bad input: one clear line, exit code 1, and nothing written."""

import json
import os

import pytest

from tests.cli.conftest import write_walk

ROOM = [[0, 0, 6, 0], [6, 0, 6, 4], [6, 4, 0, 4], [0, 4, 0, 0]]


def csv(rows, scale=1.0):
    return "\n".join(",".join(str(scale * float(value)) for value in row) for row in rows) + "\n"


BINARY = bytes(range(256)) * 4
PLANS = {
    "empty": ("", "empty"),
    "binary": (BINARY, "plan.csv"),
    "an image": (b"\x89PNG\r\n\x1a\n" + BINARY, "PNG"),
    "truncated": (csv(ROOM)[:-6], "line 4"),
    "json": ('{"walls": []}', "plan.csv"),
    "nan": (csv([*ROOM, ["nan", 1, 2, 3]]), "finite"),
    "infinite": (csv([*ROOM, ["inf", 1, 2, 3]]), "finite"),
    "no walls": ("x1,y1,x2,y2\n", "plan.csv"),
    "no wall with a length": ("1,1,1,1\n2,2,2,2\n", "wall"),
    "doors only": ("0,0,6,0,door\n6,0,6,4,door\n", "wall"),
    "millimetres": (csv(ROOM, 10_000.0), "60000 x 40000"),
    "absurdly large": (csv(ROOM, 1e12), "e+12"),
    "larger than memory": (csv(ROOM, 800.0), "cells"),
    "kilometres": (csv(ROOM, 1e-5), "metre"),
}


def plane(**changes):
    identity = [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -2], [0, 0, 0, 1]]
    good = {"anchorTransform": identity, "centers": [[0, 0, 0]], "extents": [[3, 2.4, 0]]}
    return json.dumps([good | {"planeAlignment": 1} | changes])


SCANS = {
    "empty": ("", "empty"),
    "binary": (BINARY, "detectedPlanes.json"),
    "truncated": (plane()[:-20], "cut off"),
    "wrong format": (csv(ROOM), "scan"),
    "another json": ('{"ARKit_raw_2D": [[0, 1]]}', "detectedPlanes.json"),
    "no planes": ("[]", "wall"),
    "horizontal planes only": (plane(planeAlignment=0), "vertical"),
    "nan": (plane(centers=[[float("nan"), 0, 0]]), "finite"),
    "infinite": (plane(extents=[[float("inf"), 2, 0]]), "finite"),
    "beyond its range": (json.dumps([[[300, -2], [300, 2]]]), "10 m"),
}
RAW = [[-0.3 * i, 0.0] for i in range(1, 14)]
WALKS = {
    "one sample": ({"ARKit_raw_2D": [[1, 0]], "time_intervals": [1.0]}, "at least 2"),
    "times that go back": ({"time_intervals": [1.0] * 6 + [-0.5] + [1.0] * 6}, "sample 6"),
    "lengths that differ": ({"ARKit_raw_2D": RAW[:-1]}, "13"),
    "nan": ({"ARKit_raw_2D": [*RAW[:-1], [float("nan"), 0]]}, "finite"),
    "infinite": ({"time_intervals": [1.0] * 12 + [float("inf")]}, "finite"),
    "units of its own": ({"ARKit_raw_2D": [[10_000 * x, 0] for x, _ in RAW]}, "m/s"),
    "another session": ({"session_id": 8}, "session"),
    "no odometry": ({"ARKit_raw_2D": None, "RoNIN_raw_2D": None}, "ARKit_raw_2D"),
    "no times": ({"time_intervals": None}, "time_intervals"),
}
FILES = {
    "empty": (b"", "empty"),
    "binary": (BINARY, "walk.json"),
    "truncated": (b'{"ARKit_raw_2D": [[0.1, 0.2], [0.', "cut off"),
    "wrong format": (b"0,0,1,1\n", "walk"),
    "a list": (b"[1, 2, 3]", "walk"),
}


def write(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


@pytest.fixture
def fails(palms_fails, own_world):
    """Follow the damaged walk: it fails, and the earlier output is still there."""
    target, out = own_world.folder / "track.json", own_world.folder / "out"
    target.write_text("earlier")

    def run(*options):
        before = sorted(own_world.folder.rglob("*"))
        world = own_world
        arguments = ("track", world.plan, world.scan, world.walk, "--json", target, "--out", out)
        line = palms_fails(*arguments, *options)
        assert target.read_text() == "earlier"
        assert sorted(own_world.folder.rglob("*")) == before
        return line

    return run


@pytest.mark.parametrize("name", PLANS)
def test_plans(fails, own_world, name):
    content, says = PLANS[name]
    write(own_world.plan, content)
    assert says in fails()


@pytest.mark.parametrize("name", SCANS)
def test_scans(fails, own_world, name):
    content, says = SCANS[name]
    write(own_world.scan / "detectedPlanes.json", content)
    assert says in fails()


@pytest.mark.parametrize("name", WALKS)
def test_walks(fails, own_world, name):
    changes, says = WALKS[name]
    write_walk(own_world.walk, **changes)
    assert says in fails()


@pytest.mark.parametrize("name", FILES)
def test_walk_files(fails, own_world, name):
    content, says = FILES[name]
    write(own_world.walk, content)
    assert says in fails()


@pytest.mark.parametrize("which", ["plan", "scan", "walk"])
def test_missing(fails, own_world, which):
    path = getattr(own_world, which)
    path = path / "detectedPlanes.json" if path.is_dir() else path
    path.unlink()
    assert str(getattr(own_world, which)) in fails()


def test_a_method_that_needs_no_scan_still_checks_it(fails, own_world):
    write(own_world.scan / "detectedPlanes.json", "[]")
    fails("--method", "uniform")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--method", "magic"), "one of palms, paper"),
        (("--particles", 0), "n_particles"),
        (("--cell-size", 0), "cell_size_m"),
        (("--cell-size", "nan"), "cell_size_m"),
    ],
)
def test_settings(fails, options, says):
    assert says in fails(*options)


@pytest.mark.parametrize("option", ["--json", "--out"])
@pytest.mark.parametrize("where", ["below a file", "below a file, deep"])
def test_unwritable_output_is_found_before_the_work(fails, own_world, option, where, monkeypatch):
    monkeypatch.setattr("palms.cli.track.follow", pytest.fail)
    target = own_world.plan / "a" / "b" if "deep" in where else own_world.plan / "a"
    assert str(target) in fails(option, target)


@pytest.mark.parametrize("option", ["--json", "--png"])
def test_unwritable_output_of_locate(palms_fails, own_world, option):
    target = own_world.plan / "a.png"
    assert str(target) in palms_fails("locate", own_world.plan, own_world.scan, option, target)


def test_folder_in_place_of_a_file_and_missing_folder(palms_fails, own_world):
    arguments = ("locate", own_world.plan, own_world.scan, "--json")
    assert "got a folder" in palms_fails(*arguments, own_world.folder)
    assert "create it first" in palms_fails(*arguments, own_world.folder / "no" / "a.json")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_without_the_right_to_write(palms_fails, own_world, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    arguments = ("locate", own_world.plan, own_world.scan, "--json", closed / "a.json")
    assert "ermission denied" in palms_fails(*arguments)


@pytest.mark.parametrize("command", ["plan info", "plan show", "scan info", "walk info"])
def test_missing_files_of_the_other_commands(palms_fails, tmp_path, command):
    assert "no-such-file" in palms_fails(*command.split(), tmp_path / "no-such-file.csv")


def test_demo_says_at_once_that_it_cannot_write(palms_fails, own_world):
    assert "no folder" in palms_fails("demo", "--out", own_world.plan / "demo")
