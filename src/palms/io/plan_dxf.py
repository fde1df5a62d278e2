"""Floor plans from DXF drawings: lines on layers whose names say wall, door or glass.

A door drawn as a leaf with its swing becomes the segment that the leaf fills when shut.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray
from palms.io.files import head, read_bytes, sniff
from palms.io.plan_csv import plan_name
from palms.io.plan_drawing import (
    DOORS,
    GLASS,
    OPENINGS,
    ROOMS,
    WALLS,
    DoorGroup,
    Drawing,
    Layers,
    Stroke,
)
from palms.io.plan_parts import check_scale
from palms.io.registry import Format
from palms.io.values import StrPath, brief

__all__ = ["FORMAT", "read_plan_dxf"]

_METRES = {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0, 8: 2.54e-8,
    9: 2.54e-5, 10: 0.9144, 11: 1e-10, 12: 1e-9, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0,
}  # fmt: skip  # $INSUNITS of the DXF reference
_SAGITTA_M = 0.01  # ours: how far an arc may be from its chords
_DEPTH = 8  # ours: of blocks in blocks
_MAX_ENTITIES = 500_000  # ours
_DRAWN = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "MLINE"}


def read_plan_dxf(  # noqa: PLR0913
    path: StrPath,
    *,
    scale: float | None = None,
    walls: str = WALLS,
    doors: str = DOORS,
    glass: str = GLASS,
    openings: str = OPENINGS,
    rooms: str = ROOMS,
) -> FloorPlan:
    """Read a floor plan from a DXF drawing.

    Parameters
    ----------
    path : path
    scale : float, optional
        Metres of one unit; from the drawing's $INSUNITS when left out.
    walls, doors, glass, openings, rooms : str
        Patterns, as regular expressions, of the layers or blocks of each; upper and lower case
        are one. A closed polyline on a layer of rooms is a room, named by the text in it.

    Raises
    ------
    InputError
        When it cannot be read, no layer matches, or its unit is not known.
    """
    content = read_bytes(path)
    _check_kind(content, path)
    document = _load(content, path)
    unit = check_scale(scale, f"{path}, option scale") or _unit(document, path)
    patterns = {
        SegmentClass.DOOR: doors, SegmentClass.OPENING: openings, SegmentClass.GLASS: glass,
        SegmentClass.WALL: walls,
    }  # fmt: skip
    entities = _Entities(Layers(patterns | {None: rooms}, str(path)), unit, str(path))
    try:
        entities.take(document.modelspace(), None, _DEPTH, None)
    except (InputError, MemoryError, RecursionError):
        raise
    except Exception as error:  # ezdxf raises many kinds for damaged entities
        raise FormatError(
            str(path), expected="a whole DXF drawing", got=brief(str(error), 60)
        ) from None
    asked = "name the layers with the option walls=PATTERN"
    return entities.drawing.plan(path, plan_name(path), asked)


def _check_kind(content: bytes, path: StrPath) -> None:
    if content[:4] == b"AC10":
        raise FormatError(
            str(path), expected="a DXF drawing", got="a DWG drawing", fix="save it as DXF"
        )
    if not content.strip():
        raise FormatError(str(path), expected="a DXF drawing", got="an empty file")
    if not _looks_like_dxf(content[:65_536]):
        raise FormatError(
            str(path), expected="a DXF drawing", got=sniff(content[:1000]),
            fix="check that it is the right file",
        )  # fmt: skip


def _load(content: bytes, path: StrPath) -> Any:  # noqa: ANN401
    import logging

    from ezdxf import recover

    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    try:
        document, _ = recover.read(io.BytesIO(content))
    except MemoryError:
        raise
    except Exception as error:  # damaged drawings raise anything
        raise FormatError(
            str(path),
            expected="a whole DXF drawing",
            got=brief(str(error), 60),
            fix="save it again, as DXF of any version",
        ) from None
    return document


def _unit(document: Any, path: StrPath) -> float:  # noqa: ANN401
    code = document.header.get("$INSUNITS", 0)
    if code not in _METRES:
        raise InputError(
            str(path), expected="its unit", got=f"$INSUNITS {code}, which says none",
            fix="give the option scale=METRES of a unit, as scale=0.001 for millimetres",
        )  # fmt: skip
    return _METRES[code]


class _Entities:
    """Puts the entities of a drawing where their layer says that they belong."""

    def __init__(self, layers: Layers, unit_m: float, what: str) -> None:
        self.layers, self.unit_m, self.what = layers, unit_m, what
        self.drawing = Drawing(what)
        self.taken = 0

    def take(self, entities: Any, parent: str | None, depth: int, group: DoorGroup | None) -> None:  # noqa: ANN401
        """Take entities, those of blocks too; on layer 0 a block's parts are on the block's."""
        for entity in entities:
            self.taken += 1
            if self.taken > _MAX_ENTITIES:
                raise FormatError(
                    self.what, expected=f"at most {_MAX_ENTITIES:,} entities", got="more",
                    fix="export the layers of walls and doors alone",
                )  # fmt: skip
            own = str(entity.dxf.get("layer", "0"))
            unsaid = own == "0" or self.layers.role(own) is None
            layer = parent if parent and unsaid else own
            kind = entity.dxftype()
            if kind == "INSERT" and depth:
                self._insert(entity, layer, depth, group)
            elif kind in ("TEXT", "MTEXT"):
                self._text(entity)
            elif kind in _DRAWN:
                self._line(entity, layer, group)

    def _insert(self, entity: Any, layer: str, depth: int, group: DoorGroup | None) -> None:  # noqa: ANN401
        if entity.mcount > 10_000:
            raise FormatError(self.what, expected="at most 10,000 copies", got=str(entity.mcount))
        name = str(entity.dxf.get("name", ""))
        by_name = self.layers.role(name) is not None and self.layers.role(layer) is None
        said = name if by_name else layer
        if group is None and self.layers.role(said) is SegmentClass.DOOR:
            group = self.drawing.new_group()
        copies = entity.multi_insert() if entity.mcount > 1 else [entity]
        for copy in copies:
            self.take(copy.virtual_entities(), said, depth - 1, group)

    def _text(self, entity: Any) -> None:  # noqa: ANN401
        plain = entity.plain_text() if entity.dxftype() == "MTEXT" else entity.dxf.text
        at = entity.dxf.insert
        if str(plain).strip():
            words = " ".join(str(plain).split())
            self.drawing.texts.append((words, np.array([at.x, at.y]) * self.unit_m))

    def _line(self, entity: Any, layer: str, group: DoorGroup | None) -> None:  # noqa: ANN401
        self.drawing.counted[layer] += 1
        role = self.layers.role(layer)
        if role is None:
            self.drawing.left_out[layer] += 1
            if not self.layers.holds_rooms(layer):
                return
        for points in self._flat(entity):
            if role is None:
                self.drawing.add_room(points)
            else:
                self.drawing.add(Stroke(points, entity.dxftype() == "ARC"), role, group)

    def _flat(self, entity: Any) -> Iterator[FloatArray]:  # noqa: ANN401
        from ezdxf.path import make_path

        if entity.dxftype() == "MLINE":
            for each in entity.virtual_entities():
                yield from self._flat(each)
            return
        try:
            exact = entity.dxftype() == "ARC"  # whose path is a cubic curve, near it only
            path = entity if exact else make_path(entity)
            points = np.array([[p.x, p.y] for p in path.flattening(_SAGITTA_M / self.unit_m)])
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            return  # an entity without extent, or of a kind without a line
        if len(points) > 1 and np.isfinite(points).all():
            yield points * self.unit_m


def _looks_like_dxf(start: bytes) -> bool:
    if start.startswith(b"AutoCAD Binary DXF"):
        return True
    lines: Sequence[bytes] = [line.strip() for line in start[:4000].splitlines()]
    while lines[:1] == [b"999"]:
        lines = lines[2:]
    return lines[:2] == [b"0", b"SECTION"]


def _recognizes(path: Path) -> bool:
    start = head(path)
    return _looks_like_dxf(start) or start[:4] == b"AC10"


FORMAT = Format(
    name="dxf",
    description="CAD drawing: layers of walls, doors and glass",
    suffixes=(".dxf",),
    recognizes=_recognizes,
    read=read_plan_dxf,
    extra="dxf",
)
