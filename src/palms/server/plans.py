"""Plans as JSON, ``palms-plan/1``, exact to the last bit; and buildings in few words."""

from __future__ import annotations

import re
import secrets
import unicodedata

import numpy as np
from pydantic import ValidationError

from palms.errors import InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.server import messages
from palms.server.limits import Limits
from palms.server.messages.base import one_line
from palms.server.store import BuildingRow

__all__ = ["check_size", "new_id", "plan_of", "plan_text", "summary"]


def plan_text(plan: FloorPlan) -> str:
    """Return a plan as ``palms-plan/1``.

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
    try:
        content = messages.Plan.model_validate_json(text)
    except ValidationError as error:
        raise one_line(error, "plan") from None
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
    return messages.Building(
        id=row.id, name=row.name, levels=tuple(levels), is_sample=row.is_sample
    )
