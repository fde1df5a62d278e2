"""Plans as JSON, ``palms-plan/1``, exact to the last bit; and buildings in few words."""

from __future__ import annotations

import re
import secrets
import unicodedata
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydantic import ValidationError

from palms.building import Building, Stairs, joined_stairs, named_stairs
from palms.errors import InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.server import messages
from palms.server.limits import Limits
from palms.server.messages.base import one_line
from palms.server.store import BuildingRow

__all__ = [
    "building_of", "check_size", "in_frame", "new_id", "place_among", "plan_of", "plan_text",
    "stairs_of", "summary",
]  # fmt: skip


def plan_text(plan: FloorPlan, stairs: Sequence[Stairs] = ()) -> str:
    """Return a plan as ``palms-plan/1``, with the stairs that its file has as such.

    Examples
    --------
    >>> plan_of(plan_text(FloorPlan([[[0, 0], [0.1, 8]]], name="hall"))).segments_m.tolist()
    [[[0.0, 0.0], [0.1, 8.0]]]
    """
    origin = plan.origin
    content = messages.Plan.model_construct(
        name=plan.name, level=plan.level, segments_m=plan.segments_m.tolist(),
        classes=[SegmentClass(kind).name.lower() for kind in plan.classes.tolist()],
        rooms=[
            messages.PlanRoom.model_construct(name=room.name, polygon_m=room.polygon_m.tolist())
            for room in plan.rooms
        ],
        stairs=[
            messages.PlanRoom.model_construct(name=each.name, polygon_m=each.polygon_m.tolist())
            for each in stairs
        ],
        outline_m=None if plan.outline_m is None else plan.outline_m.tolist(),
        origin=None if origin is None else (origin.lon_deg, origin.lat_deg),
    )  # fmt: skip
    return content.model_dump_json(by_alias=True, warnings=False)


def plan_of(text: str) -> FloorPlan:
    """Return the plan of a ``palms-plan/1`` text.

    Raises
    ------
    InputError
        When it is none.
    """
    content = _content(text)
    kinds = {kind.name.lower(): int(kind) for kind in SegmentClass}
    return FloorPlan(
        np.array(content.segments_m).reshape(-1, 2, 2),
        np.array([kinds[word] for word in content.classes], np.uint8),
        tuple(Room(room.name, np.array(room.polygon_m)) for room in content.rooms),
        None if content.outline_m is None else np.array(content.outline_m),
        content.name,
        content.level,
        None if content.origin is None else Origin(*content.origin),
    )


def _content(text: str) -> messages.Plan:
    try:
        return messages.Plan.model_validate_json(text)
    except ValidationError as error:
        raise one_line(error, "plan") from None


def stairs_of(text: str) -> tuple[Stairs, ...]:
    """Return the stairs of a ``palms-plan/1`` text, and its rooms that are called so."""
    told = [Stairs(each.name, np.array(each.polygon_m)) for each in _content(text).stairs]
    return (*told, *named_stairs(plan_of(text)))


def building_of(levels: Sequence[tuple[str, str]]) -> Building:
    """Return stored levels, from the lowest up, as a building in the frame of the lowest.

    Parameters
    ----------
    levels : sequence of (str, str)
        Name and ``palms-plan/1`` text of each.

    Examples
    --------
    >>> hall = FloorPlan([[[0, 0], [8, 0]]], name="hall")
    >>> building_of([("G", plan_text(hall)), ("1", plan_text(hall))]).names
    ('G', '1')
    """
    plans = [replace(plan_of(text), level=name) for name, text in levels]
    return Building(tuple(plans), joined_stairs([stairs_of(text) for _, text in levels]))


