"""A room and a sample world for the tests of the simulator."""

import numpy as np
import pytest

from palms.evaluation.simulation import (
    RouteSettings,
    WorldNoise,
    free_space,
    make_world,
    sample_building,
)
from palms.floorplan import FloorPlan


@pytest.fixture(scope="session")
def room():
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    return FloorPlan(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1), name="room")


@pytest.fixture(scope="session")
def plan():
    return sample_building()


@pytest.fixture(scope="session")
def world(plan):
    return make_world(plan, WorldNoise(), np.random.default_rng(1))


@pytest.fixture(scope="session")
def free(world):
    return free_space(world, RouteSettings())
