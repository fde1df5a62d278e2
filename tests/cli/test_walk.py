"""``palms walk info|show|convert`` on files of each format."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from palms.io import read_tracking, read_tum, read_walk
from tests.cli.conftest import write_walk

FILES = Path(__file__).parents[1] / "io" / "data" / "walks"


@pytest.mark.parametrize("file", sorted(FILES.iterdir()), ids=lambda path: path.name)
def test_info_of_each_format(palms, file):
    result = palms("walk", "info", file)
    assert result.exit_code == 0, result.stderr
    assert "Traceback" not in result.stderr
    facts = json.loads(palms("walk", "info", file, "--json", "-").stdout)
    own = file.stem in ("android", "ronin", "steps") or file.stem.startswith("sensor")
    source, frame = ("ronin", "own") if own else ("arkit", "scan")
    assert facts["frame"] == {source: frame}
    assert facts["facing"] == {source: not own}
    words = "a frame of its own" if own else "the scan's frame, with where the phone looked"
    assert f"{facts['length_m'][source]:.1f} m" in result.stdout
    assert words in result.stdout
    assert f"format     {facts['format']}" in result.stdout


def test_damage_is_a_note(palms):
    result = palms("walk", "info", FILES / "android.txt")
    assert result.stderr.startswith("palms: note: ")
    assert "1 of 4461 rows" in result.stderr


@pytest.mark.parametrize("name", ["android.txt", "arkit-3x4-ns.txt", "ronin.npy"])
def test_show_names_the_picture(palms, tmp_path, monkeypatch, name):
    target = tmp_path / "a.png"
    assert palms("walk", "show", FILES / name, "--png", target).stdout == f"Picture: {target}\n"
    monkeypatch.chdir(tmp_path)
    stem = Path(name).stem
    assert palms("walk", "show", FILES / name).stdout == f"Picture: {stem}.png\n"
    assert sorted(os.listdir(tmp_path)) == sorted(["a.png", f"{stem}.png"])


def test_show_draws_the_odometry_that_is_asked_for(palms, world, tmp_path):
    drawn = []
    for source in ("arkit", "ronin"):
        target = tmp_path / f"{source}.png"
        palms("walk", "show", world.walk, "--walk-source", source, "--png", target)
        drawn.append(target.read_bytes())
    assert drawn[0] != drawn[1]


def test_convert_to_tum_and_back(palms, world, tmp_path):
    out = tmp_path / "walk.tum"
    assert palms("walk", "convert", world.walk, out).stdout == f"Walk: {out}\n"
    before, after = read_walk(world.walk).odometry("arkit"), read_tum(out).odometry()
    np.testing.assert_allclose(after.position_m, before.position_m, atol=1e-4)
    np.testing.assert_allclose(after.time_s, before.time_s, atol=1e-6)
    palms("walk", "convert", world.walk, out, "--walk-source", "ronin")
    own = read_tum(out).odometry("ronin")
    np.testing.assert_allclose(own.position_m, 1.1 * before.position_m, atol=1e-3)
    assert own.frame == "own"


@pytest.mark.filterwarnings("ignore:.*cannot be read and are left out")
@pytest.mark.parametrize("name", ["arkit-3x4-ns.txt", "android.txt", "sensor-logger-ios.zip"])
def test_convert_to_the_data_set_s_walks(palms, tmp_path, name):
    out = tmp_path / "walk.json"
    palms("walk", "convert", FILES / name, out)
    before, after = read_walk(FILES / name), read_tracking(out)
    (source,) = before.sources
    one, other = before.odometry(source), after.odometry(source)
    np.testing.assert_allclose(other.position_m, one.position_m, atol=1e-9)
    assert (other.frame, other.source) == (one.frame, one.source)
    np.testing.assert_array_equal(after.reference_m[7:], before.reference_m[7:])


def test_a_walk_that_begins_elsewhere_keeps_its_frame(palms, tmp_path):
    path = tmp_path / "log.txt"
    path.write_text("".join(f"{k} 2 0 {-k - 1} 0 0 0 1\n" for k in range(4)))
    palms("walk", "convert", path, tmp_path / "walk.json")
    walk = read_tracking(tmp_path / "walk.json").odometry()
    np.testing.assert_allclose(walk.position_m, [[2, 2], [2, 3], [2, 4]])
    assert walk.start_m.tolist() == [0, 0]


def test_mistakes_are_one_line(palms_fails, world, tmp_path):
    assert "ends in .json (tracking), .tum .txt (tum)" in palms_fails(
        "walk", "convert", world.walk, tmp_path / "walk.doc"
    )
    only = write_walk(tmp_path / "only.json", RoNIN_raw_2D=None)
    line = palms_fails("walk", "convert", only, tmp_path / "a.tum", "--walk-source", "ronin")
    assert "expected one of arkit" in line
    assert "expected one of arkit" in palms_fails("walk", "show", only, "--walk-source", "ronin")
    assert not (tmp_path / "a.tum").exists()
    assert "nothing there" in palms_fails("walk", "show", tmp_path / "none.txt")
    assert "no folder" in palms_fails("walk", "convert", world.walk, tmp_path / "no" / "a.tum")


@pytest.mark.parametrize("command", ["show", "convert"])
def test_help_has_an_example(palms, command):
    result = palms("walk", command, "--help")
    assert f"Example: palms walk {command}" in result.stdout
