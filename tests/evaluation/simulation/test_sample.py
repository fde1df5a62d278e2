import importlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from palms import io
from palms.geometry import rotate
from palms.sample import sample_folder

TOOLS = Path(__file__).parents[3] / "tools"


@pytest.fixture(scope="module")
def case():
    (only,) = io.open_dataset(sample_folder()).cases
    return only


def files_of(folder):
    return {f.relative_to(folder): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


def test_what_ships_is_what_the_tool_writes(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(TOOLS))
    importlib.import_module("make_sample").make_sample(tmp_path)
    written, shipped = files_of(tmp_path), files_of(sample_folder())
    assert set(written) == set(shipped)
    drawn = Path("phone", "plan.png")  # whose letters depend on the version of pillow
    found = [np.asarray(Image.open(folder / drawn)) for folder in (tmp_path, sample_folder())]
    assert found[0].shape == found[1].shape
    assert np.mean(found[0] != found[1]) < 0.01
    changed = [str(n) for n in written if n != drawn and written[n] != shipped[n]]
    assert not changed, "run: python tools/make_sample.py"


def test_it_is_small():
    assert sum(map(len, files_of(sample_folder()).values())) < 300_000


def test_plan_scan_and_walk_are_as_promised(case):
    plan, scan, walk = case.plan(), case.scan(), case.walk()
    assert (case.scene, plan.level) == ("sample", "2")
    assert len(plan.rooms) == 80
    assert 6 <= len(scan.walls_m) <= 20
    assert scan.coverage_m.shape == (360,)
    assert walk.truth is not None
    moves = np.diff(walk.truth.position_m, axis=0, prepend=walk.start_m[None])
    assert np.linalg.norm(moves, axis=1).sum() == pytest.approx(147.0, abs=1.0)
    assert walk.time_s[0] > 12.0
    io.check_same_session(scan, walk)


def test_the_frames_fit_together(case):
    label, walk = case.label(), case.walk()
    believed = rotate(walk.odometry("arkit").position_m, label.drift_rad) + label.position_m
    error = np.linalg.norm(believed - walk.truth.position_m, axis=1)
    assert error[0] < 0.2
    assert error.max() < 8.0
    assert np.linalg.norm(walk.start_m - label.position_m) < 0.2


def test_the_walk_passes_several_corridors(case):
    plan, truth = case.plan(), case.walk().truth
    passed = {plan.room_at(point) for point in truth.position_m}
    assert sum("corridor" in (name or "") for name in passed) >= 3


def test_importing_the_simulator_does_not_import_matplotlib():
    code = "import sys, palms.evaluation.simulation; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
