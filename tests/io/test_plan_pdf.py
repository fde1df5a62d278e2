from __future__ import annotations

import sys
import zlib

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, read_any
from palms.io.plan_pdf import read_plan_pdf
from tests.io.floors import along, apart_m, load_tool, sample

pytest.importorskip("pypdfium2")
TOOL, MAKER = load_tool("plan_sheets"), load_tool()
UNIT = 0.1  # metres per point of the small drawings: 80 x 50 points are 8 x 5 m
BOX = "0 0 m 80 0 l 80 50 l 0 50 l h S"


@pytest.fixture
def pdf(put):
    """Write a document; each content is a page of 80 x 50 points; return its path."""

    def make(*contents, extra="", resources="", objects=(), streams=None, name="a.pdf"):
        first = 3 + 2 * len(contents)
        kids = " ".join(f"{3 + 2 * i} 0 R" for i in range(len(contents)))
        whole = [
            f"<< /Type /Catalog /Pages 2 0 R {extra} >>",
            f"<< /Type /Pages /Kids [{kids}] /Count {len(contents)} /MediaBox [0 0 80 50] >>",
        ]
        found = {first + i: stream for i, stream in (streams or {}).items()}
        for i, content in enumerate(contents):
            page, _, text = content.rpartition("|")
            whole += [
                f"<< /Type /Page /Parent 2 0 R /Contents {4 + 2 * i} 0 R {page} "
                f"/Resources << {resources} >> >>",
                f"<< /Length {len(text)} >>",
            ]
            found[4 + 2 * i] = text.encode()
        return put(name, TOOL.pdf_file([*whole, *objects], found))

    return make


def layered(pdf, *layers, **more):
    """A page whose contents lie on layers: (name, content) each."""
    names = " ".join(f"/L{i} {5 + i} 0 R" for i in range(len(layers)))
    groups = [f"<< /Type /OCG /Name ({name}) >>" for name, _ in layers]
    listed = " ".join(f"{5 + i} 0 R" for i in range(len(layers)))
    content = "\n".join(f"/OC /L{i} BDC {text} EMC" for i, (_, text) in enumerate(layers))
    return pdf(
        content,
        extra=f"/OCProperties << /OCGs [{listed}] /D << >> >>",
        resources=f"/Properties << {names} >> /Font << /F 20 0 R >>",
        objects=groups,
        **more,
    )


def rows(plan, kind):
    return sorted(np.sort(each, axis=0).round(2).ravel().tolist() for each in plan.of_class(kind))


def test_layers_say_what_lines_are(pdf):
    door = "30 0 m 30 10 l S 30 10 m 35.5228 10 40 5.5228 40 0 c S"
    path = layered(pdf, ("A-WALL", BOX), ("A-DOOR", door), ("A-GLAZ", "80 20 m 80 40 l S"),
                   ("Text", "0 0 m 80 50 l S"))  # fmt: skip
    plan = read_plan_pdf(path, scale=UNIT)
    assert plan.size_m.tolist() == [8, 5]
    assert rows(plan, SegmentClass.DOOR) == [[3, 0, 4, 0]]
    assert rows(plan, SegmentClass.GLASS) == [[8, 2, 8, 4]]
    assert [0, 0, 3, 0] in rows(plan, SegmentClass.WALL)


def test_rooms_are_named_by_the_text_in_them(pdf):
    text = "BT /F 4 Tf 5 20 Td (Lab 7) Tj ET"
    objects = ["<< >>"] * 13 + ["<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"]
    names = "/L0 5 0 R /L1 6 0 R"
    groups = ["<< /Type /OCG /Name (walls) >>", "<< /Type /OCG /Name (rooms) >>"]
    path = pdf(f"/OC /L0 BDC {BOX} EMC /OC /L1 BDC 0 0 40 50 re S EMC {text}",
               extra="/OCProperties << /OCGs [5 0 R 6 0 R] /D << >> >>",
               resources=f"/Properties << {names} >> /Font << /F 20 0 R >>",
               objects=groups + objects)  # fmt: skip
    plan = read_plan_pdf(path, scale=UNIT)
    assert plan.room_at([1, 1]) == "Lab 7"
    assert plan.room_at([6, 1]) is None


def test_without_layers_heavy_lines_are_walls_and_swings_doors(tmp_path):
    TOOL.write_pdf(MAKER.sample_plan(), tmp_path / "bare.pdf", layers=False)
    plan, truth = read_plan_pdf(tmp_path / "bare.pdf", ratio=200), sample()
    doors = truth.of_class(SegmentClass.DOOR)
    assert len(plan.of_class(SegmentClass.DOOR)) == len(doors)
    assert apart_m(plan.of_class(SegmentClass.DOOR).mean(axis=1), doors).max() < 0.01
    walls = truth.of_class(SegmentClass.WALL)  # glass is drawn thinly
    assert apart_m(along(walls), plan.of_class(SegmentClass.WALL)).max() < 0.01
    assert apart_m(along(plan.of_class(SegmentClass.WALL)), walls).max() < 0.01
    with_thin = read_plan_pdf(tmp_path / "bare.pdf", ratio=200, min_stroke=0.1)
    assert len(with_thin.of_class(SegmentClass.WALL)) > len(plan.of_class(SegmentClass.WALL))


