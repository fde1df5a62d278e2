import numpy as np
import pytest
import shapely

from palms.grid import Grid
from palms.settings import TemplateSettings
from palms.template import build_template, certainly_empty, empty_triangles, recorded_walls
from tests.worlds import L_ROOM, seen_from

GRID = Grid((-6.05, -6.05), 0.1, (121, 121))


def walls():
    return L_ROOM - np.array([2.013, 2.027])  # no edge runs through centres of cells


def test_empty_space_is_the_union_of_the_shrunk_triangles():
    settings = TemplateSettings(empty_shrink=0.7)
    empty = certainly_empty(walls(), GRID, settings)
    union = shapely.union_all([shapely.Polygon(t) for t in empty_triangles(walls(), 0.7)])
    assert set(np.unique(empty)) == {0.0, 1.0}
    assert empty.sum() * 0.01 == pytest.approx(union.area, rel=0.02)
    rows, columns = np.indices(GRID.shape)
    centres = GRID.position_of(np.stack([rows, columns], axis=-1))
    inside = shapely.contains_xy(union.buffer(-0.01), centres[..., 0], centres[..., 1])
    assert (empty[inside] == 1).all()  # no holes


def test_empty_space_can_be_eroded_and_cut():
    plain = certainly_empty(walls(), GRID, TemplateSettings())
    eroded = certainly_empty(walls(), GRID, TemplateSettings(empty_erode_cells=1))
    cut = certainly_empty(walls(), GRID, TemplateSettings(empty_range_m=1.0))
    assert (eroded <= plain).all()
    assert 0 < eroded.sum() < plain.sum()
    assert cut.sum() * 0.01 == pytest.approx(np.pi, rel=0.1)


def test_recorded_walls_peak_at_one_or_sum_to_one():
    assert recorded_walls(walls(), GRID, TemplateSettings()).max() == pytest.approx(1)
    summed = recorded_walls(walls(), GRID, TemplateSettings(wall_scale="sum"))
    assert summed.sum() == pytest.approx(1, rel=1e-5)


def test_far_walls_weigh_less_where_asked():
    far = recorded_walls(walls(), GRID, TemplateSettings(range_sigma_m=2.0, wall_scale="sum"))
    near = recorded_walls(walls(), GRID, TemplateSettings(wall_scale="sum"))
    row = GRID.cell_of([5.0, 0.0])
    assert far[tuple(row)] < near[tuple(row)]


def test_the_anchor_is_the_observation_points_cell():
    scan = seen_from([2.0, 2.0], L_ROOM)
    for drift in (0.0, 0.4, np.pi / 2):
        template = build_template(scan, drift, 0.1)
        assert template.values[template.anchor] == pytest.approx(-1, abs=1e-3)  # empty around us
        assert template.drift_rad == drift
        assert not template.values.flags.writeable


def test_a_quarter_turn_of_the_scan_is_a_quarter_turn_of_the_template():
    scan = seen_from([2.0, 2.0], L_ROOM)
    plain = build_template(scan, 0.0, 0.1)
    turned = build_template(scan, np.pi / 2, 0.1)
    assert np.rot90(plain.values, -1) == pytest.approx(turned.values, abs=1e-4)  # rows grow up


def test_the_weight_of_empty_space_is_alpha():
    scan = seen_from([2.0, 2.0], L_ROOM)
    one = build_template(scan, 0.0, 0.1, TemplateSettings(empty_weight=1.0)).values
    ten = build_template(scan, 0.0, 0.1, TemplateSettings(empty_weight=10.0)).values
    assert ten.min() == pytest.approx(10 * one.min(), abs=0.05)
