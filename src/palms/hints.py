"""Hints: what somebody says of where the phone is, soft and perhaps wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geometry import FloatArray, check_finite
from palms.raster import PlanRaster

__all__ = ["Hint"]

MARGIN_M = 1.0  # ours: in a room is also at its door


@dataclass(frozen=True, slots=True)
class Hint:
    """Somebody says that the phone is near a place, or in a room.

    Parameters
    ----------
    place_m : array_like (2,), optional
        In the map frame; this or `room`.
    radius_m : float
        So near to it.
    room : str, optional
        Name of a room of the plan.
    probability : float
        How often such a hint is true.

    Raises
    ------
    InputError
        When both are given or neither, or a number is out of its range.

    Examples
    --------
    >>> Hint(place_m=(3.0, 4.0)).radius_m
    5.0
    """

    place_m: FloatArray | None = None
    radius_m: float = 5.0
    room: str | None = None
    probability: float = 0.9

    def __post_init__(self) -> None:
        if (self.place_m is None) == (self.room is None):
            raise InputError("hint", expected="a place or a room", got="both or neither")
        if self.place_m is not None:
            place = check_finite(self.place_m, "the hint's place", (2,))
            object.__setattr__(self, "place_m", place)
        if not self.radius_m > 0:
            raise InputError("the hint's radius", expected="above 0 m", got=str(self.radius_m))
        if not 0 < self.probability < 1:
            raise InputError(
                "the hint's probability", expected="between 0 and 1", got=str(self.probability)
            )

    def ratio(self, position_m: FloatArray, raster: PlanRaster) -> FloatArray:
        """Return how much more the hint speaks for positions (N, 2) than for any place.

        Bayes' rule with an even prior over the inside of the building.

        Raises
        ------
        InputError
            When the plan has no such room, or nothing inside lies near the place.
        """
        grid = raster.grid
        cells = np.argwhere(raster.inside)
        share = float(self._holds(grid.position_of(cells), raster).mean())
        if share == 0:
            raise InputError(
                "hint", expected="a place in the building", got=str(self.place_m),
                fix="check its coordinates, or give a larger radius",
            )  # fmt: skip
        share = min(share, 1 - 1e-9)
        inside, outside = self.probability / share, (1 - self.probability) / (1 - share)
        return np.where(self._holds(position_m, raster), inside, outside)

    def _holds(self, position_m: FloatArray, raster: PlanRaster) -> npt.NDArray[np.bool_]:
        if self.place_m is not None:
            away: FloatArray = np.linalg.norm(position_m - self.place_m, axis=1)
            return np.asarray(away <= self.radius_m)
        import shapely

        rooms = [room for room in raster.plan.rooms if room.name == self.room]
        if not rooms:
            known = ", ".join(sorted({room.name for room in raster.plan.rooms})[:8])
            raise InputError(
                "hint", expected=f"one of the plan's rooms ({known or 'it has none'})",
                got=repr(self.room), fix="palms plan info lists them",
            )  # fmt: skip
        area = shapely.union_all([shapely.Polygon(r.polygon_m) for r in rooms]).buffer(MARGIN_M)
        shapely.prepare(area)
        return np.asarray(shapely.contains_xy(area, position_m[:, 0], position_m[:, 1]))
