"""Floor plans from IFC, building information models: one storey, cut at the height of a scan.

Walls are drawn with their thickness, as a scanner sees them: both faces. Doors and windows are
segments in the middle of the wall.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from palms.errors import FormatError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray, rotate
from palms.io.apart import require, run_apart
from palms.io.files import head, read_bytes, sniff
from palms.io.ifc_storey import Ring, Storey
from palms.io.levels import LevelPlan, gather_levels
from palms.io.options import number_option
from palms.io.plan_csv import plan_name
from palms.io.plan_parts import PlanParts, check_scale, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, locating

__all__ = ["FORMAT", "read_levels_ifc", "read_plan_ifc"]

_KIND = "an IFC model"
_START, _END = b"ISO-10303-21", b"END-ISO-10303-21"
_FRAME = Literal["model", "earth"]
_GAP_M = 0.01  # ours: walls that stand that near to each other touch
_FINE_M = 0.002  # ours: corners that near to a line are on it
_REACH_M = 0.3  # ours: half of the thickest wall that a door stands in
_TURNED_RAD = math.radians(0.1)  # ours: less is no turn


def read_plan_ifc(
    path: StrPath,
    *,
    level: str | None = None,
    height: float = 1.2,
    frame: _FRAME = "model",
    scale: float = 1.0,
) -> FloorPlan:
    """Read one storey of a building from an IFC model.

    Parameters
    ----------
    path : path
        The .ifc file, of version 2x3, 4 or 4.3.
    level : str, optional
        Name, number or GlobalId of the storey; needed where several have walls. Number 0 is the
        lowest that is not below the ground.
    height : float
        Of the cut above the storey's floor, in metres.
    frame : {"model", "earth"}
        Whose x and y: the model's, or east and north. Where the model's y is north, or with
        "earth", the plan knows its place on Earth, if the site says it.
    scale : float
        Metres of what the model takes for one, where its unit is wrong.

    Raises
    ------
    InputError
        When it cannot be read, or the storey is not named and there are several; the message
        lists them.
    """
    (storey,) = _storeys(path, level, (height, scale), every=False)
    return _plan(storey, path, frame, scale)


def read_levels_ifc(
    path: StrPath,
    *,
    height: float = 1.2,
    frame: _FRAME = "model",
    scale: float = 1.0,
) -> tuple[LevelPlan, ...]:
    """Read all storeys that have walls, in one frame.

    Parameters
    ----------
    path, height, frame, scale
        As in `read_plan_ifc`.

    Returns
    -------
    tuple of LevelPlan
        From the lowest up; number 0 is the lowest that is not below the ground.

    Raises
    ------
    InputError
        When it cannot be read, or has no storey with walls.
    """
    return gather_levels(
        (each.name, float(each.number), functools.partial(_alone, each, path, frame, scale))
        for each in _storeys(path, None, (height, scale), every=True)
    )


def _alone(
    storey: Storey, path: StrPath, frame: _FRAME, scale: float
) -> tuple[FloorPlan, tuple[()]]:
    """Return the plan of a storey; its stairs are those of its rooms that are called so."""
    return _plan(storey, path, frame, scale), ()


def _storeys(
    path: StrPath, level: str | None, cut: tuple[float, float], every: bool
) -> list[Storey]:
    """Cut one storey or all; the height of the cut is in metres, its scale those of a unit."""
    height, scale = cut
    number_option(height, "height", 0.1, 3.0)
    check_scale(scale, f"{path}, option scale")
    content = read_bytes(path)
    if not content.lstrip().startswith(_START):
        got = sniff(content[:1000]) if content.strip() else "an empty file"
        raise FormatError(str(path), expected=_KIND, got=got, fix="check that it is the right file")
    if _END not in content[-4096:]:
        raise FormatError(
            str(path), expected="a whole IFC model", got="one without its end",
            fix="it may be cut off; export or download it again",
        )  # fmt: skip
    del content
    require("ifcopenshell")
    arguments = (str(path), level, height / scale, every)
    found: list[Storey] = run_apart("palms.io.ifc_storey:load_storeys", arguments, path, _KIND)
    if not found:
        raise FormatError(str(path), expected="a storey with walls", got="none")
    return found


def _plan(storey: Storey, path: StrPath, frame: _FRAME, scale: float) -> FloorPlan:
    turn_rad = math.pi / 2 - math.atan2(storey.north[1], storey.north[0])
    to_earth = frame == "earth" or abs(math.remainder(turn_rad, 2 * math.pi)) < _TURNED_RAD
    with locating(path):
        place = Origin(*storey.place) if storey.place is not None and to_earth else None
        parts = _parts(storey, turn_rad if frame == "earth" else 0.0, scale)
    return parts.build(path, storey.building or plan_name(path), storey.name or None, place)


def _parts(storey: Storey, turn_rad: float, scale: float) -> PlanParts:
    parts = PlanParts()

    def place(points: FloatArray) -> FloatArray:
        return rotate(points * scale, turn_rad)

    walls = (
        (SegmentClass.WALL, _outlines(storey.solids)),
        (SegmentClass.GLASS, _outlines(storey.glass)),
        (SegmentClass.GLASS, [_middle(box) for box in storey.windows]),
        (SegmentClass.DOOR, [_middle(box) for box in storey.doors]),
        (SegmentClass.OPENING, [_middle(box) for box in storey.openings]),
    )
    for kind, lines in walls:
        for line in lines:
            parts.add(segments_along(place(line)), kind)
    parts.cut_doors(_REACH_M)
    parts.rooms = [Room(name, place(ring[:-1])) for name, ring in storey.spaces
                   if len(ring) > 3]  # fmt: skip
    return parts


def _outlines(rings: Sequence[Ring]) -> list[FloatArray]:
    """Return the outlines of solids that touch, as one; and cuts that are not closed."""
    import shapely

    closed = [len(ring) > 3 and np.allclose(ring[0], ring[-1]) for ring in rings]
    areas = [
        shapely.make_valid(shapely.Polygon(ring)).buffer(_GAP_M / 2, join_style="mitre")
        for ring, whole in zip(rings, closed, strict=True) if whole
    ]  # fmt: skip
    together = shapely.union_all(areas).buffer(-_GAP_M / 2, join_style="mitre")
    boundary = shapely.get_parts(together.boundary)
    return [
        *(shapely.get_coordinates(each.simplify(_FINE_M)) for each in boundary),
        *(ring for ring, whole in zip(rings, closed, strict=True) if not whole),
    ]


def _middle(box: FloatArray) -> FloatArray:
    """Return the line (2, 2) along the middle of a box, between its shorter sides."""
    a, b, c, d = box
    if math.dist(a, b) < math.dist(b, c):
        a, b, c, d = b, c, d, a
    return np.array([(a + d) / 2, (b + c) / 2])


def _recognizes(path: Path) -> bool:
    start = head(path)
    return start.lstrip().startswith(_START) and b"IFC" in start


FORMAT = Format(
    name="ifc",
    description="building information model: one storey, cut at 1.2 m",
    suffixes=(".ifc",),
    recognizes=_recognizes,
    read=read_plan_ifc,
    read_levels=read_levels_ifc,
    extra="ifc",
)
