"""One case of the real benchmark from end to end; skipped where its data is not there."""

import importlib
import json
import math
import os
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

from palms.errors import InputError
from palms.evaluation.provenance import source_digest
from palms.evaluation.simulation import VioNoise

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("PALMS_DATA") or ROOT / ".." / "shared" / "data")
RADISH = DATA / "radish" / "intel"

pytestmark = pytest.mark.skipif(
    not RADISH.is_dir(), reason=f"the Radish logs are not in {DATA / 'radish'} (set PALMS_DATA)"
)


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(ROOT))
    try:
        from benchmarks.real import cases, radish, run, table

        yield {"cases": cases, "radish": radish, "run": run, "table": table}
    finally:
        sys.path.remove(str(ROOT))


@pytest.fixture(scope="module")
def key(bench):
    return bench["cases"].Key("intel", bench["radish"].starts("intel", "development")[0])


@pytest.fixture(scope="module")
def intel(bench, key):
    return bench["cases"].load_case(key, None)


def test_the_reference_never_walks_through_a_wall_of_a_clean_plan(intel):
    path = np.concatenate([intel.walk.start_m[None], intel.walk.position_m])
    walls = shapely.linestrings(intel.raster.plan.blocking_m)
    assert not shapely.intersects(shapely.LineString(path), walls).any()
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert steps.max() < 0.66
    assert 60 / 0.65 - 1 <= len(steps) <= 100 / 0.65


def test_the_scan_lies_on_the_plan_at_the_true_pose(intel):
    assert intel.scan_in_plan > 0.5


def test_a_trial_with_the_papers_method(bench, intel):
    from palms import Settings

    row = bench["cases"].run_trial(intel, "paper", Settings.paper(), seed=0)
    again = bench["cases"].run_trial(intel, "paper", Settings.paper(), seed=0)
    assert row == again
    assert json.loads(json.dumps(row, allow_nan=False)) == row
    assert all(math.isfinite(v) for v in row.values() if isinstance(v, float))
    for name in ("useful", "right_place", "coverage_68", "coverage_95", "false_localized"):
        assert row[name] is None or 0 <= row[name] <= 1
    assert 50 < row["length_m"] < 115
    assert row["declared"] == (row["declared_after_m"] is not None)
    assert "| paper | 1 |" in bench["table"].markdown([row], "one trial")


def test_results_are_json(bench, tmp_path):
    plan = bench["run"].Plan(("paper", "oracle"), ("intel",), ("as-is",), ("clean",), seeds=1)
    content = json.loads(json.dumps(bench["run"].as_json(plan), allow_nan=False))
    assert content["schema"] == "palms-bench/1"
    assert content["versions"]["source"] == source_digest()
    assert content["settings"]["methods"]["oracle"]["motion"]["scale_sd"] == VioNoise().scale_sd


def test_the_oracle_knows_the_noise_that_is_added(bench, intel):
    settings = bench["run"].settings_of("oracle").with_particles(500)
    row = bench["cases"].run_trial(intel, "oracle", settings, seed=0)
    assert (row["method"], settings.motion.scale_sd) == ("oracle", VioNoise().scale_sd)
    assert 0 <= row["useful"] <= 1


def test_the_command_runs_and_fills_in_its_table(bench, tmp_path, monkeypatch):
    main = importlib.import_module("benchmarks.real.__main__")
    trial = {"scene": "intel", "grade": "as-is", "suite": "clean", "walk": "start-1"}
    monkeypatch.setattr(main, "run", lambda *_: iter([[trial]]))
    for name in ("markdown", "digest"):
        monkeypatch.setattr(main, name, lambda trials, *_: f"{len(trials)} trials")
    page = tmp_path / "page.md"
    page.write_text("above\n<!-- table:radish -->\nold\n<!-- /table:radish -->\nbelow\n")
    assert main.main(["--out", str(tmp_path / "r"), "--results", str(page)]) == 0
    text = page.read_text()
    assert text.startswith("above\n<!-- table:radish -->\n\nRadish, development starts")
    assert text.endswith("1 trials\n\n<!-- /table:radish -->\nbelow\n")
    results = json.loads((tmp_path / "r" / "results.json").read_text())
    assert results["trials"] == [trial]
    assert tuple(results["settings"]["methods"]) == bench["run"].ROWS


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "--out DIR"),
        (["--out", "r", "--methods", "magic"], "got magic"),
        (["--out", "r", "--results", "no-such-page.md"], "no-such-page.md"),
    ],
)
def test_what_cannot_end_is_refused(bench, tmp_path, monkeypatch, capsys, words, says):
    monkeypatch.chdir(tmp_path)
    main = importlib.import_module("benchmarks.real.__main__").main
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    assert says in capsys.readouterr().err


def test_a_page_without_marks_is_refused(bench, tmp_path):
    page = importlib.import_module("benchmarks.page")
    (tmp_path / "page.md").write_text("<!-- table:radish -->")
    with pytest.raises(InputError, match="expected the marks"):
        page.put("radish", "text", tmp_path / "page.md")


def test_a_case_written_as_a_data_set_reads_back(bench, intel, tmp_path):
    from palms.io import open_dataset

    bench["cases"].write_as_dataset(intel, tmp_path)
    (case,) = open_dataset(tmp_path).cases
    recorded = case.walk()
    assert case.scene == "intel"
    assert len(recorded) == len(intel.walk.time_s)
    known = recorded.has_reference
    np.testing.assert_allclose(recorded.reference_m[known], intel.walk.position_m[known], atol=1e-9)
    np.testing.assert_allclose(case.label().position_m, intel.walk.start_m)
    assert case.label().drift_rad == pytest.approx(intel.drift_rad)
    np.testing.assert_allclose(case.scan().walls_m, intel.scan.walls_m, atol=1e-6)


def test_fixed_starts_are_those_derived_from_the_logs(bench):
    radish = bench["radish"]
    stored = json.loads(radish.STARTS_FILE.read_text())
    chosen = radish.choose_starts(radish.read_log("intel"), "position")
    assert stored["position"]["intel"] == {"development": chosen[::2], "reporting": chosen[1::2]}
