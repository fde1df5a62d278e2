"""What a walk of a data set tells a method on the way: further scans, and hints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from palms.geometry import FloatArray
from palms.io.events import Event
from palms.odometry import Odometry
from palms.scan import Scan

if TYPE_CHECKING:
    from palms.building import Building
    from palms.hints import Hint
    from palms.localizer import Happening

__all__ = ["happenings_of"]

HINT_PROBABILITY = 0.8  # ours: of a hint that does not say how often such hints are true
LEVEL_PROBABILITY = 0.99  # ours: the phone's barometer tells a change of level rather surely
HINT_RADIUS_M = 5.0  # ours: of a hint that does not say


def happenings_of(
    scans: Sequence[Scan], events: Sequence[Event], odometry: Odometry, building: Building
) -> tuple[Happening, ...]:
    """Return what a method is told during a walk, in order of time.

    A jump of the odometry is for the judge alone; so is whether a hint is true.

    Parameters
    ----------
    scans : sequence of Scan
        The first was taken where the walk begins, whatever time it states; later ones count
        where they state one and are of the same session, so that they share its frame.
    events : sequence of Event
    odometry : Odometry
        The walk. Where its frame is not the scans', later scans are moved to where it says
        that the phone was.
    building : Building

    Examples
    --------
    >>> from palms.building import Building
    >>> from palms.floorplan import FloorPlan
    >>> walk = Odometry([1, 2, 3], [[1, 0], [2, 0], [3, 0]])
    >>> events = [Event(2.0, "hint", room="Hall"), Event(3.0, "jump")]
    >>> told = happenings_of([], events, walk, Building((FloorPlan([[[0, 0], [8, 0]]]),)))
    >>> [(each.time_s, each.what.room, each.what.probability) for each in told]
    [(2.0, 'Hall', 0.8)]
    """
    from palms.localizer import Happening

    told = [Happening(-math.inf, scan) for scan in scans[:1]]
    for scan in scans[1:]:
        if scan.time_s > 0 and scan.session == scans[0].session:
            told.append(Happening(scan.time_s, _in_frame(scan, odometry)))
    for event in events:
        hint = _hint(event, building)
        if hint is not None:
            told.append(Happening(event.time_s, hint))
    return tuple(sorted(told, key=lambda each: each.time_s))


def _in_frame(scan: Scan, odometry: Odometry) -> Scan:
    """Move a scan to where an odometry of its own frame says that the phone was."""
    if odometry.frame == "scan":
        return scan
    at = max(0, int(np.searchsorted(odometry.time_s, scan.time_s + 1e-6)) - 1)
    here: FloatArray = odometry.position_m[at]
    return replace(scan, walls_m=scan.relative_m + here, position_m=here)


def _hint(event: Event, building: Building) -> Hint | None:
    from palms.hints import Hint

    several = len(building.levels) > 1
    level = event.level if several else None
    if event.kind == "level" and several:
        return Hint(level=level, probability=event.probability or LEVEL_PROBABILITY)
    if event.kind != "hint" or (event.position_m, event.room, level) == (None, None, None):
        return None
    place = None if event.position_m is None else np.array(event.position_m)
    return Hint(
        place, event.radius_m or HINT_RADIUS_M, event.room, level,
        event.probability or HINT_PROBABILITY,
    )  # fmt: skip
