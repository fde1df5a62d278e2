"""What nobody tells a method about a case: the noise, drawn anew for each."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import numpy as np

from palms.errors import SettingsError
from palms.evaluation.simulation.settings import (
    InertialNoise,
    PlanNoise,
    RouteSettings,
    ScannerNoise,
    VioNoise,
    WorldNoise,
)

__all__ = ["NuisanceRanges", "Nuisances", "draw_nuisances"]

_Range = tuple[float, float]
_DEG = math.radians(1.0)
_VIO = math.radians(1.0) / math.sqrt(60.0)
_SIDEWAYS = math.radians(1.0) * math.sqrt(0.65)


@dataclass(frozen=True, slots=True)
class Nuisances:
    """The noise parameters of one case; each is described where it is used.

    `world`, `plan`, `scanner`, `vio`, `inertial` and `route` return them as settings.

    Examples
    --------
    >>> nuisances = draw_nuisances(np.random.default_rng(0))
    >>> nuisances.scanner.normal_sd_m == nuisances.normal_sd_m
    True
    """

    thickness_m: float
    offset_sd_m: float
    missing_walls: float
    door_shut_share: float
    furniture_per_m: float
    furniture_tall_share: float
    moved_share: float
    missing_share: float
    merged_share: float
    door_undrawn_share: float
    column_undrawn_share: float
    scale_sd: float
    two_faces_share: float
    normal_sd_m: float
    angle_sd_rad: float
    end_sd_m: float
    merge_gap_m: float
    missed_share: float
    grazing_missed_share: float
    spurious_count: float
    glass_seen_share: float
    vio_heading_rad_per_sqrt_s: float
    vio_scale_sd: float
    vio_white_m_per_sqrt_m: float
    inertial_rate_sd_rad_per_s: float
    inertial_sideways_m_per_sqrt_m: float
    inertial_scale_sd: float
    inertial_leg_scale_sd: float
    jump_m: float
    jump_turn_rad: float
    step_m: float
    speed_m_s: float

    @property
    def world(self) -> WorldNoise:
        """How the world differs from what was planned."""
        return WorldNoise(
            thickness_m=self.thickness_m,
            offset_sd_m=self.offset_sd_m,
            offset_max_m=2.5 * self.offset_sd_m,
            missing_walls=round(self.missing_walls),
            door_shut_share=self.door_shut_share,
            furniture_per_m=self.furniture_per_m,
            furniture_tall_share=self.furniture_tall_share,
        )

    @property
    def plan(self) -> PlanNoise:
        """How the drawing differs from what was planned."""
        return PlanNoise(
            moved_share=self.moved_share,
            missing_share=self.missing_share,
            merged_share=self.merged_share,
            door_undrawn_share=self.door_undrawn_share,
            column_undrawn_share=self.column_undrawn_share,
            scale_sd=self.scale_sd,
            two_faces_share=self.two_faces_share,
        )

    @property
    def scanner(self) -> ScannerNoise:
        """What the scanner does."""
        return ScannerNoise(
            normal_sd_m=self.normal_sd_m,
            angle_sd_rad=self.angle_sd_rad,
            end_sd_m=self.end_sd_m,
            merge_gap_m=self.merge_gap_m,
            missed_share=self.missed_share,
            grazing_missed_share=self.grazing_missed_share,
            spurious_count=self.spurious_count,
            glass_seen_share=self.glass_seen_share,
        )

    @property
    def vio(self) -> VioNoise:
        """What visual-inertial odometry does."""
        return VioNoise(
            self.vio_heading_rad_per_sqrt_s, self.vio_scale_sd, self.vio_white_m_per_sqrt_m
        )

    @property
    def inertial(self) -> InertialNoise:
        """What inertial odometry does."""
        return InertialNoise(
            rate_sd_rad_per_s=self.inertial_rate_sd_rad_per_s,
            sideways_m_per_sqrt_m=self.inertial_sideways_m_per_sqrt_m,
            scale_sd=self.inertial_scale_sd,
            leg_scale_sd=self.inertial_leg_scale_sd,
        )

    @property
    def route(self) -> RouteSettings:
        """How this walker walks."""
        return RouteSettings(step_m=self.step_m, speed_m_s=self.speed_m_s)

    def to_json(self) -> dict[str, Any]:
        """Return them by name."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class NuisanceRanges:
    """Between what and what each noise parameter is drawn: wide, around the usual value.

    A range that begins above 0 is drawn on a logarithmic scale, another one evenly.

    Examples
    --------
    >>> NuisanceRanges().double("spurious_count").spurious_count
    (0.6, 4.0)
    """

    thickness_m: _Range = (0.09, 0.20)
    offset_sd_m: _Range = (0.02, 0.06)
    missing_walls: _Range = (0.0, 5.0)
    door_shut_share: _Range = (0.35, 0.85)
    furniture_per_m: _Range = (0.15, 0.55)
    furniture_tall_share: _Range = (0.2, 0.7)
    moved_share: _Range = (0.02, 0.12)
    missing_share: _Range = (0.02, 0.12)
    merged_share: _Range = (0.0, 0.08)
    door_undrawn_share: _Range = (0.0, 0.2)
    column_undrawn_share: _Range = (0.0, 0.5)
    scale_sd: _Range = (0.004, 0.015)
    two_faces_share: _Range = (0.25, 0.25)
    normal_sd_m: _Range = (0.02, 0.08)
    angle_sd_rad: _Range = (0.6 * _DEG, 2.4 * _DEG)
    end_sd_m: _Range = (0.06, 0.24)
    merge_gap_m: _Range = (0.6, 1.5)
    missed_share: _Range = (0.05, 0.25)
    grazing_missed_share: _Range = (0.2, 0.6)
    spurious_count: _Range = (0.3, 2.0)
    glass_seen_share: _Range = (0.05, 0.4)
    vio_heading_rad_per_sqrt_s: _Range = (0.4 * _VIO, 2.5 * _VIO)
    vio_scale_sd: _Range = (0.008, 0.04)
    vio_white_m_per_sqrt_m: _Range = (0.008, 0.05)
    inertial_rate_sd_rad_per_s: _Range = (3.0 * _DEG / 60.0, 15.0 * _DEG / 60.0)
    inertial_sideways_m_per_sqrt_m: _Range = (2.0 * _SIDEWAYS, 8.0 * _SIDEWAYS)
    inertial_scale_sd: _Range = (0.045, 0.15)
    inertial_leg_scale_sd: _Range = (0.05, 0.18)
    jump_m: _Range = (0.5, 3.0)
    jump_turn_rad: _Range = (3.0 * _DEG, 20.0 * _DEG)
    step_m: _Range = (0.55, 0.76)
    speed_m_s: _Range = (0.9, 1.5)

    def __post_init__(self) -> None:
        for field in fields(self):
            low, high = getattr(self, field.name)
            if not 0 <= low <= high < math.inf:
                raise SettingsError(
                    f"NuisanceRanges.{field.name}", expected="0 <= low <= high",
                    got=f"({low}, {high})",
                )  # fmt: skip

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Return the names of the nuisances.

        Examples
        --------
        >>> NuisanceRanges.names()[:2]
        ('thickness_m', 'offset_sd_m')
        """
        return tuple(field.name for field in fields(cls))

    def double(self, name: str) -> NuisanceRanges:
        """Return the ranges with one of them twice as high; shares end at 1.

        Raises
        ------
        SettingsError
            When there is no such nuisance.
        """
        if name not in self.names():
            raise SettingsError(
                "nuisance to double", expected=f"one of {', '.join(self.names())}", got=repr(name)
            )
        most = 1.0 if name.endswith("_share") else math.inf
        low, high = getattr(self, name)
        return replace(self, **{name: (min(2 * low, most), min(2 * high, most))})


def draw_nuisances(rng: np.random.Generator, ranges: NuisanceRanges | None = None) -> Nuisances:
    """Draw the noise parameters of a case.

    The same generator gives the same draw in whatever range: doubling one nuisance changes
    nothing but that.

    Parameters
    ----------
    rng : numpy.random.Generator
    ranges : NuisanceRanges, optional

    Examples
    --------
    >>> plain = draw_nuisances(np.random.default_rng(0))
    >>> ranges = NuisanceRanges().double("end_sd_m")
    >>> doubled = draw_nuisances(np.random.default_rng(0), ranges)
    >>> round(doubled.end_sd_m / plain.end_sd_m, 6), doubled.jump_m == plain.jump_m
    (2.0, True)
    """
    ranges = ranges or NuisanceRanges()
    drawn = {}
    for name in NuisanceRanges.names():
        low, high = getattr(ranges, name)
        at = float(rng.random())
        drawn[name] = low * (high / low) ** at if low > 0 else low + (high - low) * at
    return Nuisances(**drawn)
