"""Reading and writing: one file per format, found by entry points.

`read_floorplan`, `read_scan` and `read_walk` find out the format; `open_dataset` looks up
a whole data set. What is wrong with a file is said in one line, as a `palms.InputError`.

Examples
--------
>>> import tempfile
>>> from palms import FloorPlan
>>> with tempfile.TemporaryDirectory() as folder:
...     write_plan_csv(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]]), f"{folder}/hall.csv")
...     read_floorplan(f"{folder}/hall.csv").name
'hall'
"""

from __future__ import annotations

from palms.io.dataset import (
    Case,
    Dataset,
    check_same_session,
    open_dataset,
)
from palms.io.dataset_output import write_case, write_plan
from palms.io.events import Event, read_events, write_events
from palms.io.files import read_json, read_text, write_json, write_text
from palms.io.label import Label, read_label, write_label
from palms.io.levels import LevelPlan
from palms.io.plan_csv import read_plan_csv, write_plan_csv
from palms.io.planes import read_scan_json, write_scan_json
from palms.io.reading import (
    read_any,
    read_building,
    read_floorplan,
    read_levels,
    read_scan,
    read_walk,
    write_floorplan,
)
from palms.io.registry import (
    FLOORPLANS,
    ODOMETRY,
    SCANS,
    Format,
    choose_format,
    choose_writer,
    formats,
)
from palms.io.tracking import read_tracking, write_tracking
from palms.io.truth import Truth, read_truth, write_truth
from palms.io.tum import read_tum, write_tum, write_walk_tum
from palms.io.walk import RecordedWalk, WalkSource

__all__ = [
    "FLOORPLANS",
    "ODOMETRY",
    "SCANS",
    "Case",
    "Dataset",
    "Event",
    "Format",
    "Label",
    "LevelPlan",
    "RecordedWalk",
    "Truth",
    "WalkSource",
    "check_same_session",
    "choose_format",
    "choose_writer",
    "formats",
    "open_dataset",
    "read_any",
    "read_building",
    "read_events",
    "read_floorplan",
    "read_json",
    "read_label",
    "read_levels",
    "read_plan_csv",
    "read_scan",
    "read_scan_json",
    "read_text",
    "read_tracking",
    "read_truth",
    "read_tum",
    "read_walk",
    "write_case",
    "write_events",
    "write_floorplan",
    "write_json",
    "write_label",
    "write_plan",
    "write_plan_csv",
    "write_scan_json",
    "write_text",
    "write_tracking",
    "write_truth",
    "write_tum",
    "write_walk_tum",
]
