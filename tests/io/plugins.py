"""A format of another package, for the tests of how formats are found."""

from __future__ import annotations

from types import SimpleNamespace

from palms.floorplan import FloorPlan

PLAN = FloorPlan([[[0, 0], [8, 0]]], name="from a plug-in")


def plugin(**changes) -> SimpleNamespace:
    parts = {
        "name": "mine",
        "description": "of mine",
        "suffixes": (".mine",),
        "recognizes": lambda path: path.read_bytes().startswith(b"MINE"),
        "read": lambda path, scale=1.0: PLAN,
        "write": None,
        "extra": None,
    }
    return SimpleNamespace(**(parts | changes))