def test_layers_that_say_nothing_are_named(pdf, says):
    path = layered(pdf, ("0", BOX), ("Moebel", "10 10 m 20 10 l S"))
    with pytest.warns(PalmsWarning, match=r"layers 'Moebel \(1\)'"):
        plan = read_plan_pdf(path, scale=UNIT)
    assert len(plan.segments_m) == 5
    assert len(read_plan_pdf(path, scale=UNIT, walls="^0$").segments_m) == 4
    with pytest.raises(InputError) as caught:
        read_plan_pdf(path, scale=UNIT, walls="fachada")
    says(caught.value, "0 (1), Moebel (1)", "walls=PATTERN", "mode=picture")


def test_a_drawing_may_be_drawn_and_looked_at(tmp_path):
    TOOL.write_pdf(MAKER.sample_plan(), tmp_path / "bare.pdf", layers=False)
    plan, truth = read_plan_pdf(tmp_path / "bare.pdf", ratio=200, mode="picture"), sample()
    walls = truth.of_class(SegmentClass.WALL)
    pixel_m = TOOL.POINT_M * 72 / 200
    assert np.quantile(apart_m(along(walls), plan.segments_m), 0.99) < 2 * pixel_m
    assert np.quantile(apart_m(along(plan.segments_m), walls), 0.95) < 2 * pixel_m


def test_a_scanned_page_is_looked_at(pdf):
    picture = MAKER.picture(MAKER.sample_plan())
    image = (
        f"<< /Type /XObject /Subtype /Image /Width {picture.width} /Height {picture.height} "
        "/ColorSpace /DeviceGray /BitsPerComponent 8 /Filter /FlateDecode /Length {} >>"
    )
    stream = zlib.compress(picture.tobytes())
    page = f"/MediaBox [0 0 {picture.width} {picture.height}]"
    path = pdf(f"{page}|{picture.width} 0 0 {picture.height} 0 0 cm /I Do",
               resources="/XObject << /I 5 0 R >>",
               objects=[image.format(len(stream))], streams={0: stream})  # fmt: skip
    plan, truth = read_plan_pdf(path, scale=MAKER.SCALE_M), sample()
    walls = plan.segments_m + truth.bounds_m[0] - MAKER.MARGIN_M
    assert np.quantile(apart_m(along(truth.blocking_m), walls), 0.98) < 1.5 * MAKER.SCALE_M
    assert np.quantile(apart_m(along(walls), truth.blocking_m), 0.95) < 1.5 * MAKER.SCALE_M


def test_pages_are_chosen_and_counted(pdf, says):
    path = pdf(BOX, "0 0 m 60 0 l 60 30 l S")
    with pytest.raises(InputError) as caught:
        read_plan_pdf(path, scale=UNIT)
    says(caught.value, "a page from 1 to 2", "2 pages", "page=NUMBER")
    assert read_any(FLOORPLANS, path, None, ["scale=0.1", "page=2"]).size_m.tolist() == [6, 3]
    with pytest.raises(InputError, match="got 3"):
        read_plan_pdf(path, scale=UNIT, page=3)


def test_the_scale_is_asked_for(pdf, says):
    path = pdf(BOX)
    with pytest.raises(InputError) as caught:
        read_plan_pdf(path)
    says(caught.value, "a page of 80 x 50 points", "scale=METRES per point", "points=")
    plan = read_plan_pdf(path, points=(0, 50, 80, 50), distance=16)
    assert plan.size_m == pytest.approx([16, 10])
    assert read_plan_pdf(path, ratio=100).size_m == pytest.approx([2.8222, 1.7639], abs=1e-3)
    with pytest.raises(InputError, match="above 0"):
        read_plan_pdf(path, ratio=0)


@pytest.mark.parametrize(
    ("turned", "at", "size"),
    [
        (0, (1, 0.5), (8, 5)),
        (90, (0.5, 5), (5, 8)),
        (180, (5, 3.5), (8, 5)),
        (270, (3.5, 1), (5, 8)),
    ],
)
def test_a_turned_page_is_read_as_it_is_shown(pdf, turned, at, size):
    plan = read_plan_pdf(pdf(f"/Rotate {turned}|{BOX} 10 5 20 10 re S"), scale=UNIT)
    assert plan.size_m.tolist() == list(size)
    inner = [s for s in plan.segments_m if (s > 0.1).all() and (s < np.array(size) - 0.1).all()]
    assert np.min(inner, axis=(0, 1)) == pytest.approx(at)


