"""One small building, one scan, one walk, for all pictures."""

import itertools

import numpy as np
import pytest

from palms import FloorPlan, Odometry, Room, Scan, SegmentClass, Settings, locate, rasterize, track
from palms.geometry import rotate
from palms.plot import Recorder, Story

START_M, DRIFT_RAD = np.array([2.0, 1.0]), 0.5
OUTLINE = [(0, 0), (12, 0), (12, 3), (20, 3), (20, 9), (8, 9), (8, 5), (0, 5)]


def ring(corners):
    return [[a, b] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


@pytest.fixture(scope="session")
def plan():
    segments = [*ring(OUTLINE), [(12, 3), (12, 6)], [(12, 6), (12, 7)], [(12, 7), (12, 9)],
                [(4, 5), (6, 5)], [(8, 4), (8, 5)]]  # fmt: skip
    classes = np.zeros(len(segments), np.uint8)
    classes[-4], classes[-2], classes[-1] = SegmentClass.DOOR, SegmentClass.GLASS, 2
    rooms = (
        Room("West hall", [(0, 0), (12, 0), (12, 9), (8, 9), (8, 5), (0, 5)]),
        Room("Lab 7", [(12, 3), (20, 3), (20, 9), (12, 9)]),
    )
    return FloorPlan(segments, classes, rooms, name="annex", level="1")


@pytest.fixture(scope="session")
def raster(plan):
    return rasterize(plan)


@pytest.fixture(scope="session")
def scan():
    seen = np.array([[(0, 0), (6, 0)], [(0, 0), (0, 5)], [(0, 5), (5, 5)], [(12, 0), (12, 2)]])
    return Scan(rotate(seen - START_M, -DRIFT_RAD))


@pytest.fixture(scope="session")
def truth_m():
    corners = np.array([START_M, [10, 1.0], [10, 6.5], [18, 6.5], [18, 4]])
    legs = [np.linspace(a, b, 16)[1:] for a, b in itertools.pairwise(corners)]
    return np.concatenate(legs)


@pytest.fixture(scope="session")
def walk(truth_m):
    time_s = 0.5 + 0.5 * np.arange(len(truth_m))
    return Odometry(time_s, rotate(truth_m - START_M, -DRIFT_RAD))


def tell(raster, scan, walk, truth_m, settings):
    recorder = Recorder(every=2)
    answers = track(raster, scan, walk, settings, 0, recorder)
    by_scan = settings.start.source == "scan"
    found = locate(raster, scan, settings) if by_scan else None
    return Story(raster, walk, answers, recorder, scan, found, truth_m, START_M, settings)


@pytest.fixture(scope="session")
def story(raster, scan, walk, truth_m):
    return tell(raster, scan, walk, truth_m, Settings.paper().with_particles(500))


@pytest.fixture(scope="session")
def blind(raster, scan, walk):
    """Two steps of a uniform start, without a truth: nothing is found."""
    short = Odometry(walk.time_s[:2], walk.position_m[:2])
    return tell(raster, scan, short, None, Settings.uniform().with_particles(300))
