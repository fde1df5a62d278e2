"""One storey of an IFC model, cut at the height of a scan: outlines of what stands there.

Runs in a process of its own (`palms.io.apart`), since models may be damaged.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.geometry import FloatArray
from palms.io.values import brief

__all__ = ["Ring", "Storey", "load_storeys"]

_SOLIDS = ("IfcWall", "IfcColumn", "IfcCurtainWall", "IfcPlate", "IfcMember")
_FILLINGS = ("IfcDoor", "IfcWindow")
_GLASS = ("IfcCurtainWall", "IfcPlate", "IfcMember")
_OFF_M = 0.00137  # ours: no sill or lintel lies there, so that cuts run through no corner
_FOOT_M = 0.3  # ours: an opening that begins higher is no passage
_WELD_M = 1e-4  # ours: ends of cuts that near are one
_MOST_PRODUCTS = 200_000  # ours
_LARGEST_M = 1e6  # ours: places beyond are damage

Ring = FloatArray  # (N, 2), closed


class Product(NamedTuple):
    """Something with a shape: its type, the rings of the cut, and its footprint."""

    kind: str
    rings: list[Ring]
    footprint: FloatArray  # corners (4, 2) of the smallest turned box; empty when not at the cut
    hull: FloatArray  # (N, 2) of all its points
    low_m: float


class Storey(NamedTuple):
    """What stands in a storey at the height of the cut, in metres of the model.

    Parameters
    ----------
    name, building : str
    number : int
        Counted from the lowest above the ground.
    solids, glass : list of Ring
        Outlines of walls and columns, and of curtain walls.
    doors, windows, openings : list of ndarray (4, 2)
        Smallest boxes around them.
    spaces : list of (str, Ring)
        Names and outlines of rooms.
    north : (float, float)
        The direction of true north in the model.
    place : (float, float) or None
        Longitude and latitude of the model's origin, where the site says it.
    """

    name: str
    building: str
    number: int
    solids: list[Ring]
    glass: list[Ring]
    doors: list[FloatArray]
    windows: list[FloatArray]
    openings: list[FloatArray]
    spaces: list[tuple[str, Ring]]
    north: tuple[float, float]
    place: tuple[float, float] | None


def load_storeys(path: str, wanted: str | None, height_m: float, every: bool) -> list[Storey]:
    """Cut a storey of a model, or every one that has walls, from the lowest up.

    Parameters
    ----------
    path : str
    wanted : str, optional
        Name, number counted from the lowest above the ground, or GlobalId of the storey; needed
        where several have walls and not every one is wanted.
    height_m : float
        Of the cut above the storey's floor.
    every : bool
        Whether to cut all storeys with walls.

    Raises
    ------
    InputError
        When it is no IFC model, or the storey is not named; the message lists them.
    """
    import ifcopenshell

    try:
        model = ifcopenshell.open(path)
        found = _Model(model, path)
        chosen = found.with_walls() if every else [found.choose(wanted)]
        return [found.storey(index, height_m) for index in chosen]
    except (InputError, ImportError, MemoryError):
        raise
    except Exception as error:  # the library raises many kinds for damaged models
        raise FormatError(
            path, expected="a whole IFC model", got=brief(str(error), 60),
            fix="it may be damaged; export it again",
        ) from None  # fmt: skip


class _Model:
    """Finds storeys and what stands in them."""

    def __init__(self, model: Any, what: str) -> None:  # noqa: ANN401
        from ifcopenshell.util.unit import calculate_unit_scale

        self.model, self.what = model, what
        self.unit_m = float(calculate_unit_scale(model))
        self.storeys = sorted(
            ((self._elevation_m(each), each) for each in model.by_type("IfcBuildingStorey")),
            key=lambda found: found[0],
        )

    def _elevation_m(self, storey: Any) -> float:  # noqa: ANN401
        from ifcopenshell.util.placement import get_local_placement

        if storey.ObjectPlacement is not None:
            return float(get_local_placement(storey.ObjectPlacement)[2][3]) * self.unit_m
        return float(storey.Elevation or 0.0) * self.unit_m

    def storey(self, index: int, height_m: float) -> Storey:
        """Cut a storey."""
        floor_m, storey = self.storeys[index]
        found = list(self._products(self._standing(floor_m), floor_m + height_m + _OFF_M))
        solids = [each for each in found if each.kind not in (*_FILLINGS, *_GLASS)]
        fillings = {
            kind: [each.footprint for each in found if each.kind == kind and len(each.footprint)]
            for kind in _FILLINGS
        }
        return Storey(
            name=_text(storey.Name) or _text(storey.LongName),
            number=index - self._ground(),
            building=next((_text(b.Name) for b in self.model.by_type("IfcBuilding")), ""),
            solids=[ring for each in solids for ring in each.rings],
            glass=[ring for each in found if each.kind in _GLASS for ring in each.rings],
            doors=fillings["IfcDoor"], windows=fillings["IfcWindow"],
            openings=list(self._openings(found, floor_m, height_m)),
            spaces=list(self._spaces(storey, floor_m + height_m + _OFF_M)),
            north=self._north(), place=self._place(),
        )  # fmt: skip

    def _ground(self) -> int:
        """How many storeys lie below the ground."""
        return sum(elevation < -_FOOT_M for elevation, _ in self.storeys)

    def with_walls(self) -> list[int]:
        """Which storeys have walls of their own."""
        if not self.storeys:
            raise FormatError(self.what, expected="a model with storeys", got="none")
        return [i for i, (_, storey) in enumerate(self.storeys) if self._has_walls(storey)]

    def choose(self, wanted: str | None) -> int:
        """Return which storey was asked for, or the only one with walls."""
        with_walls, ground = self.with_walls(), self._ground()
        names = {
            i: {_text(s.Name), _text(s.LongName), s.GlobalId, str(i - ground)} - {""}
            for i, (_, s) in enumerate(self.storeys)
        }
        fitting = [i for i in names if wanted in names[i]] if wanted is not None else with_walls
        if len(fitting) == 1:
            return fitting[0]
        listed = "; ".join(
            f"{_text(s.Name) or 'no name'} (number {i - ground}, at {elevation:.2f} m, "
            f"id {s.GlobalId})"
            for i, (elevation, s) in enumerate(self.storeys[:50])
        )
        raise InputError(
            f"{self.what}, option level", expected=f"one of {listed}",
            got=f"{len(fitting)} storeys with walls" if wanted is None else brief(wanted),
            fix="choose with the option level=NAME, number or id",
        )  # fmt: skip

    def _has_walls(self, storey: Any) -> bool:  # noqa: ANN401
        return any(
            each.is_a("IfcWall") or each.is_a("IfcCurtainWall")
            for relation in storey.ContainsElements for each in relation.RelatedElements
        )  # fmt: skip

    def _standing(self, floor_m: float) -> list[Any]:
        """Return what may reach the cut: all but what storeys above hold."""
        above = {
            each.id()
            for elevation, storey in self.storeys if elevation > floor_m + _FOOT_M
            for relation in storey.ContainsElements for each in relation.RelatedElements
        }  # fmt: skip
        found = [
            each for kind in (*_SOLIDS, *_FILLINGS) for each in self.model.by_type(kind)
            if each.id() not in above and each.Representation is not None
        ]  # fmt: skip
        if len(found) > _MOST_PRODUCTS:
            raise FormatError(
                self.what, expected=f"at most {_MOST_PRODUCTS:,} walls, doors and windows",
                got=f"{len(found):,}", fix="export the building alone",
            )  # fmt: skip
        return found

    def _products(self, elements: Sequence[Any], cut_m: float) -> Iterator[Product]:
        """Yield those elements that the cut meets."""
        for element, corners, triangles in self._meshes(elements):
            heights = corners[:, 2]
            if heights.min() < cut_m < heights.max():
                kind = next(k for k in (*_SOLIDS, *_FILLINGS, "IfcSpace", "IfcOpeningElement")
                            if element.is_a(k))  # fmt: skip
                yield _product(kind, corners, triangles, cut_m)

    def _meshes(self, elements: Sequence[Any]) -> Iterator[tuple[Any, FloatArray, Any]]:
        """Yield elements with corners (N, 3) in metres and triangles (M, 3)."""
        import ifcopenshell.geom

        if not elements:
            return
        geometry: Any = ifcopenshell.geom  # half of it has types
        settings = geometry.settings()
        settings.set("use-world-coords", True)
        shapes = geometry.iterator(settings, self.model, 1, include=list(elements))
        if not shapes.initialize():
            return
        while True:
            shape = shapes.get()
            corners = np.array(shape.geometry.verts, dtype=np.float64).reshape(-1, 3)
            triangles = np.array(shape.geometry.faces, dtype=np.int64).reshape(-1, 3)
            if len(triangles) and (np.abs(corners) < _LARGEST_M).all():
                yield self.model.by_id(shape.id), corners, triangles
            if not shapes.next():
                return

    def _openings(
        self, found: Sequence[Product], floor_m: float, height_m: float
    ) -> Iterator[FloatArray]:
        """Yield the boxes of passages that nothing fills: opening and wall together."""
        import shapely

        free = [each for each in self.model.by_type("IfcOpeningElement")
                if not each.HasFillings and each.VoidsElements]  # fmt: skip
        hosts = [each.VoidsElements[0].RelatingBuildingElement for each in free]
        hulls = {
            host.id(): shapely.convex_hull(shapely.MultiPoint(corners[:, :2]))
            for host, corners, _ in self._meshes(hosts)
        }
        for element, corners, triangles in self._meshes(free):
            low, cut_m = corners[:, 2].min(), floor_m + height_m + _OFF_M
            if not low < cut_m < corners[:, 2].max() or low > floor_m + _FOOT_M:
                continue
            box = _product("IfcOpeningElement", corners, triangles, cut_m).hull
            host = hulls.get(element.VoidsElements[0].RelatingBuildingElement.id())
            both = shapely.convex_hull(shapely.MultiPoint(box))
            if host is not None:
                both = both.intersection(host)
            if both.geom_type == "Polygon" and not both.is_empty:
                yield _box(shapely.get_coordinates(both))

    def _spaces(self, storey: Any, cut_m: float) -> Iterator[tuple[str, Ring]]:  # noqa: ANN401
        spaces = [
            each for relation in storey.IsDecomposedBy for each in relation.RelatedObjects
            if each.is_a("IfcSpace") and each.Representation is not None
        ]  # fmt: skip
        for space, corners, triangles in self._meshes(spaces):
            rings = _rings(_cut(corners, triangles, cut_m))
            words = dict.fromkeys(filter(None, (_text(space.LongName), _text(space.Name))))
            if rings and words:
                yield " ".join(words), max(rings, key=len)

    def _north(self) -> tuple[float, float]:
        for context in self.model.by_type("IfcGeometricRepresentationContext"):
            north = getattr(context, "TrueNorth", None)
            if north is not None and len(north.DirectionRatios) >= 2:
                x, y = (float(v) for v in north.DirectionRatios[:2])
                length = math.hypot(x, y)
                if length > 0 and math.isfinite(length):
                    return x / length, y / length
        return 0.0, 1.0

    def _place(self) -> tuple[float, float] | None:
        for site in self.model.by_type("IfcSite"):
            if site.RefLongitude and site.RefLatitude:
                return _degrees(site.RefLongitude), _degrees(site.RefLatitude)
        return None


def _text(value: object) -> str:
    return value.strip() if isinstance(value, str) else ""


def _degrees(parts: Sequence[int]) -> float:
    """Return degrees, minutes, seconds and their millionths as degrees."""
    scales = (1.0, 1 / 60, 1 / 3600, 1 / 3.6e9)
    return float(sum(part * scale for part, scale in zip(parts, scales, strict=False)))


def _product(kind: str, corners: FloatArray, triangles: Any, cut_m: float) -> Product:  # noqa: ANN401
    rings = _rings(_cut(corners, triangles, cut_m))
    box = _box(corners[:, :2])
    return Product(kind, rings, box, corners[:, :2], float(corners[:, 2].min()))


def _box(points: FloatArray) -> FloatArray:
    """Return the corners (4, 2) of the smallest turned box around points; none for a line."""
    import shapely

    box = shapely.minimum_rotated_rectangle(shapely.MultiPoint(points))
    if box.geom_type != "Polygon":
        return np.empty((0, 2))
    return np.asarray(shapely.get_coordinates(box)[:4])


def _cut(corners: FloatArray, triangles: Any, cut_m: float) -> FloatArray:  # noqa: ANN401
    """Return the segments (N, 2, 2) where a level plane cuts triangles."""
    above = corners[:, 2] > cut_m
    inside = triangles[np.ptp(above[triangles].astype(int), axis=1) > 0]
    segments = np.empty((len(inside), 2, 2))
    lonely = above[inside].sum(axis=1) == 1  # one corner above, else one below
    apex = np.where(above[inside] == lonely[:, None], np.arange(3), 0).max(axis=1)
    for side in (1, 2):
        rows = np.arange(len(inside))
        a, b = corners[inside[rows, apex]], corners[inside[rows, (apex + side) % 3]]
        share = (cut_m - a[:, 2]) / (b[:, 2] - a[:, 2])
        segments[:, side - 1] = (a + share[:, None] * (b - a))[:, :2]
    return segments


def _rings(segments: FloatArray) -> list[Ring]:
    """Join cuts of triangles to closed rings; what stays open is left as it is, if long."""
    import shapely

    if not len(segments):
        return []
    lines = shapely.linestrings(np.round(segments / _WELD_M) * _WELD_M)
    long = lines[shapely.length(lines) > 0]
    joined = shapely.line_merge(shapely.union_all(long))
    parts: Iterable[Any] = shapely.get_parts(joined)
    simple = [shapely.simplify(each, _WELD_M) for each in parts if each.geom_type == "LineString"]
    return [np.asarray(shapely.get_coordinates(each)) for each in simple if each.length > 0]
