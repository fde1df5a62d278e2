"""The scripts of the repository can be started: what they import is there."""

import importlib.util
import sys
from pathlib import Path

import pytest

from benchmarks import curves

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = sorted([*(ROOT / "tools").glob("*.py"), *(ROOT / "benchmarks").glob("bench_*.py")])


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_imports_what_is_there(path, monkeypatch):
    monkeypatch.setattr(sys, "path", [str(path.parent), str(ROOT), *sys.path])
    spec = importlib.util.spec_from_file_location(f"script_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    assert module.__doc__


def test_the_curve_of_trials_says_each_size_as_it_comes(capsys):
    one, two = curves.trials((1, 2), (3, 5))
    assert (one.name, two.name) == ("1 core", "2 cores")
    for curve in (one, two):
        assert curve.size == (1, 2, 3, 5)
        assert 0 < curve.time_ms[2] < curve.time_ms[3]  # of one run
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 8
    assert said[-1].startswith("5 trials, 2 cores: ")
