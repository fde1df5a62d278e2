"""Simulated worlds: a building, a scan in it, a walk through it, and a phone's errors.

::

    generate_building -> FloorPlan -> make_world -> World -> take_scan  -> SimulatedScan
                             │                        └──> free_space -> plan_route -> walk
                         draw_plan                                                      │
                    (what methods are given)      vio_odometry, inertial_odometry <─ TrueWalk

    make_site -> simulate_site -> SimulatedCase -> write_simulated

Randomness is a numpy Generator passed as `rng`: same seed, same world.
"""

from palms.evaluation.simulation.cases import (
    CaseSettings,
    SimulatedCase,
    Start,
    simulate_start,
    simulate_walk,
)
from palms.evaluation.simulation.depth_camera import DepthCamera, DepthSequence, take_depth
from palms.evaluation.simulation.drawing import Stretch, draw_plan, draw_stretch
from palms.evaluation.simulation.generator import generate_building, generate_levels, is_angled
from palms.evaluation.simulation.layout import Passage, Pose, plan_of_rooms
from palms.evaluation.simulation.levels import Tower, walk_levels
from palms.evaluation.simulation.noise import drift_of, inertial_odometry, vio_odometry, with_jump
from palms.evaluation.simulation.nuisances import NuisanceRanges, Nuisances, draw_nuisances
from palms.evaluation.simulation.output import (
    Count,
    read_nuisances,
    simulate_site,
    write_simulated,
)
from palms.evaluation.simulation.pace import resampled, with_facing, with_pause, with_stops
from palms.evaluation.simulation.rays import cast_rays
from palms.evaluation.simulation.routes import FreeSpace, Ways, find_ways, free_space
from palms.evaluation.simulation.sample_building import sample_building
from palms.evaluation.simulation.scanner import SimulatedScan, take_scan
from palms.evaluation.simulation.settings import (
    InertialNoise,
    PlanNoise,
    RouteSettings,
    ScannerNoise,
    StartSettings,
    VioNoise,
    WorldNoise,
)
from palms.evaluation.simulation.sites import Site, make_site, random_for
from palms.evaluation.simulation.starts import Place, choose_start, is_sensible
from palms.evaluation.simulation.styles import BUILDING_KINDS
from palms.evaluation.simulation.walker import TrueWalk, plan_route, walk
from palms.evaluation.simulation.world import World, make_world

__all__ = [
    "BUILDING_KINDS",
    "CaseSettings",
    "Count",
    "DepthCamera",
    "DepthSequence",
    "FreeSpace",
    "InertialNoise",
    "NuisanceRanges",
    "Nuisances",
    "Passage",
    "Place",
    "PlanNoise",
    "Pose",
    "RouteSettings",
    "ScannerNoise",
    "SimulatedCase",
    "SimulatedScan",
    "Site",
    "Start",
    "StartSettings",
    "Stretch",
    "Tower",
    "TrueWalk",
    "VioNoise",
    "Ways",
    "World",
    "WorldNoise",
    "cast_rays",
    "choose_start",
    "draw_nuisances",
    "draw_plan",
    "draw_stretch",
    "drift_of",
    "find_ways",
    "free_space",
    "generate_building",
    "generate_levels",
    "inertial_odometry",
    "is_angled",
    "is_sensible",
    "make_site",
    "make_world",
    "plan_of_rooms",
    "plan_route",
    "random_for",
    "read_nuisances",
    "resampled",
    "sample_building",
    "simulate_site",
    "simulate_start",
    "simulate_walk",
    "take_depth",
    "take_scan",
    "vio_odometry",
    "walk",
    "walk_levels",
    "with_facing",
    "with_jump",
    "with_pause",
    "with_stops",
    "write_simulated",
]
