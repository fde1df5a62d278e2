"""`palms scan` on files of every kind."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parents[1] / "io" / "data" / "scans"


def test_info_of_depth_says_what_is_empty(palms):
    facts = json.loads(palms("scan", "info", DATA / "depth", "--json", "-").stdout)
    assert facts["schema"] == "palms-scan/1"
    assert (facts["walls"], facts["coverage"], facts["coverage_share"]) == (7, True, 1.0)
    assert 50 < facts["free_m2"] < 60
    assert "m² seen to be empty" in palms("scan", "info", DATA / "depth").stdout
    assert "not recorded" in palms("scan", "info", DATA / "cloud.ply").stdout


def test_show_names_the_picture(palms, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert palms("scan", "show", DATA / "roomplan.json").stdout == "Picture: roomplan.png\n"
    assert palms("scan", "show", DATA / "depth", "--png", "a.svg").stdout == "Picture: a.svg\n"
    assert sorted(os.listdir(tmp_path)) == ["a.svg", "roomplan.png"]


def test_convert_gives_what_every_command_reads(palms, world, tmp_path):
    session = tmp_path / "Session_9"
    result = palms("scan", "convert", DATA / "roomplan.json", session)
    assert (result.exit_code, result.stdout) == (0, f"Scan: {session}\n")
    assert json.loads(palms("scan", "info", session, "--json", "-").stdout)["session"] == "9"
    assert palms("locate", world.plan, session, "--top", "1").exit_code == 0


@pytest.mark.parametrize("name", ["cloud.ply", "cloud.npz", "depth", "stray", "cloud.laz"])
def test_extract_finds_the_walls(palms, tmp_path, name):
    out = tmp_path / "scan.json"
    result = palms("scan", "extract", DATA / name, out, "--png", tmp_path / "a.png", "--json", "-")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["walls"] == 7
    assert f"Scan: {out}" in result.stderr
    facts = json.loads(palms("scan", "info", out, "--json", "-").stdout)
    assert facts["walls"] == 7
    assert facts["coverage"] == (name in ("depth", "stray"))
    assert (tmp_path / "a.png").is_file()


def test_extract_takes_what_the_user_knows(palms, tmp_path):
    out = tmp_path / "scan.json"
    command = ["scan", "extract", DATA / "cloud.npz", out, "--json", "-"]
    options = ["--up", "y", "--position", "0.5,-1", "--floor", "-1.4", "--min-length", "2"]
    facts = json.loads(palms(*command, *options).stdout)
    assert facts["position_m"] == [0.5, -1.0]
    assert facts["walls"] < 7
    joined = json.loads(palms(*command, "--gap", "3").stdout)
    longest = [
        np.linalg.norm(np.diff(f["walls_m"], axis=1), axis=-1).max() for f in (facts, joined)
    ]
    assert longest[1] >= longest[0] - 0.001


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("extract", DATA / "roomplan.json", "OUT"), "which has walls; use palms scan convert"),
        (("extract", DATA / "cloud.npz", "OUT", "--up", "w"), "option up"),
        (("extract", DATA / "cloud.npz", "OUT", "--position", "a"), "option position"),
        (("extract", DATA / "depth", "OUT", "--up", "y"), "options for format depth-folder"),
        (("extract", DATA / "cloud.npz", "OUT", "--gap", "99"), "extraction.gap_m"),
        (("extract", DATA / "cloud.npz", "no/folder/scan.json"), "no folder"),
        (("convert", DATA / "none.json", "OUT"), "nothing there"),
        (("convert", DATA / "roomplan.json", DATA / "walls.json" / "x"), "no folder|can be"),
        (("show", DATA / "depth" / "depths" / "depth_0.json", "--png", "OUT"), "segments"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(palms_fails, tmp_path, arguments, words):
    import re

    out = tmp_path / "scan.json"
    line = palms_fails("scan", *(out if each == "OUT" else each for each in arguments))
    assert re.search(words, line), line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["show", "convert", "extract"])
def test_help_has_an_example(palms, command):
    result = palms("scan", command, "--help")
    assert f"Example: palms scan {command}" in result.stdout
