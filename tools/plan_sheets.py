"""A floor as drawings, SVG and PDF, for the tests."""

from __future__ import annotations

import math
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt

from palms import FloorPlan, SegmentClass

MARGIN_M = 1.0
SVG_CLASSES = {
    SegmentClass.WALL: "Walls", SegmentClass.GLASS: "Glass", SegmentClass.OPENING: "Openings"
}  # fmt: skip


def write_svg(plan: FloorPlan, path: Path) -> None:
    """Write shapes in centimetres in groups, as Inkscape's layers; y down from the lower left."""
    width, height = np.ceil(plan.bounds_m[1] + MARGIN_M) * 100
    lines = [
        "<?xml version='1.0' encoding='UTF-8'?>",
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces"
        f"/inkscape' viewBox='0 0 {width:g} {height:g}'>",
        f" <g transform='translate(0 {height:g}) scale(1 -1)' fill='none' stroke='black'>",
    ]
    for kind, label in SVG_CLASSES.items():
        lines.append(f"  <g inkscape:label='{label}' stroke-width='8'>")
        for segment in plan.of_class(kind) * 100:
            (x0, y0), (x1, y1) = segment.round(2).tolist()
            lines.append(f"   <path d='M{x0:g} {y0:g}L{x1:g} {y1:g}'/>")
        lines.append("  </g>")
    lines.append("  <g inkscape:label='Doors'>")
    for segment in plan.of_class(SegmentClass.DOOR) * 100:
        (x0, y0), (x1, y1) = segment.round(2).tolist()
        leaf, radius = (x0 - (y1 - y0), y0 + (x1 - x0)), math.hypot(x1 - x0, y1 - y0)
        lines.append(f"   <path d='M{x0:g} {y0:g}L{leaf[0]:.2f} {leaf[1]:.2f}"
                     f"A{radius:.3f} {radius:.3f} 0 0 0 {x1:g} {y1:g}'/>")  # fmt: skip
    lines.append("  </g>\n  <g id='rooms' stroke='none'>")
    for room in plan.rooms:
        corners = " ".join(f"{x:g},{y:g}" for x, y in (room.polygon_m * 100).round(2).tolist())
        lines.append(f"   <polygon points='{corners}'><title>{room.name}</title></polygon>")
    path.write_text("\n".join([*lines, "  </g>", " </g>", "</svg>\n"]))


POINT_M = 0.0254 / 72 * 200  # metres of a point of the PDF, at 1:200
PDF_LAYERS = {
    SegmentClass.WALL: ("A-WALL", 1.5), SegmentClass.GLASS: ("A-GLAZ", 0.5),
    SegmentClass.OPENING: ("A-OPENING", 0.25), SegmentClass.DOOR: ("A-DOOR", 0.35),
}  # fmt: skip
_KAPPA = 4 / 3 * (math.sqrt(2) - 1)  # of the Bezier curve that is a quarter circle, nearly


def pdf_page(plan: FloorPlan, layers: bool = True) -> str:
    """Return the content of a page at 1:200, from its lower left corner."""
    lines = ["1 J"]
    for i, (kind, (_, width)) in enumerate(PDF_LAYERS.items()):
        lines.append(f"/OC /Layer{i} BDC\n{width:g} w" if layers else f"{width:g} w")
        for a, b in plan.of_class(kind) / POINT_M:
            if kind != SegmentClass.DOOR:
                lines.append(f"{_at(a)} m {_at(b)} l S")
                continue
            across = np.array([a[1] - b[1], b[0] - a[0]])
            leaf, bend = a + across, (b - a) * _KAPPA
            lines.append(f"{_at(a)} m {_at(leaf)} l S")
            lines.append(
                f"{_at(leaf)} m {_at(leaf + bend)} {_at(b + across * _KAPPA)} {_at(b)} c S"
            )
        lines += ["EMC"] if layers else []
    for room in plan.rooms:
        at = room.polygon_m.mean(axis=0) / POINT_M
        lines.append(f"BT /F1 5 Tf {_at(at)} Td ({room.name}) Tj ET")
    return "\n".join(lines)


def _at(point: npt.NDArray[np.float64]) -> str:
    return f"{point[0]:.3f} {point[1]:.3f}"


def write_pdf(plan: FloorPlan, path: Path, layers: bool = True) -> None:
    """Write a sheet of vector drawing, with or without layers."""
    size = np.ceil((plan.bounds_m[1] + MARGIN_M) / POINT_M)
    content = zlib.compress(pdf_page(plan, layers).encode(), 9)
    numbers = [f"{8 + i} 0 R" for i in range(len(PDF_LAYERS))]
    properties = " ".join(f"/Layer{i} {number}" for i, number in enumerate(numbers))
    optional = f"<< /OCGs [{' '.join(numbers)}] /D << >> >>"
    objects = [
        f"<< /Type /Catalog /Pages 2 0 R /OCProperties {optional} >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {size[0]:g} {size[1]:g}] /Contents 4 0 R "
        f"/Resources << /Font << /F1 5 0 R >> /Properties << {properties} >> >> >>",
        f"<< /Length {len(content)} /Filter /FlateDecode >>",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        "<< /Title (floor) >>",
        "<< >>",
        *(f"<< /Type /OCG /Name ({name}) >>" for name, _ in PDF_LAYERS.values()),
    ]
    path.write_bytes(pdf_file(objects, {4: content}))


def pdf_file(objects: list[str], streams: dict[int, bytes]) -> bytes:
    """Return a PDF of numbered objects, the catalogue first."""
    out, places = b"%PDF-1.5\n", []
    for number, text in enumerate(objects, start=1):
        places.append(len(out))
        stream = streams.get(number)
        inside = b"" if stream is None else b"\nstream\n" + stream + b"\nendstream"
        out += f"{number} 0 obj\n{text}".encode() + inside + b"\nendobj\n"
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    head = f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}"
    trailer = f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R >>\nstartxref\n{len(out)}\n%%EOF\n"
    return out + (head + trailer).encode()
