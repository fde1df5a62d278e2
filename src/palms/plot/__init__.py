"""Pictures of a walk: figures, an animation, and a report that holds them.

Each name is loaded when it is first used; matplotlib not before.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palms.plot.animation import write_animation as write_animation
    from palms.plot.empty_space import empty_space_figure as empty_space_figure
    from palms.plot.gallery import Picture as Picture
    from palms.plot.gallery import draw_gallery as draw_gallery
    from palms.plot.output import image_bytes as image_bytes
    from palms.plot.output import write_figure as write_figure
    from palms.plot.path import track_figure as track_figure
    from palms.plot.pipeline import pipeline_figure as pipeline_figure
    from palms.plot.places import places_figure as places_figure
    from palms.plot.plans import plan_figure as plan_figure
    from palms.plot.recorder import Recorder as Recorder
    from palms.plot.report import write_report as write_report
    from palms.plot.stages import moments_figure as moments_figure
    from palms.plot.stages import stages_figure as stages_figure
    from palms.plot.story import Story as Story

_HOMES = {
    "Picture": "gallery",
    "Recorder": "recorder",
    "Story": "story",
    "draw_gallery": "gallery",
    "empty_space_figure": "empty_space",
    "image_bytes": "output",
    "moments_figure": "stages",
    "pipeline_figure": "pipeline",
    "places_figure": "places",
    "plan_figure": "plans",
    "stages_figure": "stages",
    "track_figure": "path",
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
