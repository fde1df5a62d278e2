"""The method on the sample building: coarse enough to hold on any processor."""

import numpy as np
import pytest

from palms.io import open_dataset
from palms.localizer import locate, track_trials
from palms.raster import rasterize
from palms.sample import sample_folder
from palms.settings import Settings


@pytest.fixture(scope="module")
def case():
    return open_dataset(sample_folder()).cases[0]


def test_the_scans_true_place_is_among_the_candidates(case):
    found = locate(case.plan(), case.scan(), Settings.paper())
    label = case.label()
    near = np.linalg.norm(found.position_m - label.position_m, axis=1) < 0.3
    right = np.abs(np.angle(np.exp(1j * (found.drift_rad - label.drift_rad)))) < np.radians(5)
    assert (near & right).any()


def test_the_sample_walk_is_localized_rightly_in_most_trials(case):
    raster, walk = rasterize(case.plan()), case.walk()
    tracks = list(track_trials(raster, case.scan(), walk.odometry(), Settings.paper(), range(8)))
    truth = walk.truth.position_m
    right = 0
    for found in tracks:
        assert found.localized_at_s is not None
        error = np.linalg.norm(found.position_m - truth, axis=1)
        right += error[-1] < 1.0
    assert right >= 7


def test_the_scan_beats_uniform(case):
    """The paper's claim, on one walk: more of it is right with the scan than without."""
    raster, walk = rasterize(case.plan()), case.walk()
    near = {}
    for method in ("paper", "uniform"):
        settings = Settings.for_method(method)
        tracks = track_trials(raster, case.scan(), walk.odometry(), settings, range(4))
        errors = [np.linalg.norm(t.position_m - walk.truth.position_m, axis=1) for t in tracks]
        near[method] = np.mean(np.array(errors) < 1.0)
    assert near["paper"] > near["uniform"]
