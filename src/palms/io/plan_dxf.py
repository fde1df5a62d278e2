"""Floor plans from DXF drawings: lines on layers whose names say wall, door or glass.

A door drawn as a leaf with its swing becomes the segment that the leaf fills when shut.
"""

from __future__ import annotations

import io
import math
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray
from palms.io.files import head, read_bytes, sniff
from palms.io.plan_csv import plan_name
from palms.io.plan_parts import PlanParts, check_scale, middle_line, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating

__all__ = ["FORMAT", "read_plan_dxf"]

_WALLS = r"wall|mur|wand|muro|parete|column|pillar|stütze|poteau"
_DOORS = r"door|tuer|tür|porte|puerta|porta"
_GLASS = r"glaz|glass|window|fenster|fenetre|fenêtre|ventana|curtain"
_OPENINGS = r"opening|passage|durchgang"
_ROOMS = r"room|raum|space|zone|a-area|pièce|piece"
_METRES = {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0, 8: 2.54e-8,
    9: 2.54e-5, 10: 0.9144, 11: 1e-10, 12: 1e-9, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0,
}  # fmt: skip  # $INSUNITS of the DXF reference
_SAGITTA_M = 0.01  # ours: how far an arc may be from its chords
_DEPTH = 8  # ours: of blocks in blocks
_MAX_ENTITIES = 500_000  # ours
_TOUCH_M = 0.06  # ours: a leaf's end and its swing's meet
_SWING = (math.radians(30), math.radians(135))  # ours: a door's swing
_REACH_M = 0.15  # ours: a door's line may lie that far from the wall's
_DRAWN = {"LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "MLINE"}


@dataclass
class _Group:
    """What one door block, or all loose lines of the door layers, is drawn with."""

    lines: list[FloatArray] = field(default_factory=list)
    swings: list[FloatArray] = field(default_factory=list)  # centre, two ends


def read_plan_dxf(  # noqa: PLR0913
    path: StrPath,
    *,
    scale: float | None = None,
    walls: str = _WALLS,
    doors: str = _DOORS,
    glass: str = _GLASS,
    openings: str = _OPENINGS,
    rooms: str = _ROOMS,
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
    drawing = _Drawing(_compiled(patterns | {None: rooms}, path), unit, str(path))
    try:
        drawing.take(document.modelspace(), None, _DEPTH, None)
    except (InputError, MemoryError, RecursionError):
        raise
    except Exception as error:  # ezdxf raises many kinds for damaged entities
        raise FormatError(
            str(path), expected="a whole DXF drawing", got=brief(str(error), 60)
        ) from None
    return drawing.plan(path)


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


def _compiled(patterns: dict[SegmentClass | None, str], path: StrPath) -> Any:  # noqa: ANN401
    try:
        return {kind: re.compile(text, re.IGNORECASE) for kind, text in patterns.items() if text}
    except re.error as error:
        raise InputError(
            f"{path}, option", expected="a regular expression", got=str(error)
        ) from None


class _Drawing:
    """Gathers the entities of a drawing by what their layer says."""

    def __init__(self, patterns: Any, unit_m: float, what: str) -> None:  # noqa: ANN401
        self.patterns, self.unit_m, self.what = patterns, unit_m, what
        self.parts = PlanParts()
        self.layers: Counter[str] = Counter()
        self.loose = _Group()
        self.groups = [self.loose]
        self.texts: list[tuple[str, FloatArray]] = []
        self.rings: list[FloatArray] = []
        self.taken = 0

    def take(self, entities: Any, parent: str | None, depth: int, group: _Group | None) -> None:  # noqa: ANN401
        """Take entities, those of blocks too; on layer 0 a block's parts are on the block's."""
        for entity in entities:
            self.taken += 1
            if self.taken > _MAX_ENTITIES:
                raise FormatError(
                    self.what, expected=f"at most {_MAX_ENTITIES:,} entities", got="more",
                    fix="export the layers of walls and doors alone",
                )  # fmt: skip
            own = str(entity.dxf.get("layer", "0"))
            layer = parent if parent and (own == "0" or self._role(own) is None) else own
            kind = entity.dxftype()
            if kind == "INSERT" and depth:
                self._insert(entity, layer, depth, group)
            elif kind in ("TEXT", "MTEXT"):
                self._text(entity)
            elif kind in _DRAWN:
                self._line(entity, layer, group)

    def _insert(self, entity: Any, layer: str, depth: int, group: _Group | None) -> None:  # noqa: ANN401
        if entity.mcount > 10_000:
            raise FormatError(self.what, expected="at most 10,000 copies", got=str(entity.mcount))
        name = str(entity.dxf.get("name", ""))
        said = name if self._role(name) is not None and self._role(layer) is None else layer
        inner = group
        if group is None and self._role(said) is SegmentClass.DOOR:
            inner = _Group()
            self.groups.append(inner)
        copies = entity.multi_insert() if entity.mcount > 1 else [entity]
        for copy in copies:
            self.take(copy.virtual_entities(), said, depth - 1, inner)

    def _role(self, layer: str) -> SegmentClass | None:
        for kind, pattern in self.patterns.items():
            if kind is not None and pattern.search(layer):
                return kind  # type: ignore[no-any-return]
        return None

    def _text(self, entity: Any) -> None:  # noqa: ANN401
        plain = entity.plain_text() if entity.dxftype() == "MTEXT" else entity.dxf.text
        at = entity.dxf.insert
        if str(plain).strip():
            words = " ".join(str(plain).split())
            self.texts.append((words, np.array([at.x, at.y]) * self.unit_m))

    def _line(self, entity: Any, layer: str, group: _Group | None) -> None:  # noqa: ANN401
        self.layers[layer] += 1
        kind = self._role(layer)
        rooms = self.patterns.get(None)
        room = kind is None and rooms is not None and rooms.search(layer)
        if kind is None and not room:
            return
        for points in self._flat(entity):
            if room:
                if len(points) > 3 and np.allclose(points[0], points[-1]):
                    self.rings.append(points[:-1])
            elif kind is SegmentClass.DOOR:
                self._door(entity, points, group or self.loose)
            elif kind is not None:
                ring = len(points) > 4 and np.allclose(points[0], points[-1])
                middle = middle_line(points) if ring and kind is not SegmentClass.WALL else None
                self.parts.add(segments_along(points) if middle is None else middle, kind)

    def _flat(self, entity: Any) -> Iterator[FloatArray]:  # noqa: ANN401
        from ezdxf.path import make_path

        if entity.dxftype() == "MLINE":
            for each in entity.virtual_entities():
                yield from self._flat(each)
            return
        try:
            path = make_path(entity)
            points = np.array([[p.x, p.y] for p in path.flattening(_SAGITTA_M / self.unit_m)])
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            return  # an entity without extent, or of a kind without a line
        if len(points) > 1 and np.isfinite(points).all():
            yield points * self.unit_m

    def _door(self, entity: Any, points: FloatArray, group: _Group) -> None:  # noqa: ANN401
        if entity.dxftype() == "ARC":
            sweep = math.radians((entity.dxf.end_angle - entity.dxf.start_angle) % 360)
            if _SWING[0] <= sweep <= _SWING[1]:
                centre = entity.ocs().to_wcs(entity.dxf.center)
                hinge = np.array([centre.x, centre.y]) * self.unit_m
                group.swings.append(np.array([hinge, points[0], points[-1]]))
                return
        group.lines.append(points)

    def plan(self, path: StrPath) -> FloorPlan:
        """Return the plan of what was taken."""
        if not len(self.parts.of_class(SegmentClass.WALL, SegmentClass.GLASS)):
            listed = ", ".join(f"{name} ({n})" for name, n in self.layers.most_common(12))
            raise InputError(
                str(path), expected="lines on a layer of walls", got=listed or "no lines at all",
                fix="name the layers with the option walls=PATTERN",
            )  # fmt: skip
        for group in self.groups:
            for door in _doors(group):
                self.parts.add(door, SegmentClass.DOOR)
        self.parts.cut_doors(_REACH_M)
        self._name_rooms()
        skipped = sum(n for name, n in self.layers.items() if self._role(name) is None)
        if skipped > sum(self.layers.values()) / 2:
            names = ", ".join(n for n, _ in self.layers.most_common() if self._role(n) is None)
            warnings.warn(
                f"{path}: {skipped} lines on layers {brief(names, 80)} are left out",
                PalmsWarning,
                stacklevel=3,
            )
        return self.parts.build(path, plan_name(path))

    def _name_rooms(self) -> None:
        import shapely

        for ring in self.rings:
            area = shapely.Polygon(ring)
            inside = [text for text, at in self.texts if shapely.contains_xy(area, *at)]
            if inside:
                with locating(self.what):
                    self.parts.rooms.append(Room(" ".join(inside[:3]), ring))


def _doors(group: _Group) -> Iterator[FloatArray]:
    """Yield the segments (N, 2, 2) that doors fill when they are shut."""
    swings = group.swings
    for swing in swings:
        leaf = [min((_nearest(line, end) for line in group.lines), default=math.inf)
                for end in swing[1:]]  # fmt: skip
        shut = swing[1] if leaf[1] <= leaf[0] else swing[2]
        yield np.array([[swing[0], shut]])
    for line in group.lines:
        if any(_nearest(line, swing[0]) <= _TOUCH_M for swing in swings):
            continue  # the leaf of a swing
        ring = len(line) > 4 and np.allclose(line[0], line[-1])
        middle = middle_line(line) if ring else None
        yield segments_along(line) if middle is None else middle


def _nearest(points: FloatArray, to: FloatArray) -> float:
    return float(np.hypot(*(points - to).T).min())


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