def test_the_corner_is_that_of_the_cropped_page(pdf):
    plan = read_plan_pdf(pdf(f"/CropBox [10 10 80 50]|{BOX}"), scale=UNIT)
    assert plan.bounds_m[0] == pytest.approx([-1, -1])


def test_forms_and_matrices(pdf):
    form = "<< /Type /XObject /Subtype /Form /BBox [0 0 99 99] /Matrix [2 0 0 2 0 0] /Length {} >>"
    text = b"0 0 m 40 0 l 40 25 l S"
    path = pdf("q 0.5 0 0 0.5 10 0 cm /F Do Q 1 0 0 1 0 5 cm 0 0 m 30 0 l S",
               resources="/XObject << /F 5 0 R >>", objects=[form.format(len(text))],
               streams={0: text})  # fmt: skip
    walls = rows(read_plan_pdf(path, scale=UNIT), SegmentClass.WALL)
    assert walls == sorted([[1, 0, 5, 0], [5, 0, 5, 2.5], [0, 0.5, 3, 0.5]])


def test_what_cannot_be_seen_is_no_wall(pdf):
    content = (
        f"{BOX} 1 G 10 10 m 70 10 l S 0 G 1 g 20 20 5 5 re f 0 g 40 20 5 5 re f 50 50 m 60 60 l n"
    )
    plan = read_plan_pdf(pdf(content), scale=UNIT)
    assert len(plan.segments_m) == 8
    assert [4, 2, 4.5, 2] in rows(plan, SegmentClass.WALL)


@pytest.mark.parametrize(
    ("content", "got"),
    [
        (b"%PDF-1.7", "PDFium"),
        (b"%PDF-1.7\n" + bytes(range(256)) * 20, "PDFium"),
        (b"\x89PNG\r\n", "a PNG image"),
        (b"", "an empty file"),
    ],
)
def test_what_is_no_document_is_refused(put, says, content, got):
    with pytest.raises(FormatError) as caught:
        read_plan_pdf(put("a.pdf", content), scale=1.0)
    says(caught.value, "a.pdf")
    assert got in str(caught.value) or "Data format error" in str(caught.value)


def test_an_empty_page_says_so(pdf, says):
    with pytest.raises(InputError) as caught:
        read_plan_pdf(pdf("q Q"), scale=UNIT)
    says(caught.value, "no lines at all", "mode=picture")


def test_a_page_of_absurd_size_is_refused(pdf, says):
    with pytest.raises(InputError) as caught:
        read_plan_pdf(pdf(f"/MediaBox [0 0 9000000 50]|{BOX}"), scale=UNIT)
    says(caught.value, "a.pdf")


def test_forms_within_forms_end(pdf, says):
    def form(inside):
        head = "<< /Type /XObject /Subtype /Form /BBox [0 0 99 99] /Resources << /XObject << "
        return head + f"/F {inside} 0 R >> >> /Length 60 >>"

    streams = dict.fromkeys(range(10), b"/F Do " * 10) | {10: b"0 0 m 9 9 l S ".ljust(60)}
    path = pdf("/F Do " * 10, resources="/XObject << /F 5 0 R >>",
               objects=[form(6 + i) for i in range(11)], streams=streams)  # fmt: skip
    with pytest.raises(FormatError) as caught:
        read_plan_pdf(path, scale=UNIT)
    says(caught.value, "a.pdf")


def test_a_bomb_of_blanks_is_refused(pdf, says):
    packer = zlib.compressobj()
    stream = packer.compress(b"") + packer.flush(zlib.Z_FULL_FLUSH)
    block = packer.compress(b" " * 1_000_000) + packer.flush(zlib.Z_FULL_FLUSH)
    stream += block * 4000
    path = pdf("q Q")
    old = b"<< /Length 3 >>\nstream\nq Q"
    assert old in path.read_bytes()
    head = f"<< /Length {len(stream)} /Filter /FlateDecode >>\nstream\n".encode()
    path.write_bytes(path.read_bytes().replace(old, head + stream))
    with pytest.raises(InputError) as caught:
        read_plan_pdf(path, scale=UNIT)
    says(caught.value, "a.pdf")


def test_a_document_is_known_by_its_content(pdf, put):
    assert choose_format(FLOORPLANS, put("a.dxf", b"junk\n" + pdf(BOX).read_bytes())).name == "pdf"


def test_without_pypdfium2_the_extra_is_named(pdf, says, monkeypatch):
    path = pdf(BOX)
    monkeypatch.setitem(sys.modules, "pypdfium2", None)
    with pytest.raises(InputError) as caught:
        read_any(FLOORPLANS, path, None, ["scale=0.1"])
    says(caught.value, "palms-localization[pdf]", "pypdfium2")
