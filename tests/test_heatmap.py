import numpy as np
import pytest

from palms.floorplan import FloorPlan
from palms.heatmap import correlate, find_candidates, match, scan_drifts
from palms.raster import rasterize
from palms.settings import CandidateSettings, RasterSettings, Settings
from palms.template import build_template
from tests.compiled import twins
from tests.worlds import L_ROOM, seen_from, two_rooms


def heatmaps(cell=0.1, point=(5.0, 3.9), drift=0.0):
    plan = two_rooms()
    raster = rasterize(plan, RasterSettings(cell_size_m=cell))
    near = np.linalg.norm(plan.segments_m.mean(axis=1) - point, axis=1) < 5
    scan = seen_from(point, plan.segments_m[near], drift)
    return match(scan, raster, scan_drifts(scan, raster), Settings().template)


@pytest.mark.parametrize("k", range(4))
def test_correlation_equals_four_loops(k):
    maps = heatmaps(cell=0.4)
    template = maps.template(k)
    slow = twins.correlate(maps.raster.density, template.values, template.anchor)
    assert maps.scores(k) == pytest.approx(slow, abs=2e-4)
    assert correlate(maps.raster, template) == pytest.approx(slow, abs=2e-4)


def test_nothing_is_invented_beyond_the_border():
    """A template far larger than the plan: no wrap-around, no reflection."""
    raster = rasterize(FloorPlan([[[0, 0], [2, 0]]]), RasterSettings(cell_size_m=0.25))
    template = build_template(seen_from([0, 0], L_ROOM), 0.3, 0.25)
    slow = twins.correlate(raster.density, template.values, template.anchor)
    assert correlate(raster, template) == pytest.approx(slow, abs=1e-4)


def test_the_plans_transform_is_made_once_for_all_drifts():
    maps = heatmaps()
    assert len(list(maps)) == 4
    assert len(maps.raster._spectra) == 1


@pytest.mark.parametrize("quantile", [0.9, 0.99, 0.999])
def test_candidates_are_the_cells_above_the_quantile_of_all_maps_together(quantile):
    maps = heatmaps(cell=0.2)
    everything = np.stack(list(maps))
    threshold = np.quantile(everything, quantile, method="higher")
    expected = {tuple(i) for i in np.argwhere(everything >= threshold)}
    found = find_candidates(maps, CandidateSettings(quantile=quantile))
    cells = zip(found.label.tolist(), *found.cells.T.tolist(), strict=True)
    assert set(cells) == expected
    assert np.exp(found.log_weight).sum() == pytest.approx(1)
    assert found.score.min() == np.float32(threshold)


def test_the_captions_way_takes_the_top_of_each_map():
    maps = heatmaps(cell=0.2)
    found = find_candidates(maps, CandidateSettings(quantile=0.99, per_map=True))
    counts = np.bincount(found.label)
    assert (counts >= 0.01 * maps.grid.size).all()
    share = np.bincount(found.label, np.exp(found.log_weight))
    assert share == pytest.approx(np.full(4, 0.25))


def test_ties_at_the_threshold_are_all_kept():
    raster = rasterize(FloorPlan([[[0, 0], [30, 0]]]), RasterSettings(cell_size_m=0.5))
    scan = seen_from([0.0, 1.0], [[[-2, 0], [2, 0]]])
    maps = match(scan, raster, [0.0])
    found = find_candidates(maps)
    assert (found.score >= found.score.min()).all()
    assert len(found) >= 0.01 * maps.grid.size


def test_the_authors_align_the_scan_with_the_axes_of_the_map():
    maps = heatmaps(drift=0.3)
    ours = scan_drifts(maps.scan, maps.raster, Settings.paper())
    theirs = scan_drifts(maps.scan, maps.raster, Settings.authors())
    assert ours == pytest.approx(theirs, abs=1e-6)  # the plan is along the axes
    assert np.abs(ours - 0.3).min() < 1e-3


def test_scores_can_be_floored_at_zero():
    maps = heatmaps()
    authors = match(maps.scan, maps.raster, maps.drifts_rad, Settings.authors().template)
    assert authors.scores(0).min() == 0
