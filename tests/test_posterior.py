import dataclasses

import numpy as np
import pytest

from palms.geometry import wrap_angle
from palms.hints import Hint
from palms.observation import log_likelihood
from palms.places import find_places
from palms.posterior import hinted, judged, posterior
from palms.raster import rasterize
from palms.settings import ObservationSettings
from tests.worlds import seen_from, two_rooms

PLAN = two_rooms()
RASTER = rasterize(PLAN)
POINT = np.array([5.0, 3.9])
NEAR = PLAN.segments_m[np.linalg.norm(PLAN.segments_m.mean(axis=1) - POINT, axis=1) < 4.5]
OURS = ObservationSettings()


def test_shares_sum_to_one_and_gather_around_the_truth():
    found = posterior(seen_from(POINT, NEAR, 0.35), RASTER)
    share = np.exp(found.log_weight)
    assert share.sum() == pytest.approx(1)
    assert share[np.linalg.norm(found.position_m - POINT, axis=1) < 0.5].sum() > 0.6
    assert found.mass == pytest.approx(1 - OURS.elsewhere)


def test_drifts_are_finer_than_those_that_were_tried():
    found = posterior(seen_from(POINT, NEAR, 0.35 + OURS.drift_step_rad / 2), RASTER)
    best = find_places(found)[0]
    assert wrap_angle(best.drift_rad - 0.35 - OURS.drift_step_rad / 2) == pytest.approx(0, abs=0.02)
    assert best.x_m == pytest.approx(POINT[0], abs=0.1)
    assert best.y_m == pytest.approx(POINT[1], abs=0.1)


def test_it_is_the_integral_of_the_likelihood():
    """Brute force on poses around the truth, where nearly all of it lies."""
    found = posterior(seen_from(POINT, NEAR, 0.35), RASTER)
    rng, n, reach_m, reach_rad = np.random.default_rng(0), 200_000, 0.5, 0.2
    place = POINT + rng.uniform(-reach_m, reach_m, (n, 2))
    drift = 0.35 + rng.uniform(-reach_rad, reach_rad, n)
    nats = OURS.strength * log_likelihood(found.points, RASTER, place, drift, OURS)
    inside_m2 = RASTER.inside.sum() * RASTER.grid.cell_size_m**2
    part = 4 * reach_m**2 * 2 * reach_rad / (inside_m2 * 2 * np.pi)
    near = (np.abs(found.position_m - POINT).max(axis=1) < reach_m) & (
        np.abs(wrap_angle(found.drift_rad - 0.35)) < reach_rad
    )
    here = found.log_mean + np.log(np.exp(found.log_weight)[near].sum())
    assert here == pytest.approx(np.log(np.exp(nats).mean() * part), abs=0.3)


def test_it_is_always_the_same():
    one, two = (posterior(seen_from(POINT, NEAR, 0.35), RASTER) for _ in range(2))
    assert np.array_equal(one.position_m, two.position_m)
    assert np.array_equal(one.log_weight, two.log_weight)


def test_how_poses_are_proposed_does_not_matter():
    from palms.observation import scan_points, search

    scan = seen_from(POINT, NEAR, 0.35)
    flatter = dataclasses.replace(OURS, search_power=0.15)
    one = posterior(scan, RASTER)
    two = judged(search(scan, RASTER, flatter), scan_points(scan), RASTER, flatter)
    for found in (one, two):
        near = np.linalg.norm(found.position_m - POINT, axis=1) < 0.5
        assert np.exp(found.log_weight)[near].sum() > 0.6
    assert one.log_mean == pytest.approx(two.log_mean, abs=0.3)


@pytest.mark.parametrize("at", [POINT, POINT + 6.0], ids=["right", "wrong"])
def test_a_hint_weighs_places_and_what_lies_elsewhere(at):
    found = posterior(seen_from(POINT, NEAR, 0.35), RASTER)
    hint = Hint(at, 3.0, probability=0.8)
    ratio = hint.ratio(found.position_m, RASTER)
    there = np.linalg.norm(found.position_m - at, axis=1) <= 3.0
    assert (ratio[there] > 1).all()
    assert (ratio[~there] < 1).all()
    after = hinted(found, hint, RASTER)
    before, weight = np.exp(found.log_weight), np.exp(after.log_weight)
    assert weight.sum() == pytest.approx(1)
    np.testing.assert_allclose(weight / weight[0], before * ratio / (before[0] * ratio[0]))
    kept = found.mass * float(before @ ratio)  # what is anywhere has a ratio of 1 in the mean
    assert after.mass == pytest.approx(kept / (kept + 1 - found.mass))
    assert (after.mass > found.mass) == (float(before @ ratio) > 1)
    np.testing.assert_array_equal(after.position_m, found.position_m)
