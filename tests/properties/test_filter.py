"""What must hold of the filter for any frame, seed and number of threads."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.geometry import rotate
from palms.localizer import track
from palms.odometry import Odometry
from palms.particles import advance, start_everywhere
from palms.randomness import as_key
from palms.raster import rasterize
from palms.scan import Scan
from palms.settings import MotionSettings, Settings
from tests.worlds import two_rooms, walk

PLAN = two_rooms()
RASTER = rasterize(PLAN)
START = np.array([5.0, 3.9])
STEPS = [*[(0.5, 0.0)] * 4, *[(-0.5, 0.0)] * 7, *[(0.0, 0.6)] * 4, *[(0.6, 0.0)] * 24]
quick = settings(derandomize=True, deadline=None, max_examples=25)


def scan():
    near = np.linalg.norm(PLAN.segments_m.mean(axis=1) - START, axis=1) < 4.5
    return Scan(PLAN.segments_m[near] - START)


@quick
@given(st.floats(-80, 80), st.floats(-80, 80))
def test_moving_the_odom_frame_changes_nothing(x, y):
    by = np.array([x, y])
    here = walk(STEPS)
    there = Odometry(here.time_s, here.position_m + by, start_m=by)
    moved = Scan(scan().walls_m + by, position_m=by)
    one = track(RASTER, scan(), here, Settings.paper(), rng=2)
    two = track(RASTER, moved, there, Settings.paper(), rng=2)
    assert [e.stage for e in one] == [e.stage for e in two]
    assert two.position_m == pytest.approx(one.position_m, abs=1e-3)


@pytest.mark.parametrize("turn", [0.1, 1.9, -2.5])
def test_turning_the_odom_frame_leaves_the_place_and_turns_the_drift(turn):
    here = walk(STEPS)
    there = Odometry(here.time_s, rotate(here.position_m, turn))
    one = track(RASTER, scan(), here, Settings.paper(), rng=0)
    two = track(RASTER, Scan(rotate(scan().walls_m, turn)), there, Settings.paper(), rng=0)
    assert np.linalg.norm(two.position_m[-1] - one.position_m[-1]) < 0.5
    drifts = one.estimates[-1].drift_rad - turn - two.estimates[-1].drift_rad
    assert np.cos(drifts) == pytest.approx(1, abs=0.01)


@quick
@given(st.integers(0, 10_000), st.floats(-0.8, 0.8), st.floats(-0.8, 0.8))
def test_weights_sum_to_one_and_particles_stay_finite(seed, dx, dy):
    from palms.odometry import Move

    for motion in (MotionSettings(), Settings.authors().motion):
        particles = start_everywhere(RASTER, 200, as_key(seed))
        for step in range(5):
            particles, info = advance(
                particles, Move(step, dx, dy), RASTER, motion, as_key(seed).child(step)
            )
            assert particles.weight.sum() == pytest.approx(1)
            assert (particles.weight >= 0).all()
            assert np.isfinite(particles.position_m).all()
            assert 1 <= info.effective_sample_size <= 200 + 1e-6


_PRINT = """
import hashlib, numpy as np
from palms.localizer import recorded, track_trials
from palms.settings import Settings
from tests.properties.test_filter import RASTER, STEPS, scan
from tests.worlds import walk
recorded.SHARE = 1  # however little there is to do, it is shared
tracks = track_trials(RASTER, scan(), walk(STEPS), Settings.paper(), range(4), jobs={jobs})
print(hashlib.sha256(np.concatenate([t.position_m for t in tracks]).tobytes()).hexdigest())
"""


def test_same_seed_same_bytes_on_any_number_of_threads_and_processes():
    digests = set()
    for threads, jobs in (("1", 1), ("2", 2), ("2", 4)):
        environment = {**os.environ, "NUMBA_NUM_THREADS": threads, "OMP_NUM_THREADS": threads}
        done = subprocess.run(
            [sys.executable, "-c", _PRINT.format(jobs=jobs)], env=environment, check=True,
            capture_output=True, text=True,
        )  # fmt: skip
        digests.add(done.stdout)
    assert len(digests) == 1
