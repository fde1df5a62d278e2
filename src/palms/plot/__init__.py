"""Pictures of plans, scans and walks: figures, an animation, a report.

All take values and return matplotlib figures or write files; nothing opens a window. Each name
is loaded when it is first used, and matplotlib with it.

Examples
--------
>>> from palms import FloorPlan
>>> from palms.plot import image_bytes, plan_figure
>>> image_bytes(plan_figure(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]])))[1:4]
b'PNG'
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palms.plot.album import Picture as Picture
    from palms.plot.album import make_album as make_album
    from palms.plot.album import write_album as write_album
    from palms.plot.animation import animation_bytes as animation_bytes
    from palms.plot.animation import write_animation as write_animation
    from palms.plot.candidates import candidates_figure as candidates_figure
    from palms.plot.empty_space import empty_space_figure as empty_space_figure
    from palms.plot.output import image_bytes as image_bytes
    from palms.plot.output import write_figure as write_figure
    from palms.plot.pipeline import pipeline_figure as pipeline_figure
    from palms.plot.plans import plan_figure as plan_figure
    from palms.plot.recorder import Recorder as Recorder
    from palms.plot.recorder import Snapshot as Snapshot
    from palms.plot.report import Details as Details
    from palms.plot.report import report_html as report_html
    from palms.plot.report import write_report as write_report
    from palms.plot.scans import scan_figure as scan_figure
    from palms.plot.stages import stages_figure as stages_figure
    from palms.plot.story import Story as Story
    from palms.plot.tracks import track_figure as track_figure
    from palms.plot.walks import walk_figure as walk_figure

_HOMES = {
    "Details": "report",
    "Picture": "album",
    "Recorder": "recorder",
    "Snapshot": "recorder",
    "Story": "story",
    "animation_bytes": "animation",
    "candidates_figure": "candidates",
    "empty_space_figure": "empty_space",
    "image_bytes": "output",
    "make_album": "album",
    "pipeline_figure": "pipeline",
    "plan_figure": "plans",
    "report_html": "report",
    "scan_figure": "scans",
    "stages_figure": "stages",
    "track_figure": "tracks",
    "walk_figure": "walks",
    "write_album": "album",
    "write_animation": "animation",
    "write_figure": "output",
    "write_report": "report",
}

__all__ = sorted(_HOMES)  # noqa: PLE0605


def __getattr__(name: str) -> Any:  # noqa: ANN401
    if name in _HOMES:
        return getattr(importlib.import_module(f"palms.plot.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'palms.plot' has no attribute {name!r}")


def __dir__() -> list[str]:
    return list(__all__)
