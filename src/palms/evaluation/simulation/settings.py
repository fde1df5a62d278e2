"""Every number of the simulation, with its unit and where it comes from.

"Measured" means: fitted to recordings of phones; "simulation" means: chosen for plausible
simulated worlds; "ours" means: a matter of taste.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from palms.errors import SettingsError

__all__ = [
    "InertialNoise",
    "PlanNoise",
    "RouteSettings",
    "ScannerNoise",
    "StartSettings",
    "VioNoise",
    "WorldNoise",
]


def _check_not_negative(values: object) -> None:
    for name in values.__slots__:  # type: ignore[attr-defined]
        number = getattr(values, name)
        if math.isnan(number) or number < 0:
            raise SettingsError(
                f"{type(values).__name__}.{name}", expected="0 or more", got=str(number)
            )


@dataclass(frozen=True, slots=True)
class WorldNoise:
    """How the real world differs from the floor plan.

    Parameters
    ----------
    thickness_m : float
        Mean thickness of walls (simulation: light partitions).
    thickness_sd_m : float
        Its spread from wall line to wall line (simulation).
    offset_sd_m, offset_max_m : float
        Spread and bound of a wall line's offset from the plan (simulation: plans are off
        by up to 10 cm).
    missing_walls : int
        Short inner walls that the plan has and the world has not (simulation).
    door_shut_share : float
        Probability that a door is shut (measured: 60 %).
    door_recess_m : float
        A shut door lies at most this far from the middle of its wall (simulation).
    furniture_per_m : float
        Pieces along each metre of wall (simulation).
    furniture_tall_share : float
        Share of the pieces that hide the wall behind them (simulation).
    furniture_clear_m : float
        Free width that people leave in front of furniture (ours).

    Examples
    --------
    >>> WorldNoise.none().thickness_m
    0.0
    """

    thickness_m: float = 0.13
    thickness_sd_m: float = 0.015
    offset_sd_m: float = 0.04
    offset_max_m: float = 0.10
    missing_walls: int = 2
    door_shut_share: float = 0.6
    door_recess_m: float = 0.04
    furniture_per_m: float = 0.3
    furniture_tall_share: float = 0.4
    furniture_clear_m: float = 1.05

    def __post_init__(self) -> None:
        _check_not_negative(self)

    @classmethod
    def none(cls) -> WorldNoise:
        """Return the world that is exactly its plan: thin walls, doors open, no furniture."""
        return cls(*(0.0,) * 4, 0, *(0.0,) * 5)


@dataclass(frozen=True, slots=True)
class PlanNoise:
    """How a drawing differs from the building as it was planned: it has gone stale.

    Parameters
    ----------
    moved_share, missing_share : float
        Share of the partitions between rooms that are drawn elsewhere, or not at all
        (simulation: 10 % of them together).
    moved_m : float
        How far at most (simulation).
    merged_share : float
        Share of the rooms that are drawn as one with a neighbour (simulation).
    door_undrawn_share : float
        Share of the doors that are drawn as wall (simulation).
    column_undrawn_share : float
        Share of the free-standing columns that are not drawn (simulation).
    scale_sd : float
        Spread of the drawing's scale (simulation: 1 %).
    one_way_share : float
        Probability that the scale is off in one direction only (simulation).
    two_faces_share : float
        Probability that walls are drawn as two faces, not as centre lines (simulation).

    Examples
    --------
    >>> PlanNoise.none().scale_sd
    0.0
    """

    moved_share: float = 0.05
    missing_share: float = 0.05
    moved_m: float = 1.0
    merged_share: float = 0.03
    door_undrawn_share: float = 0.08
    column_undrawn_share: float = 0.3
    scale_sd: float = 0.01
    one_way_share: float = 0.5
    two_faces_share: float = 0.25

    def __post_init__(self) -> None:
        _check_not_negative(self)

    @classmethod
    def none(cls) -> PlanNoise:
        """Return the drawing that is exactly what was planned."""
        return cls(*(0.0,) * 9)


@dataclass(frozen=True, slots=True)
class ScannerNoise:
    """What a phone's LiDAR and its plane detection do to walls.

    Parameters
    ----------
    range_m : float
        Nothing is seen beyond (the maker's figure for phones: 5 m).
    circle_min_m, circle_max_m : float
        Radius of the circle that the phone is carried on (measured: 0.3 to 0.4 m).
    turn_rad : float
        How far the user turns while scanning; a whole turn by default.
    view_rad : float
        Horizontal angle of view of the sensor (simulation: 60 degrees).
    ray_rad : float
        Angle between rays (simulation: 0.5 degrees).
    normal_sd_m, angle_sd_rad, end_sd_m : float
        Errors of a plane: along its normal, of its direction, of each end along it
        (measured: 4 cm, 1.2 degrees, 12 cm).
    merge_gap_m : float
        Collinear patches nearer than this become one plane (measured: 1 m).
    min_length_m : float
        Shorter planes are not reported (measured: 0.45 m).
    missed_share : float
        Probability that a plane is missed when seen head-on (measured: 12 %).
    grazing_missed_share : float
        What is added to it for a plane seen at grazing incidence (simulation).
    spurious_count : float
        Mean number of planes that are no wall: furniture parallel to one (measured: 0.8).
    glass_seen_share : float
        Probability that a pane of glass is seen at all (simulation: mostly unseen).

    Examples
    --------
    >>> ScannerNoise.none().spurious_count
    0.0
    """

    range_m: float = 5.0
    circle_min_m: float = 0.3
    circle_max_m: float = 0.4
    turn_rad: float = 2 * math.pi
    view_rad: float = math.radians(60)
    ray_rad: float = math.radians(0.5)
    normal_sd_m: float = 0.04
    angle_sd_rad: float = math.radians(1.2)
    end_sd_m: float = 0.12
    merge_gap_m: float = 1.0
    min_length_m: float = 0.45
    missed_share: float = 0.12
    grazing_missed_share: float = 0.4
    spurious_count: float = 0.8
    glass_seen_share: float = 0.15

    def __post_init__(self) -> None:
        _check_not_negative(self)
        if not 0 < self.ray_rad <= math.radians(5):
            raise SettingsError(
                "ScannerNoise.ray_rad", expected="above 0, at most 5 degrees", got=str(self.ray_rad)
            )

    @classmethod
    def none(cls) -> ScannerNoise:
        """Return the scanner that reports every wall in its range as it is."""
        return cls(
            normal_sd_m=0.0,
            angle_sd_rad=0.0,
            end_sd_m=0.0,
            missed_share=0.0,
            grazing_missed_share=0.0,
            spurious_count=0.0,
            glass_seen_share=1.0,
        )


@dataclass(frozen=True, slots=True)
class RouteSettings:
    """How people walk through a building.

    Parameters
    ----------
    cell_size_m : float
        Cells in which a way is looked for (ours).
    body_m : float
        Nobody's middle comes nearer to a wall (simulation: half the width of shoulders).
    comfort_m : float
        People keep this far from walls where there is space (simulation).
    crowding_cost : float
        A metre along a wall counts this much more than one in the open (simulation).
    room_cost : float
        A metre inside a room counts this many times one in a corridor (simulation).
    room_visit_share : float
        Share of the goals that lie in a room (simulation).
    goal_m : float
        Goals lie at least this far apart, where the building is large enough (simulation).
    smooth_m : float
        How far ahead a walker cuts a corner (simulation).
    step_m, step_sd_m : float
        Length of a step (measured: 0.65 m) and its spread (simulation).
    speed_m_s, speed_sd_m_s : float
        Walking speed (measured: 1.2 m/s) and its spread (simulation).

    Examples
    --------
    >>> RouteSettings().step_m
    0.65
    """

    cell_size_m: float = 0.15
    body_m: float = 0.28
    comfort_m: float = 0.9
    crowding_cost: float = 3.0
    room_cost: float = 2.5
    room_visit_share: float = 0.0
    goal_m: float = 25.0
    smooth_m: float = 0.6
    step_m: float = 0.65
    step_sd_m: float = 0.04
    speed_m_s: float = 1.2
    speed_sd_m_s: float = 0.06

    def __post_init__(self) -> None:
        _check_not_negative(self)
        for name in ("cell_size_m", "step_m", "speed_m_s"):
            if getattr(self, name) <= 0:
                raise SettingsError(f"RouteSettings.{name}", expected="above 0", got="0")


@dataclass(frozen=True, slots=True)
class StartSettings:
    """Where users scan: where there is something to see.

    Parameters
    ----------
    walls : int
        A scan of a whole turn has at least so many walls (ours).
    length_m : float
        And so many metres of them (ours).
    second_m : float
        Of which so many run at another angle than the rest (ours).
    clearance_m : float
        Nobody scans nearer to a wall (simulation).
    apart_m : float
        Starts lie at least so far apart, where the building is large enough (ours).
    corridor_share : float
        Share of the starts in corridors and foyers (simulation).

    Examples
    --------
    >>> StartSettings().walls
    4
    """

    walls: int = 4
    length_m: float = 8.0
    second_m: float = 1.2
    clearance_m: float = 0.55
    apart_m: float = 10.0
    corridor_share: float = 0.7

    def __post_init__(self) -> None:
        _check_not_negative(self)


@dataclass(frozen=True, slots=True)
class VioNoise:
    """Visual-inertial odometry, per metre and per second: any sampling rate is the same.

    Parameters
    ----------
    heading_rad_per_sqrt_s : float
        Random walk of the drift (measured: 1 degree standard deviation after a minute).
    scale_sd : float
        Spread of a walk's scale (measured: 2 %).
    white_m_per_sqrt_m : float
        White noise of each coordinate (measured: 2 % of the length, at one metre).

    Examples
    --------
    >>> round(math.degrees(VioNoise().heading_rad_per_sqrt_s * 60**0.5), 3)
    1.0
    """

    heading_rad_per_sqrt_s: float = math.radians(1.0) / math.sqrt(60.0)
    scale_sd: float = 0.02
    white_m_per_sqrt_m: float = 0.02

    def __post_init__(self) -> None:
        _check_not_negative(self)


@dataclass(frozen=True, slots=True)
class InertialNoise:
    """Odometry from inertial sensors alone, in a frame of its own.

    Parameters
    ----------
    rate_sd_rad_per_s : float
        Spread of a walk's constant drift rate (measured: 7 degrees a minute).
    sideways_m_per_sqrt_m : float
        White noise across the direction of walking (measured: 4 degrees a step of 0.65 m).
    scale : float
        Mean scale of walks (simulation; measured on the data set of the paper: 1.1).
    scale_sd : float
        Spread of a walk's scale (measured: 9 %).
    leg_scale_sd, leg_m : float
        A further scale for each leg of a walk, and its length (measured: 10 %;
        simulation: 15 m).

    Examples
    --------
    >>> InertialNoise().leg_m
    15.0
    """

    rate_sd_rad_per_s: float = math.radians(7.0) / 60.0
    sideways_m_per_sqrt_m: float = math.radians(4.0) * math.sqrt(0.65)
    scale: float = 1.0
    scale_sd: float = 0.09
    leg_scale_sd: float = 0.10
    leg_m: float = 15.0

    def __post_init__(self) -> None:
        _check_not_negative(self)
