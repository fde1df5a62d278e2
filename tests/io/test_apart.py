"""Parsers in a process of their own: what they return, raise, and what becomes of a crash."""

from __future__ import annotations

import sys

import pytest

from palms.errors import FormatError, InputError
from palms.io import apart
from palms.io.apart import require, run_apart


def test_results_and_errors_come_back(tmp_path):
    assert run_apart("operator:add", ([1], [2]), "a.ifc", "an IFC model") == [1, 2]
    with pytest.raises(InputError, match="none: expected a file, got nothing there"):
        run_apart("palms.io.files:read_bytes", (tmp_path / "none",), "a.ifc", "an IFC model")
    with pytest.raises(ModuleNotFoundError) as caught:
        run_apart("no_such_module:f", (), "a.ifc", "an IFC model")
    assert caught.value.name == "no_such_module"


def test_what_libraries_print_is_no_answer():
    assert run_apart("builtins:print", ("hello",), "a.ifc", "an IFC model") is None


def test_a_crash_is_one_line(says):
    for target, arguments in (("os:abort", ()), ("os:_exit", (0,)), ("builtins:int", ("x",))):
        with pytest.raises(FormatError) as caught:
            run_apart(target, arguments, "a.ifc", "an IFC model")
        says(caught.value, "a.ifc", "an IFC model that is whole")


@pytest.mark.skipif(sys.platform == "win32", reason="it has no signal.pause")
def test_a_hang_ends(says, monkeypatch):
    monkeypatch.setattr(apart, "SECONDS", 0.5)
    with pytest.raises(FormatError) as caught:
        run_apart("signal:pause", (), "a.ifc", "an IFC model")
    says(caught.value, "more than 0.5 s")


@pytest.mark.skipif(sys.platform == "win32", reason="its processes have no such limits")
def test_memory_is_bounded(says):
    with pytest.raises(FormatError) as caught:
        run_apart("builtins:bytearray", (2_000_000_000,), "a.ifc", "an IFC model")
    says(caught.value, "fits into 1 GB")


def test_a_library_that_is_missing_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ifcopenshell", None)
    for name in ("ifcopenshell", "no_such_module"):
        with pytest.raises(ModuleNotFoundError) as caught:
            require(name)
        assert caught.value.name == name
