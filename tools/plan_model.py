"""A floor as a building information model, IFC, for the tests."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from palms import FloorPlan, SegmentClass

WALL_M = 0.004  # thickness of the model's walls, so that both faces lie on the plan's line
STOREY_M, DOOR_M, LEVEL_M = 3.0, 2.1, 3.5


class IfcModel:
    """The lines of an IFC file, numbered as they come; the same text is there once."""

    def __init__(self) -> None:
        self.lines: dict[str, int] = {}
        self.products = 0

    def add(self, kind: str, *values: str) -> str:
        """Return the reference of an entity."""
        text = f"{kind}({','.join(values)})"
        return f"#{self.lines.setdefault(text, len(self.lines) + 1)}"

    def identity(self) -> str:
        """Return the next identity, 22 characters long."""
        self.products += 1
        return f"'{self.products:022d}'"

    def point(self, *values: float) -> str:
        """Return a point."""
        return self.add("IFCCARTESIANPOINT", f"({','.join(_real(v) for v in values)})")

    def placement(self, x: float, y: float, z: float, angle_rad: float = 0.0) -> str:
        """Return a local placement that is turned about the vertical."""
        up = self.add("IFCDIRECTION", "(0.,0.,1.)")
        ahead = f"({_real(math.cos(angle_rad))},{_real(math.sin(angle_rad))},0.)"
        axes = self.add(
            "IFCAXIS2PLACEMENT3D", self.point(x, y, z), up, self.add("IFCDIRECTION", ahead)
        )
        return self.add("IFCLOCALPLACEMENT", "$", axes)

    def body(self, profile: str, context: str, height_m: float) -> str:
        """Return the shape of a profile that is extruded upwards."""
        axes = self.add("IFCAXIS2PLACEMENT3D", self.point(0, 0, 0), "$", "$")
        up = self.add("IFCDIRECTION", "(0.,0.,1.)")
        solid = self.add("IFCEXTRUDEDAREASOLID", profile, axes, up, _real(height_m))
        items = self.add("IFCSHAPEREPRESENTATION", context, "'Body'", "'SweptSolid'", f"({solid})")
        return self.add("IFCPRODUCTDEFINITIONSHAPE", "$", "$", f"({items})")

    def rectangle(self, length_m: float, width_m: float) -> str:
        """Return the profile of a wall."""
        middle = self.add("IFCAXIS2PLACEMENT2D", self.point(0, 0), "$")
        sizes = (_real(length_m), _real(width_m))
        return self.add("IFCRECTANGLEPROFILEDEF", ".AREA.", "$", middle, *sizes)

    def product(self, kind: str, name: str, placed: str, shape: str, *more: str) -> str:
        """Return what stands somewhere and has a shape."""
        return self.add(kind, self.identity(), "$", f"'{name}'", "$", "$", placed, shape, *more)

    def text(self) -> str:
        """Return the whole file."""
        body = "".join(f"#{number}={text};\n" for text, number in self.lines.items())
        return (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            "FILE_NAME('floor.ifc','2024-01-01T00:00:00',(''),(''),'','','');\n"
            f"FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{body}ENDSEC;\nEND-ISO-10303-21;\n"
        )


def _real(value: float) -> str:
    text = f"{value:.5f}".rstrip("0")
    return "0." if text in ("-0.", "0.") else text


def write_ifc(plan: FloorPlan, path: Path) -> None:
    """Write a model: walls as solids, doors and windows in their openings, rooms as spaces."""
    model = IfcModel()
    axes = model.add("IFCAXIS2PLACEMENT3D", model.point(0, 0, 0), "$", "$")
    context = model.add(
        "IFCGEOMETRICREPRESENTATIONCONTEXT", "$", "'Model'", "3", "1.E-5", axes, "$"
    )
    metre = model.add("IFCSIUNIT", "*", ".LENGTHUNIT.", "$", ".METRE.")
    units = model.add("IFCUNITASSIGNMENT", f"({metre})")
    project = model.add("IFCPROJECT", model.identity(), "$", "'floor'", "$", "$", "$", "$",
                        f"({context})", units)  # fmt: skip
    building = model.product("IFCBUILDING", "floor", model.placement(0, 0, 0), "$", "$",
                             ".ELEMENT.", "$", "$", "$")  # fmt: skip
    storeys = [
        model.product("IFCBUILDINGSTOREY", name, model.placement(0, 0, z), "$", "$", ".ELEMENT.",
                      _real(z))
        for name, z in (("First floor", 0.0), ("Second floor", LEVEL_M))
    ]  # fmt: skip
    _relate(model, "IFCRELAGGREGATES", project, [building])
    _relate(model, "IFCRELAGGREGATES", building, storeys)
    products = [each for segment, kind in zip(plan.segments_m, plan.classes, strict=True)
                for each in _ifc_products(model, context, segment, SegmentClass(kind))]  # fmt: skip
    members = f"({','.join(products)})"
    model.add("IFCRELCONTAINEDINSPATIALSTRUCTURE", model.identity(), "$", "$", "$", members,
              storeys[1])  # fmt: skip
    spaces = []
    for room in plan.rooms:
        points = [model.point(*corner) for corner in [*room.polygon_m, room.polygon_m[0]]]
        ring = model.add("IFCPOLYLINE", f"({','.join(points)})")
        profile = model.add("IFCARBITRARYCLOSEDPROFILEDEF", ".AREA.", "$", ring)
        shape, placed = model.body(profile, context, STOREY_M), model.placement(0, 0, LEVEL_M)
        spaces.append(
            model.product("IFCSPACE", room.name, placed, shape, "$", ".ELEMENT.", "$", "$")
        )
    _relate(model, "IFCRELAGGREGATES", storeys[1], spaces)
    path.write_text(model.text())


def _relate(model: IfcModel, kind: str, whole: str, parts: list[str]) -> None:
    model.add(kind, model.identity(), "$", "$", "$", whole, f"({','.join(parts)})")


def _ifc_products(
    model: IfcModel, context: str, segment: npt.NDArray[np.float64], kind: SegmentClass
) -> list[str]:
    """Add a wall, with an opening in it and what fills it; return what stands in the storey."""
    (x, y), (along_x, along_y) = segment.mean(axis=0), segment[1] - segment[0]
    length = math.hypot(along_x, along_y)
    placed = model.placement(x, y, LEVEL_M, math.atan2(along_y, along_x))

    def box(height_m: float) -> str:
        return model.body(model.rectangle(length, WALL_M), context, height_m)

    wall = model.product("IFCWALL", kind.name.lower(), placed, box(STOREY_M), "$", "$")
    if kind == SegmentClass.WALL:
        return [wall]
    opening = model.product("IFCOPENINGELEMENT", "", placed, box(DOOR_M), "$", "$")
    model.add("IFCRELVOIDSELEMENT", model.identity(), "$", "$", "$", wall, opening)
    if kind == SegmentClass.OPENING:
        return [wall]
    entity = "IFCDOOR" if kind == SegmentClass.DOOR else "IFCWINDOW"
    sizes = (_real(DOOR_M), _real(length))
    filling = model.product(entity, "", placed, box(DOOR_M), "$", *sizes, "$", "$", "$")
    model.add("IFCRELFILLSELEMENT", model.identity(), "$", "$", "$", opening, filling)
    return [wall, filling]
