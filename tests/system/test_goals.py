"""The table of goals says what results say, and that what was not measured was not."""

import json
import math

import pytest

from benchmarks.goals.__main__ import main
from benchmarks.goals.figures import alarms_per_km, metres_ratio, off_by, ratio, reliability_of


def trial(method, scene, **figures):
    plain = {
        "walk": "walk", "trial": 0, "declared": True, "wrong": False, "false_localized": 0.0,
        "useful": 0.5, "right_after_m": 20.0, "declared_after_m": 20.0, "declared_after_s": 20.0,
        "coverage_68": 0.7, "coverage_95": 0.95, "radius_95_m": 1.0, "false_alarms": 0,
        "length_m": 100.0, "duration_s": 90.0, "sampled_p_within_1m": 0.9,
        "sampled_within_1m": True,
    }  # fmt: skip
    return {"method": method, "scene": scene, **plain, **figures}


def walks(n, method, **figures):
    return [trial(method, f"office-{1000 + k}", **figures) for k in range(n)]


def test_ratios_are_against_the_oracle():
    trials = walks(2, "palms", useful=0.4) + walks(2, "oracle", useful=0.5)
    assert ratio(trials, "useful") == pytest.approx(0.8)


def test_a_ratio_to_nothing_is_no_number():
    trials = walks(2, "palms") + walks(2, "oracle", useful=0.0)
    assert math.isnan(ratio(trials, "useful"))


def test_metres_count_on_walks_that_both_declare_rightly():
    trials = [
        trial("palms", "office-1000", right_after_m=30.0), trial("oracle", "office-1000"),
        trial("palms", "office-1001", right_after_m=None),
        trial("oracle", "office-1001", right_after_m=1.0),
        trial("palms", "office-1002"), trial("oracle", "office-1002", right_after_m=None),
    ]  # fmt: skip
    assert metres_ratio(trials) == pytest.approx(1.5)


def test_a_bin_that_claims_too_much_is_named():
    honest = walks(40, "palms", sampled_p_within_1m=0.98)
    assert off_by(reliability_of(honest)) == []
    boaster = walks(40, "palms", sampled_within_1m=False)
    assert [missed.split(":")[0] for missed in off_by(reliability_of(boaster))] == ["0.90"]


def test_alarms_are_counted_by_the_kilometre():
    assert alarms_per_km(walks(5, "palms", false_alarms=1)).value == pytest.approx(10.0)


def test_the_table_has_what_was_measured_and_names_the_rest(tmp_path, capsys):
    folder = tmp_path / "results-buildings"
    folder.mkdir()
    trials = walks(12, "palms", false_localized=0.02) + walks(12, "oracle")
    (folder / "results.json").write_text(json.dumps({"trials": trials}))
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- table:goals -->\n<!-- /table:goals -->\nafter\n")
    assert main(["--work", str(tmp_path), "--results", str(page)]) == 0
    text = page.read_text()
    assert "2.0 % [2.0, 2.0] | no |" in text
    assert "| at least 0.95 | 1.00 (0.50 and 0.50) | yes |" in text
    assert "Not measured: nuisances, Radish, mall, events." in capsys.readouterr().out
    assert text.startswith("before")
    assert text.endswith("after\n")
