"""PALMS: where a phone is inside a building, from its floor plan, one scan and a walk.

``import palms`` loads nothing heavy; each name is loaded when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palms.belief import Belief as Belief
    from palms.belief import Estimate as Estimate
    from palms.belief import Hypothesis as Hypothesis
    from palms.belief import Stage as Stage
    from palms.building import Building as Building
    from palms.building import Stairs as Stairs
    from palms.errors import FormatError as FormatError
    from palms.errors import InputError as InputError
    from palms.errors import OutputError as OutputError
    from palms.errors import PalmsError as PalmsError
    from palms.errors import PalmsWarning as PalmsWarning
    from palms.errors import SettingsError as SettingsError
    from palms.floorplan import FloorPlan as FloorPlan
    from palms.floorplan import Room as Room
    from palms.floorplan import SegmentClass as SegmentClass
    from palms.geodesy import Origin as Origin
    from palms.grid import Grid as Grid
    from palms.heatmap import Candidates as Candidates
    from palms.heatmap import Heatmaps as Heatmaps
    from palms.hints import Hint as Hint
    from palms.io import read_floorplan as read_floorplan
    from palms.io import read_scan as read_scan
    from palms.io import read_walk as read_walk
    from palms.localizer import Happening as Happening
    from palms.localizer import Localizer as Localizer
    from palms.localizer import Track as Track
    from palms.localizer import locate as locate
    from palms.localizer import track as track
    from palms.localizer import track_trials as track_trials
    from palms.odometry import Move as Move
    from palms.odometry import Odometry as Odometry
    from palms.particles import Particles as Particles
    from palms.posterior import Posterior as Posterior
    from palms.raster import PlanRaster as PlanRaster
    from palms.raster import rasterize as rasterize
    from palms.scan import Scan as Scan
    from palms.settings import Settings as Settings
    from palms.template import Template as Template

_HOMES = {
    "FormatError": "errors",
    "InputError": "errors",
    "OutputError": "errors",
    "PalmsError": "errors",
    "PalmsWarning": "errors",
    "SettingsError": "errors",
    "FloorPlan": "floorplan",
    "Room": "floorplan",
    "SegmentClass": "floorplan",
    "Origin": "geodesy",
    "Grid": "grid",
    "Move": "odometry",
    "Odometry": "odometry",
    "Scan": "scan",
    "Settings": "settings",
    "Belief": "belief",
    "Estimate": "belief",
    "Hypothesis": "belief",
    "Stage": "belief",
    "Building": "building",
    "Stairs": "building",
    "Candidates": "heatmap",
    "Heatmaps": "heatmap",
    "Hint": "hints",
    "Happening": "localizer",
    "Localizer": "localizer",
    "Track": "localizer",
    "locate": "localizer",
    "track": "localizer",
    "track_trials": "localizer",
    "Particles": "particles",
    "Posterior": "posterior",
    "PlanRaster": "raster",
    "rasterize": "raster",
    "Template": "template",
    "read_floorplan": "io",
    "read_scan": "io",
    "read_walk": "io",
}

__all__ = sorted(_HOMES)  # noqa: PLE0605


def __getattr__(name: str) -> Any:  # noqa: ANN401
    if name in _HOMES:
        return getattr(importlib.import_module(f"palms.{_HOMES[name]}"), name)
    if name == "__version__":
        from importlib.metadata import version

        return version("palms-localization")
    raise AttributeError(f"module 'palms' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
