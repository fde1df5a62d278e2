"""GeoPackage and shapefiles: layers, attributes, coordinate systems; and damaged ones."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
import struct
import sys
import zipfile

import numpy as np
import pytest
import shapely

from palms.errors import FormatError, InputError
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, read_any
from palms.io.esri_shapefile import parse_shapefile
from palms.io.plan_gpkg import read_plan_gpkg
from palms.io.plan_shapefile import read_plan_shapefile
from tests.io.floors import load_tool

TOOL = load_tool("plan_gis")
HALL = [[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]]
SYSTEMS = (
    (-1, "NONE", -1, "undefined"),
    (0, "NONE", 0, "undefined"),
    (4326, "EPSG", 4326, "x"),
    (25832, "EPSG", 25832, "x"),
    (99, "mine", 99, 'LOCAL_CS["site",UNIT["metre",1]]'),
    (100, "NONE", 100, 'GEOGCS["ETRS89",DATUM["x"]]'),
)


def line(*points, wrap=shapely.LineString):
    return b"GP\x00\x01" + struct.pack("<i", 0) + shapely.to_wkb(wrap(points))


@pytest.fixture
def gpkg(tmp_path):
    """Write a GeoPackage; tables hold rows (geometry, attributes); return its path."""

    def make(srs=-1, script="", **tables):
        path = tmp_path / "a.gpkg"
        path.unlink(missing_ok=True)
        with contextlib.closing(sqlite3.connect(path)) as database:
            database.executescript(
                "PRAGMA application_id = 0x47504B47;"
                "CREATE TABLE gpkg_spatial_ref_sys (srs_id, organization, "
                "organization_coordsys_id, definition);"
                "CREATE TABLE gpkg_contents (table_name, data_type);"
                "CREATE TABLE gpkg_geometry_columns (table_name, column_name, srs_id);"
            )
            values = "(?, ?, ?, ?)"
            database.executemany(f"INSERT INTO gpkg_spatial_ref_sys VALUES {values}", SYSTEMS)
            for name, rows in tables.items():
                keys = sorted({key for _, attributes in rows for key in attributes})
                columns = ", ".join(['"geom"', *(f'"{key}"' for key in keys)])
                database.execute(f'CREATE TABLE "{name}" ({columns})')
                database.execute("INSERT INTO gpkg_contents VALUES (?, 'features')", (name,))
                row = (name, "geom", srs)
                database.execute("INSERT INTO gpkg_geometry_columns VALUES (?, ?, ?)", row)
                marks = ", ".join("?" * (len(keys) + 1))
                for geometry, attributes in rows:
                    cells = (geometry, *(attributes.get(key) for key in keys))
                    database.execute(f'INSERT INTO "{name}" VALUES ({marks})', cells)
            database.executescript(script)
            database.commit()
        return path

    return make


def test_tables_name_the_class(gpkg):
    path = gpkg(
        Walls=[(line(*HALL), {})],
        floor2_doors=[(line([3, 0], [4, 0]), {})],
        rooms=[(line(*HALL, wrap=shapely.Polygon), {"Name": "Hall"})],
        cables=[(None, {})],
    )
    plan = read_plan_gpkg(path)
    assert plan.size_m.tolist() == [8, 5]
    assert plan.of_class(SegmentClass.DOOR).tolist() == [[[3, 0], [4, 0]]]
    assert plan.room_at([4, 4]) == "Hall"
    assert plan.origin is None
    only = read_any(FLOORPLANS, path, None, ["layers=Walls"])
    assert not len(only.of_class(SegmentClass.DOOR))


def test_an_attribute_names_the_class_before_the_table(gpkg):
    rows = [(line(*HALL), {"Type": "Muro"}), (line([3, 0], [4, 0]), {"Type": "puerta"}),
            (line([8, 1], [8, 2]), {"Type": "vidrio"})]  # fmt: skip
    plan = read_plan_gpkg(gpkg(lines=rows), classes="vidrio:glass")
    assert len(plan.of_class(SegmentClass.DOOR)) == 1
    assert len(plan.of_class(SegmentClass.GLASS)) == 1


@pytest.mark.parametrize(("key", "values"), [("level", (1, 2)), ("FLOOR", (1.0, 2.0)),
                                             ("storey", ("1", "2"))])  # fmt: skip
def test_levels_are_chosen_and_listed(gpkg, says, key, values):
    rows = [(line([0, 0], [8 + i, 0]), {key: value}) for i, value in enumerate(values)]
    path = gpkg(walls=[*rows, (line([0, 0], [0, 5]), {key: None})])
    with pytest.raises(InputError) as caught:
        read_plan_gpkg(path)
    says(caught.value, "levels 1, 2", "level=")
    plan = read_plan_gpkg(path, level="2")
    assert (plan.size_m.tolist(), plan.level) == ([9, 5], "2")
    with pytest.raises(InputError, match="one of 1, 2"):
        read_plan_gpkg(path, level="7")


def test_where_filters_by_an_attribute(gpkg, says):
    rows = [(line(*HALL), {"building": "B2", "n": 3}), (line([90, 0], [99, 0]), {"building": "B1"})]
    path = gpkg(walls=rows)
    assert read_plan_gpkg(path, where="Building:B2").size_m.tolist() == [8, 5]
    assert read_plan_gpkg(path, where="n:3").size_m.tolist() == [8, 5]
    with pytest.raises(InputError) as caught:
        read_plan_gpkg(path, where="building:B9")
    says(caught.value, "walls (2)", "where=")
    with pytest.raises(InputError, match="ATTRIBUTE:VALUE"):
        read_plan_gpkg(path, where="B2")
    with pytest.raises(InputError, match="some of walls"):
        read_plan_gpkg(path, layers="walls,doors")


def test_geometries_of_all_kinds(gpkg):
    parts = shapely.GeometryCollection([
        shapely.MultiLineString([[[0, 0], [8, 0]], [[8, 0], [8, 5]]]), shapely.Point(1, 1),
        shapely.LineString([[0, 0, 3], [0, 5, 4]]), shapely.LineString(),
    ])  # fmt: skip
    hole = shapely.Polygon([[1, 1], [4, 1], [4, 4], [1, 4]], [[[2, 2], [3, 2], [3, 3]]])
    head = b"GP\x00\x01" + struct.pack("<i", 0)
    boxed = b"GP\x00\x03" + struct.pack("<i4d", 0, 0, 4, 0, 4)
    path = gpkg(walls=[(head + shapely.to_wkb(parts), {}), (boxed + shapely.to_wkb(hole), {})])
    assert len(read_plan_gpkg(path).segments_m) == 3 + 4 + 3


M = 1 / 111_319.49  # degrees of a metre at the equator


@pytest.mark.parametrize("srs", [4326, 100, 0])
def test_degrees(gpkg, srs):
    ring = [[9 + M * x, M * y / 0.99330562] for x, y in HALL]
    plan = read_plan_gpkg(gpkg(srs, walls=[(line(*ring), {})]))
    assert plan.size_m == pytest.approx([8, 5], abs=1e-3)
    assert plan.origin.lon_deg == pytest.approx(9, abs=1e-4)


def test_projected_metres_become_true_ones(gpkg):
    pytest.importorskip("pyproj")
    ring = [[500_000 + 500 * x, 5_500_000 + 500 * y] for x, y in ([0, 0], [1, 0], [1, 1], [0, 1])]
    plan = read_plan_gpkg(gpkg(25832, walls=[(line(*ring), {})]))
    assert plan.size_m == pytest.approx([500 / 0.9996] * 2, abs=0.05)  # of UTM's middle
    assert plan.origin.lat_deg == pytest.approx(49.65, abs=0.05)
    local = read_plan_gpkg(gpkg(25832, walls=[(line(*ring), {})]), crs="local", scale=0.5)
    assert local.size_m.tolist() == [250, 250]
    assert local.origin is None


@pytest.mark.parametrize("srs", [-1, 99])
def test_local_metres(gpkg, srs, says):
    path = gpkg(srs, walls=[(line(*[[1000 * x, 1000 * y] for x, y in HALL]), {})])
    with pytest.raises(InputError) as caught:
        read_plan_gpkg(path)
    says(caught.value, "multiply by 0.001", "scale=")
    plan = read_plan_gpkg(path, scale=0.001, origin=(9.0, 48.0))
    assert plan.size_m == pytest.approx([8, 5])
    assert plan.origin.lat_deg == 48.0


def test_systems_that_make_no_sense(gpkg, says):
    pytest.importorskip("pyproj")
    path = gpkg(4326, walls=[(line(*[[1000 * x, 1000 * y] for x, y in HALL]), {})])
    with pytest.raises(InputError) as caught:
        read_plan_gpkg(path)
    says(caught.value, "degrees", "crs=EPSG:NUMBER")
    for crs in ("EPSG:999999", "nonsense"):
        with pytest.raises(InputError) as caught:
            read_plan_gpkg(path, crs=crs)
        says(caught.value, "a coordinate system that is known")
    with pytest.raises(InputError) as caught:
        read_plan_gpkg(gpkg(25832, walls=[(line([1e30, 0], [2e30, 5]), {})]))
    says(caught.value, "a.gpkg")


def test_without_pyproj_the_extra_is_named(gpkg, says, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyproj", None)
    path = gpkg(25832, walls=[(line(*HALL), {})])
    with pytest.raises(InputError) as caught:
        read_any(FLOORPLANS, path)
    says(caught.value, "palms-localization[gis]", "pyproj")
    assert read_any(FLOORPLANS, path, None, ["crs=local"]).size_m.tolist() == [8, 5]


def with_number(value):
    return line([0, 0], [7, 1]).replace(struct.pack("<d", 7), struct.pack("<d", value))


@pytest.mark.parametrize(
    "geometry",
    [
        b"",
        b"GP",
        b"XX\x00\x01" + bytes(40),
        b"GP\x00\x0f" + bytes(90),
        b"GP\x00\x01" + bytes(40),
        line(*HALL)[:-9],
        "text",
        7,
        with_number(float("nan")),
        with_number(float("inf")),
        line(*HALL)[:8] + bytes([1]) + struct.pack("<II", 8, 0),  # an arc
    ],
    ids=lambda each: f"{type(each).__name__} of {len(str(each))}",
)
def test_damaged_geometries_are_refused_in_one_line(gpkg, says, geometry):
    with pytest.raises(FormatError) as caught:
        read_plan_gpkg(gpkg(walls=[(line(*HALL), {}), (geometry, {})]))
    says(caught.value, "a.gpkg, walls row 2")


def test_a_plain_database_is_no_geopackage(tmp_path, says):
    path = tmp_path / "a.gpkg"
    with contextlib.closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE walls (x)")
    with pytest.raises(FormatError) as caught:
        read_any(FLOORPLANS, path)
    says(caught.value, "a GeoPackage", "no such table")


def test_a_view_that_never_ends_is_stopped(gpkg, says):
    endless = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x FROM c"
    path = gpkg(script=f"CREATE VIEW walls AS SELECT NULL AS geom, count(*) FROM ({endless});"
                "INSERT INTO gpkg_contents VALUES ('walls', 'features');"
                "INSERT INTO gpkg_geometry_columns VALUES ('walls', 'geom', -1);")  # fmt: skip
    with pytest.raises(FormatError) as caught:
        read_plan_gpkg(path)
    says(caught.value, "interrupted")


def test_the_file_is_not_changed(gpkg):
    path = gpkg(walls=[(line(*HALL), {})])
    before, names = path.read_bytes(), sorted(path.parent.iterdir())
    read_plan_gpkg(path)
    assert path.read_bytes() == before
    assert sorted(path.parent.iterdir()) == names


@pytest.fixture
def shp(tmp_path):
    """Write a shapefile; return its path."""

    def make(shapes, kind=3, rows=None, names=("TYPE",), name="walls", prj=""):
        path = tmp_path / f"{name}.shp"
        path.write_bytes(TOOL.shp_file([np.array(s, float) for s in shapes], kind)[0])
        if rows is not None:
            path.with_suffix(".dbf").write_bytes(TOOL.dbf_file(rows, list(names)))
        if prj:
            path.with_suffix(".prj").write_text(prj)
        return path

    return make


def test_a_shapefile_with_attributes(shp):
    path = shp([HALL, [[3, 0], [4, 0]]], rows=[["wall", "1"], ["door", "1"]],
               names=("TYPE", "LEVEL"))  # fmt: skip
    plan = read_plan_shapefile(path)
    assert (plan.size_m.tolist(), plan.level, plan.name) == ([8, 5], "1", "walls")
    assert len(plan.of_class(SegmentClass.DOOR)) == 1
    assert choose_format(FLOORPLANS, path).name == "shapefile"


def test_a_folder_of_shapefiles(shp, tmp_path):
    shp([HALL])
    shp([[[3, 0], [4, 0]]], name="Doors")
    shp([HALL], kind=5, rows=[["Hall"]], names=("NAME",), name="rooms")
    assert choose_format(FLOORPLANS, tmp_path).name == "shapefile"
    plan = read_any(FLOORPLANS, tmp_path)
    assert len(plan.of_class(SegmentClass.DOOR)) == 1
    assert plan.room_at([4, 4]) == "Hall"
    assert len(plan.of_class(SegmentClass.WALL)) == 5
    only = read_any(FLOORPLANS, tmp_path, None, ["layers=walls"])
    assert len(only.segments_m) == 4


def test_layers_of_different_systems_are_refused(shp, tmp_path, says):
    shp([HALL], prj='LOCAL_CS["a"]')
    shp([HALL], name="walls2", prj='LOCAL_CS["b"]')
    with pytest.raises(InputError) as caught:
        read_plan_shapefile(tmp_path)
    says(caught.value, "2 of them", "layers=")
    assert read_plan_shapefile(tmp_path, layers="walls").size_m.tolist() == [8, 5]
    assert read_plan_shapefile(tmp_path, crs="local").size_m.tolist() == [8, 5]


def record(kind, *parts, extra=b""):
    points = np.concatenate([np.array(part, float) for part in parts])
    starts = np.cumsum([0, *(len(part) for part in parts[:-1])]).astype("<i4")
    return (struct.pack("<i4d2i", kind, 0, 0, 0, 0, len(parts), len(points)) + starts.tobytes()
            + points.astype("<f8").tobytes() + extra)  # fmt: skip


def shapefile(*records):
    body = b"".join(struct.pack(">ii", i + 1, len(r) // 2) + r for i, r in enumerate(records))
    head = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(body)) // 2)
    return head + struct.pack("<ii8d", 1000, 3, *(0.0,) * 8) + body


def test_records_of_all_kinds():
    heights = struct.pack("<4d", 0, 0, 0, 0)
    found = parse_shapefile(
        {"shp": shapefile(
            record(3, HALL, HALL[:2]), record(13, HALL[:2], extra=heights), struct.pack("<i", 0),
            struct.pack("<i2d", 1, 4.0, 4.0), record(5, HALL, HALL), record(23, HALL[:2]),
        )}, "a.shp",
    )  # fmt: skip
    counts = [(len(each.lines), len(each.rings)) for each in found]
    assert counts == [(2, 0), (1, 0), (0, 0), (0, 0), (0, 2), (1, 0)]
    assert found[0].lines[1].tolist() == HALL[:2]


GOOD = record(3, HALL)


@pytest.mark.parametrize(
    "content",
    [
        shapefile(GOOD)[:-1],
        shapefile(GOOD)[:-200],
        shapefile(GOOD)[:104],
        shapefile(GOOD) + b"\x00\x00",
        shapefile(struct.pack("<i", 77)),
        shapefile(GOOD[:20]),
        shapefile(GOOD[:36] + struct.pack("<ii", 1, 2**31 - 1) + GOOD[44:]),
        shapefile(GOOD[:36] + struct.pack("<ii", 2**30, 5) + GOOD[44:]),
        shapefile(GOOD[:36] + struct.pack("<ii", -1, -1) + GOOD[44:]),
        shapefile(GOOD[:44] + struct.pack("<i", 99) + GOOD[48:]),
        shapefile(record(3, [[0, 0], [float("nan"), 1]])),
        b"\x00\x00\x27\x0a",
    ],
)
def test_damaged_shapes_are_refused_in_one_line(put, says, content):
    with pytest.raises(FormatError) as caught:
        read_plan_shapefile(put("a.shp", content))
    says(caught.value, "a.shp")


@pytest.mark.parametrize("change", [
    lambda table: table[:20], lambda table: table[:-30],
    lambda table: table[:4] + struct.pack("<I", 10**9) + table[8:],
    lambda table: table[:10] + b"\x00\x00" + table[12:],
    lambda table: table[:48] + b"\xff" + table[49:],
    lambda table: TOOL.dbf_file([["wall"]] * 3, ["TYPE"]),
])  # fmt: skip
def test_damaged_tables_are_refused_in_one_line(shp, says, change):
    path = shp([HALL], rows=[["wall"]])
    table = path.with_suffix(".dbf")
    table.write_bytes(change(table.read_bytes()))
    with pytest.raises(FormatError) as caught:
        read_plan_shapefile(path)
    says(caught.value, "walls.shp")


def test_deleted_rows_numbers_and_code_pages(shp):
    path = shp([HALL, HALL[:2], HALL[:2]], rows=[["wände"], ["x"], ["é"]])
    table = path.with_suffix(".dbf")
    content = table.read_bytes()
    content = content.replace(b" x ", b"*x ", 1)
    table.write_bytes(content)
    rows = [each.properties for each in parse_shapefile(
        {"shp": path.read_bytes(), "dbf": content, "cpg": b"UTF-8"}, "a")]  # fmt: skip
    assert rows == [{"TYPE": "wände"}, {"TYPE": "é"}]
    latin = TOOL.dbf_file([["?"], ["?"], ["?"]], ["TYPE"]).replace(b"?", b"\xe9")
    for code_page in (b"", b"1252", b"nonsense"):
        parts = {"shp": path.read_bytes(), "dbf": latin, "cpg": code_page}
        assert parse_shapefile(parts, "a")[0].properties == {"TYPE": "é"}
    number = TOOL.dbf_file([["2.50"], ["7"], ["***"]], ["N"]).replace(
        b"N" + bytes(10) + b"C", b"N" + bytes(10) + b"N"
    )
    parts = {"shp": path.read_bytes(), "dbf": number}
    assert [each.properties["N"] for each in parse_shapefile(parts, "a")] == [2.5, 7, None]


def test_a_zip_without_shapes_and_one_that_leads_out(tmp_path, says):
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("../walls.shp", shapefile(GOOD))
    with pytest.raises(FormatError) as caught:
        read_plan_shapefile(path)
    says(caught.value, "names inside the archive")
    shutil.rmtree(tmp_path / "empty", ignore_errors=True)
    (tmp_path / "empty").mkdir()
    with pytest.raises(FormatError) as caught:
        read_plan_shapefile(tmp_path / "empty")
    says(caught.value, "name the .shp file")
