"""Pictures of plans, scans and walks: figures, an animation, a report.

All take values and return matplotlib figures or write files; nothing opens a window.

Examples
--------
>>> from palms import FloorPlan
>>> from palms.plot import image_bytes, plan_figure
>>> image_bytes(plan_figure(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]])))[1:4]
b'PNG'
"""

from palms.plot.album import Picture, make_album, write_album
from palms.plot.animation import animation_bytes, write_animation
from palms.plot.candidates import candidates_figure
from palms.plot.empty_space import empty_space_figure
from palms.plot.output import image_bytes, write_bytes, write_figure
from palms.plot.pipeline import pipeline_figure
from palms.plot.plans import plan_figure
from palms.plot.recorder import Recorder, Snapshot
from palms.plot.report import Details, report_html, write_report
from palms.plot.stages import stages_figure
from palms.plot.story import Story
from palms.plot.tracks import track_figure

__all__ = [
    "Details",
    "Picture",
    "Recorder",
    "Snapshot",
    "Story",
    "animation_bytes",
    "candidates_figure",
    "empty_space_figure",
    "image_bytes",
    "make_album",
    "pipeline_figure",
    "plan_figure",
    "report_html",
    "stages_figure",
    "track_figure",
    "write_album",
    "write_animation",
    "write_bytes",
    "write_figure",
    "write_report",
]