def in_frame(plan: FloorPlan, stairs: Sequence[Stairs], lowest: FloorPlan) -> str:
    """Return a further level as ``palms-plan/1`` in the frame of the lowest.

    Where both know their place on Earth it is moved there; else it is taken as it is.

    Raises
    ------
    InputError
        When it lies beside the lowest level.
    """
    here, there = plan.origin, lowest.origin
    if here is not None and there is not None and here != there:
        old, new = here, there

        def moved(points_m: FloatArray) -> FloatArray:
            return new.to_local(old.to_lonlat(points_m))

        plan = replace(
            plan, segments_m=moved(plan.segments_m), origin=new,
            rooms=tuple(replace(room, polygon_m=moved(room.polygon_m)) for room in plan.rooms),
            outline_m=None if plan.outline_m is None else moved(plan.outline_m),
        )  # fmt: skip
        stairs = [replace(each, polygon_m=moved(each.polygon_m)) for each in stairs]
    (low, high), (left, right) = lowest.bounds_m, plan.bounds_m
    if (right < low).any() or (left > high).any():
        raise InputError(
            f"floor plan {plan.name}", expected="one above the building's lowest level",
            got=f"one that begins at x {left[0]:.0f} m, y {left[1]:.0f} m, beside it",
            fix="shift it to the frame of the other levels",
        )  # fmt: skip
    return plan_text(plan, stairs)


def place_among(names: Sequence[str], name: str, below: str) -> int:
    """Return where a further level goes, 0 for the lowest.

    Below the level that is told, else by its number where all levels have one, else on top.

    Raises
    ------
    InputError
        When there is no level of that name.

    Examples
    --------
    >>> place_among(["-1", "0", "2"], "1", ""), place_among(["G", "1"], "B", "G")
    (2, 0)
    """
    if below:
        if below not in names:
            raise InputError("below", expected=f"one of {', '.join(names[:20])}", got=repr(below))
        return names.index(below)
    numbers = [_number(each) for each in (*names, name)]
    known = [number for number in numbers if number is not None]
    if len(known) < len(numbers):
        return len(names)
    return sum(number < known[-1] for number in known[:-1])


def _number(name: str) -> float | None:
    return float(name) if re.fullmatch(r"[-+]?\d{1,4}(\.\d{1,4})?", name.strip()) else None


def check_size(plan: FloorPlan, limits: Limits, cell_size_m: float = 0.1) -> None:
    """Refuse a plan that is larger than the server takes.

    Raises
    ------
    InputError
        When it has too many segments, or would have too many cells.
    """
    if len(plan.segments_m) > limits.plan_segments:
        raise InputError(
            f"floor plan {plan.name}", expected=f"at most {limits.plan_segments:,} segments",
            got=f"{len(plan.segments_m):,}", fix="leave out furniture and the like",
        )  # fmt: skip
    width, height = (float(v) for v in plan.size_m)
    if width * height / cell_size_m**2 > limits.plan_cells:
        raise InputError(
            f"floor plan {plan.name}",
            expected=f"at most {limits.plan_cells * cell_size_m**2:,.0f} square metres",
            got=f"{width:.4g} x {height:.4g} m", fix="cut it into parts, or check its unit",
        )  # fmt: skip


def new_id(name: str) -> str:
    """Return a new building's id: letters, digits and hyphens of its name, and four at random.

    Examples
    --------
    >>> new_id("Engineering 2, École")[:20]
    'engineering-2-ecole-'
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode().lower()
    words = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:40]
    return f"{words or 'building'}-{secrets.token_hex(2)}"


def summary(row: BuildingRow) -> messages.Building:
    """Return a building in few words."""
    levels = []
    for name, text in row.levels:
        plan = plan_of(text)
        low, high = ((float(x), float(y)) for x, y in plan.bounds_m)
        levels.append(
            messages.Level(
                name=name, n_segments=len(plan.segments_m), n_rooms=len(plan.rooms),
                bounds_m=(low, high),
            )
        )  # fmt: skip
    joined = joined_stairs([stairs_of(text) for _, text in row.levels])
    stairs = [(each.name, [(float(x), float(y)) for x, y in each.polygon_m]) for each in joined]
    return messages.Building(
        id=row.id, name=row.name, levels=tuple(levels), is_sample=row.is_sample,
        stairs=tuple(
            messages.PlanRoom(name=name, polygon_m=tuple(polygon)) for name, polygon in stairs
        ),
    )  # fmt: skip
