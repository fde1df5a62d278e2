"""Hints: what somebody says of where the phone is, soft and perhaps wrong.

A hint of a place fades as the phone walks on, since walls have spoken meanwhile
(docs/explanation/filter.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.building import Atlas
from palms.errors import InputError
from palms.geometry import FloatArray, check_finite
from palms.particles import Particles, reweight
from palms.raster import PlanRaster
from palms.settings import HintSettings

__all__ = ["Hint", "Said", "faded", "heard"]

MARGIN_M = 1.0  # ours: in a room is also at its door
SPENT_NATS = 0.01  # ours: a hint that says less than this is forgotten


class Said(NamedTuple):
    """What a hint says about places.

    Attributes
    ----------
    ratio : (N,)
        How much more it speaks for each of them than for any place.
    fading_nats : (N,)
        Logarithm of what of that fades: all but the level, which walls cannot tell.
    """

    ratio: FloatArray
    fading_nats: FloatArray

    def split(self, n: int) -> tuple[Said, Said]:
        """Return what it says about the first n places, and about the others."""
        return Said(self.ratio[:n], self.fading_nats[:n]), Said(
            self.ratio[n:], self.fading_nats[n:]
        )


@dataclass(frozen=True, slots=True)
class Hint:
    """Somebody says that the phone is near a place, in a room, or on a level.

    Parameters
    ----------
    place_m : array_like (2,), optional
        In the map frame; not together with `room`.
    radius_m : float
        So near to it.
    room : str, optional
        Name of a room of the plan.
    level : str, optional
        Name of a level of the building, alone or with a place or a room.
    probability : float
        How often such a hint is true.

    Raises
    ------
    InputError
        When place and room are given, or nothing is, or a number is out of its range.

    Examples
    --------
    >>> Hint(place_m=(3.0, 4.0)).radius_m
    5.0
    """

    place_m: FloatArray | None = None
    radius_m: float = 5.0
    room: str | None = None
    level: str | None = None
    probability: float = 0.9

    def __post_init__(self) -> None:
        if self.place_m is not None and self.room is not None:
            raise InputError("hint", expected="a place or a room", got="both")
        if self.place_m is None and self.room is None and self.level is None:
            raise InputError("hint", expected="a place, a room or a level", got="none of them")
        if self.place_m is not None:
            place = check_finite(self.place_m, "the hint's place", (2,))
            object.__setattr__(self, "place_m", place)
        if not self.radius_m > 0:
            raise InputError("the hint's radius", expected="above 0 m", got=str(self.radius_m))
        if not 0 < self.probability < 1:
            raise InputError(
                "the hint's probability", expected="between 0 and 1", got=str(self.probability)
            )

    def ratio(
        self, position_m: FloatArray, raster: PlanRaster, atlas: Atlas | None = None
    ) -> FloatArray:
        """Return how much more the hint speaks for positions (N, 2) than for any place.

        Bayes' rule with an even prior over the inside of the building.

        Parameters
        ----------
        position_m : (N, 2)
            In the map frame, or on the atlas where there is one.
        raster : PlanRaster
        atlas : Atlas, optional
            Of a building of several levels.

        Raises
        ------
        InputError
            When the plan has no such room or level, or nothing inside lies near the place.
        """
        cells = raster.grid.position_of(np.argwhere(raster.inside))
        share = float(self._holds(cells, raster, atlas).mean())
        if share == 0:
            raise InputError(
                "hint", expected="a place in the building", got=self._words(),
                fix="check its coordinates, or give a larger radius",
            )  # fmt: skip
        share = min(share, 1 - 1e-9)
        inside, outside = self.probability / share, (1 - self.probability) / (1 - share)
        return np.where(self._holds(position_m, raster, atlas), inside, outside)

    def says(self, position_m: FloatArray, raster: PlanRaster, atlas: Atlas | None = None) -> Said:
        """Return what it says about positions (N, 2), and what of that fades; see `ratio`."""
        ratio = self.ratio(position_m, raster, atlas)
        if self.level is None:
            return Said(ratio, np.log(ratio))
        lasting = replace(self, place_m=None, room=None).ratio(position_m, raster, atlas)
        return Said(ratio, np.log(ratio / lasting))

    def _words(self) -> str:
        place = None if self.place_m is None else "{:g}, {:g}".format(*self.place_m)
        said = {"place": place, "room": self.room, "level": self.level}
        return ", ".join(f"{name} {what}" for name, what in said.items() if what is not None)

    def _holds(
        self, position_m: FloatArray, raster: PlanRaster, atlas: Atlas | None
    ) -> npt.NDArray[np.bool_]:
        holds = np.ones(len(position_m), np.bool_)
        if self.level is not None:
            holds &= _on_level(self.level, position_m, raster, atlas)
        if self.place_m is not None:
            folded = position_m if atlas is None else atlas.folded(position_m)
            holds &= np.linalg.norm(folded - self.place_m, axis=1) <= self.radius_m
        if self.room is not None:
            holds &= _in_room(self.room, position_m, raster)
        return holds


def _on_level(
    name: str, position_m: FloatArray, raster: PlanRaster, atlas: Atlas | None
) -> npt.NDArray[np.bool_]:
    if atlas is not None:
        return np.asarray(atlas.level_of(position_m) == atlas.building.index(name))
    if raster.plan.level != name:
        raise InputError(
            "hint", expected=f"the plan's level ({raster.plan.level or 'it has no name'})",
            got=repr(name), fix="give the plans of the other levels, too",
        )  # fmt: skip
    return np.ones(len(position_m), np.bool_)


def _in_room(name: str, position_m: FloatArray, raster: PlanRaster) -> npt.NDArray[np.bool_]:
    import shapely

    rooms = [room for room in raster.plan.rooms if room.name == name]
    if not rooms:
        known = ", ".join(sorted({room.name for room in raster.plan.rooms})[:8])
        raise InputError(
            "hint", expected=f"one of the plan's rooms ({known or 'it has none'})",
            got=repr(name), fix="palms plan info lists them",
        )  # fmt: skip
    area = shapely.union_all([shapely.Polygon(r.polygon_m) for r in rooms]).buffer(MARGIN_M)
    shapely.prepare(area)
    return np.asarray(shapely.contains_xy(area, position_m[:, 0], position_m[:, 1]))


def heard(particles: Particles, said: Said) -> tuple[Particles, float]:
    """Weigh particles by a hint; return the logarithm of the share that they kept, too."""
    before = 0.0 if particles.hint_nats is None else particles.hint_nats
    weighed, kept = reweight(particles, said.ratio)
    return replace(weighed, hint_nats=before + said.fading_nats), kept


def faded(particles: Particles, walked_m: float, settings: HintSettings) -> Particles:
    """Take back some of what hints said, after some metres.

    Examples
    --------
    >>> two = Particles([[0, 0], [9, 0]], [0, 0], [1, 1], [0, 0], [0.5, 0.5])
    >>> told, _ = heard(two, Said(np.array([4.0, 1.0]), np.log([4.0, 1.0])))
    >>> settings = HintSettings(fade_m=20.0)
    >>> later = faded(told, settings.fade_m * math.log(2), settings)
    >>> told.weight.round(3).tolist(), later.weight.round(3).tolist()
    ([0.8, 0.2], [0.667, 0.333])
    """
    if particles.hint_nats is None:
        return particles
    left = math.exp(-walked_m / settings.fade_m) * particles.hint_nats
    weighed, _ = reweight(particles, np.exp(left - particles.hint_nats))
    spent = float(np.abs(left).max()) < SPENT_NATS
    return replace(weighed, hint_nats=None if spent else left)
