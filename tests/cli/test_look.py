import json
import os

import pytest

import palms as package


def test_plan_info(palms, world):
    result = palms("plan", "info", world.plan)
    assert result.exit_code == 0
    assert "20.0 x 12.0 m" in result.stdout
    facts = json.loads(palms("plan", "info", world.plan, "--json", "-").stdout)
    assert facts["schema"] == "palms-plan/1"
    assert facts["size_m"] == [20.0, 12.0]
    assert facts["segments"]["wall"]["count"] == 14
    assert facts["segments"]["door"]["count"] == 0


def test_plan_show_names_the_picture(palms, world, tmp_path, monkeypatch):
    target = tmp_path / "a.png"
    result = palms("plan", "show", world.plan, "--png", target)
    assert result.stdout == f"Picture: {target}\n"
    monkeypatch.chdir(tmp_path)
    assert palms("plan", "show", world.plan).stdout == "Picture: plan.png\n"
    assert sorted(os.listdir(tmp_path)) == ["a.png", "plan.png"]


def test_scan_info(palms, world):
    assert "walls" in palms("scan", "info", world.scan).stdout
    facts = json.loads(palms("scan", "info", world.scan, "--json", "-").stdout)
    assert facts["session"] == "7"
    assert facts["walls"] > 0


def test_walk_info(palms, world):
    assert "3.9 m" in palms("walk", "info", world.walk).stdout
    facts = json.loads(palms("walk", "info", world.walk, "--json", "-").stdout)
    assert facts["samples"] == world.steps
    assert facts["length_m"] == {"arkit": pytest.approx(3.9), "ronin": pytest.approx(4.29)}
    assert facts["references"] == world.steps - 7


def test_formats(palms, tmp_path):
    result = palms("formats", "--json", tmp_path / "formats.json")
    assert "csv" in result.stdout
    known = json.loads((tmp_path / "formats.json").read_text())["formats"]
    assert {each["what"] for each in known} == {"floor plan", "scan", "walk"}
    assert all(each["description"] for each in known)


def test_version(palms):
    assert palms("--version").stdout == f"palms {package.__version__}\n"


@pytest.mark.parametrize(
    "command",
    ["demo", "locate", "track", "plan info", "plan show", "scan info", "walk info", "formats"],
)
def test_help_has_an_example(palms, command):
    result = palms(*command.split(), "--help")
    assert result.exit_code == 0
    assert f"Example: palms {command}" in result.stdout


def test_without_arguments_there_is_help(palms):
    result = palms()
    assert result.exit_code == 2
    assert "demo" in result.output
