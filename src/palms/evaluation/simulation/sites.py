"""A building that was built, as it really is and as it is drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from palms.building import Building
from palms.errors import InputError
from palms.evaluation.simulation.drawing import Stretch, draw_plan, draw_stretch
from palms.evaluation.simulation.levels import Tower
from palms.evaluation.simulation.nuisances import NuisanceRanges, Nuisances, draw_nuisances
from palms.evaluation.simulation.routes import free_space
from palms.evaluation.simulation.settings import RouteSettings
from palms.evaluation.simulation.starts import Place
from palms.evaluation.simulation.world import make_world
from palms.floorplan import FloorPlan

__all__ = ["Site", "make_site", "random_for"]

_PURPOSES = ("nuisances", "world", "drawing", "start", "walk", "odometry", "events")


def random_for(purpose: str, seed: int, *numbers: int) -> np.random.Generator:
    """Return the random numbers for one purpose: the order of doing things does not matter.

    Parameters
    ----------
    purpose : str
    seed : int
        Of the building.
    *numbers : int
        Of level, start and walk.

    Examples
    --------
    >>> a, b = (random_for("walk", 7, 0, k).random() for k in (0, 1))
    >>> a != b, a == random_for("walk", 7, 0, 0).random()
    (True, True)
    """
    if seed < 0:
        raise InputError("seed", expected="0 or more", got=str(seed))
    return np.random.default_rng([0x51, _PURPOSES.index(purpose), seed, *numbers])


@dataclass(frozen=True, slots=True)
class Site:
    """A building in the world, and its drawings.

    Parameters
    ----------
    name : str
        Of the scene; that of its first drawing.
    seed : int
    building : Building
        As planned.
    drawings : tuple of FloorPlan
        What methods are given, level by level; the map frame is theirs.
    places : tuple of Place
        The worlds, level by level, in the building's own metres.
    stretch : Stretch
        Turns the building's metres into the map frame.
    nuisances : Nuisances
        Of world and drawings.

    Examples
    --------
    >>> from palms.evaluation.simulation import sample_building
    >>> site = make_site(Building((sample_building(),)), seed=3)
    >>> site.name, len(site.places)
    ('sample', 1)
    """

    name: str
    seed: int
    building: Building
    drawings: tuple[FloorPlan, ...]
    places: tuple[Place, ...]
    stretch: Stretch
    nuisances: Nuisances

    @property
    def tower(self) -> Tower:
        """Its levels, to walk on."""
        names = [plan.level or "" for plan in self.drawings]
        return Tower(self.places, names, self.building.stairs)


def make_site(building: Building, seed: int, ranges: NuisanceRanges | None = None) -> Site:
    """Build a world on every level and draw plans of them that have gone stale.

    Parameters
    ----------
    building : Building
    seed : int
    ranges : NuisanceRanges, optional

    Examples
    --------
    >>> from palms.evaluation.simulation import generate_levels
    >>> site = make_site(generate_levels("office", 7, 1), seed=7)
    >>> site.drawings[0].name
    'office-7'
    """
    nuisances = draw_nuisances(random_for("nuisances", seed), ranges)
    noise = nuisances.plan
    stretch = draw_stretch(building.levels[0], noise, random_for("drawing", seed, 0))
    styled = random_for("drawing", seed, 1).random() < noise.two_faces_share
    noise = replace(noise, two_faces_share=float(styled))  # one hand draws all levels
    drawings, places = [], []
    for k, plan in enumerate(building.levels):
        world = make_world(plan, nuisances.world, random_for("world", seed, k))
        places.append(Place(world, free_space(world, RouteSettings())))
        drawn = draw_plan(plan, noise, stretch, random_for("drawing", seed, 2, k))
        name = plan.name if k == 0 else f"{plan.name}-level-{plan.level}"
        drawings.append(replace(drawn, name=name))
    name = building.levels[0].name
    return Site(name, seed, building, tuple(drawings), tuple(places), stretch, nuisances)
