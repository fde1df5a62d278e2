"""Simulated worlds: a building, a scan in it, a walk through it, and a phone's errors.

::

    FloorPlan -> make_world -> World -> take_scan  -> SimulatedScan
                                 └──> free_space -> plan_route -> walk -> TrueWalk
                                                  vio_odometry, inertial_odometry <─┘

Randomness is a numpy Generator passed as `rng`: same seed, same world.
"""

from palms.evaluation.simulation.layout import Passage, Pose, plan_of_rooms
from palms.evaluation.simulation.noise import inertial_odometry, vio_odometry
from palms.evaluation.simulation.rays import cast_rays
from palms.evaluation.simulation.routes import FreeSpace, Ways, find_ways, free_space
from palms.evaluation.simulation.sample_building import sample_building
from palms.evaluation.simulation.scanner import SimulatedScan, take_scan
from palms.evaluation.simulation.settings import (
    InertialNoise,
    RouteSettings,
    ScannerNoise,
    VioNoise,
    WorldNoise,
)
from palms.evaluation.simulation.walker import TrueWalk, plan_route, walk
from palms.evaluation.simulation.world import World, make_world

__all__ = [
    "FreeSpace",
    "InertialNoise",
    "Passage",
    "Pose",
    "RouteSettings",
    "ScannerNoise",
    "SimulatedScan",
    "TrueWalk",
    "VioNoise",
    "Ways",
    "World",
    "WorldNoise",
    "cast_rays",
    "find_ways",
    "free_space",
    "inertial_odometry",
    "make_world",
    "plan_of_rooms",
    "plan_route",
    "sample_building",
    "take_scan",
    "vio_odometry",
    "walk",
]
