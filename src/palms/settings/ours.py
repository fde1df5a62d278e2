"""The groups of settings that the paper does not have: our likelihood, filter and declaration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from palms.settings.checks import check

__all__ = [
    "DeclarationSettings",
    "HintSettings",
    "JumpSettings",
    "LevelSettings",
    "ObservationSettings",
    "ResamplingSettings",
    "RestartSettings",
]


@dataclass(frozen=True, slots=True)
class ObservationSettings:
    """What a scan says about a place: the likelihood of our method.

    Parameters
    ----------
    wall_sd_m : float
        How far a metre of seen wall lies from its wall, standard deviation (ours, fitted).
    offset_sd_m, far_offset_sd_m : float
        How far a wall lies off as a whole, standard deviations: of most walls, and of walls
        that were moved or badly drawn (ours, fitted).
    far_offset_share : float
        Share of the latter (ours, fitted).
    unplanned_share : float
        Probability that the plan does not have a seen wall at all (ours, fitted).
    unexplained_share : float
        Share of the metres of a wall that lie elsewhere than the plan has them (ours, fitted).
    empty_nats_per_m : float
        What a metre of the plan's wall costs where the scan proves empty space (ours, fitted).
    missing_share : float
        Probability that a wall of the plan does not stand; it bounds what one wall may cost
        (ours, fitted).
    empty_margin_m : float
        Proven empty space ends so far before the wall that was seen (ours, fitted).
    empty_range_m : float
        It reaches no farther than this (ours).
    strength : float
        All of it is raised to this power, because errors of walls are not independent (ours,
        fitted).
    elsewhere : float
        Probability that the plan does not show the scan's surroundings at all; so much of
        the belief starts anywhere (ours, fitted).
    spacing_m : float
        Between the points that stand for walls and for empty space (ours).
    drift_step_rad : float
        Between the drifts that are tried (ours: 5 degrees).
    drift_share : float
        Drifts whose walls agree in direction less than this share of the best drift's are
        not tried (ours).
    search_sd_m, search_share, search_empty_nats_per_m : float
        As `wall_sd_m`, `unexplained_share` and `empty_nats_per_m`, for the search over the
        whole building, in which each metre errs by itself (ours, fitted).
    search_power : float
        Poses are proposed by the search's likelihood raised to this power (ours, fitted).
    search_nats : float
        Cells that fall short of the best by more than this are dropped (ours).
    cell_size_m : float
        Of the search (ours).
    max_cells : int
        Larger buildings are searched with larger cells (ours).
    max_candidates : int
        So many cells are kept at the most (ours).
    n_proposals : int
        Poses that are looked at roughly (ours).
    rough_power : float
        They are chosen to be judged by that likelihood raised to this power (ours, fitted).
    n_judged : int
        Poses that are judged (ours).
    keep_nats : float
        Poses that fall short of the best by more than this are dropped (ours).
    """

    wall_sd_m: float = 0.05
    offset_sd_m: float = 0.06
    far_offset_sd_m: float = 0.25
    far_offset_share: float = 0.3
    unplanned_share: float = 0.05
    unexplained_share: float = 0.05
    empty_nats_per_m: float = 5.0
    missing_share: float = 0.05
    empty_margin_m: float = 0.2
    empty_range_m: float = 8.0
    strength: float = 0.9
    elsewhere: float = 0.1
    spacing_m: float = 0.2
    drift_step_rad: float = 0.08726646259971647
    drift_share: float = 0.1
    search_sd_m: float = 0.2
    search_share: float = 0.1
    search_empty_nats_per_m: float = 2.0
    search_power: float = 0.3
    search_nats: float = 40.0
    cell_size_m: float = 0.2
    max_cells: int = 1_000_000
    max_candidates: int = 200_000
    n_proposals: int = 60_000
    rough_power: float = 0.35
    n_judged: int = 20_000
    keep_nats: float = 14.0

    def __post_init__(self) -> None:
        check(
            "observation",
            wall_sd_m=(0 < self.wall_sd_m <= 2, "above 0, at most 2 m", self.wall_sd_m),
            offset_sd_m=(0 < self.offset_sd_m <= 2, "above 0, at most 2 m", self.offset_sd_m),
            far_offset_sd_m=(
                0 < self.far_offset_sd_m <= 2, "above 0, at most 2 m", self.far_offset_sd_m
            ),
            far_offset_share=(0 <= self.far_offset_share <= 1, "0 to 1", self.far_offset_share),
            unplanned_share=(
                0 < self.unplanned_share < 1, "between 0 and 1", self.unplanned_share
            ),
            unexplained_share=(
                0 < self.unexplained_share < 1, "between 0 and 1", self.unexplained_share
            ),
            empty_nats_per_m=(self.empty_nats_per_m >= 0, "0 or more", self.empty_nats_per_m),
            missing_share=(0 < self.missing_share < 1, "between 0 and 1", self.missing_share),
            strength=(0 < self.strength <= 1, "above 0, at most 1", self.strength),
            elsewhere=(0 <= self.elsewhere < 1, "0 to below 1", self.elsewhere),
            spacing_m=(0.01 <= self.spacing_m <= 1, "0.01 to 1 m", self.spacing_m),
            drift_step_rad=(
                0.005 <= self.drift_step_rad <= 0.8, "0.005 to 0.8 rad", self.drift_step_rad
            ),
            search_sd_m=(0 < self.search_sd_m <= 2, "above 0, at most 2 m", self.search_sd_m),
            search_share=(0 < self.search_share < 1, "between 0 and 1", self.search_share),
            search_empty_nats_per_m=(
                self.search_empty_nats_per_m >= 0, "0 or more", self.search_empty_nats_per_m
            ),
            search_power=(0 < self.search_power <= 1, "above 0, at most 1", self.search_power),
            search_nats=(self.search_nats > 0, "above 0", self.search_nats),
            cell_size_m=(0.02 <= self.cell_size_m <= 2, "0.02 to 2 m", self.cell_size_m),
            max_candidates=(self.max_candidates >= 1, "at least 1", self.max_candidates),
            n_proposals=(self.n_proposals >= 1, "at least 1", self.n_proposals),
            rough_power=(0 < self.rough_power <= 1, "above 0, at most 1", self.rough_power),
            n_judged=(self.n_judged >= 1, "at least 1", self.n_judged),
            keep_nats=(self.keep_nats > 0, "above 0", self.keep_nats),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class ResamplingSettings:
    """When particles are drawn anew, and how many.

    Parameters
    ----------
    scheme : {"survivors", "every-step", "adaptive"}
        A particle that hits a wall becomes a copy of a survivor (paper III-C); all are drawn
        anew at every step (authors' code); or as below (ours).
    ess_share : float
        Draw anew when the effective sample size falls below this share of the particles
        (ours).
    min_particles : int
        As few as this when they have gathered (ours).
    per_bin : float
        Particles for each bin that they occupy (Fox 2003, simplified; number ours).
    bin_m, bin_rad : float
        Sides of such a bin (ours).
    check_moves : int
        Moves between two counts of the bins (ours).
    jitter_m, jitter_rad, jitter_scale : float
        Spread of a copied particle's place, drift and scale (ours).
    """

    scheme: Literal["survivors", "every-step", "adaptive"] = "survivors"
    ess_share: float = 0.5
    min_particles: int = 1500
    per_bin: float = 10.0
    bin_m: float = 0.5
    bin_rad: float = 0.17453292519943295
    check_moves: int = 8
    jitter_m: float = 0.03
    jitter_rad: float = 0.004
    jitter_scale: float = 0.003

    def __post_init__(self) -> None:
        check(
            "resampling",
            ess_share=(0 <= self.ess_share <= 1, "0 to 1", self.ess_share),
            min_particles=(self.min_particles >= 1, "at least 1", self.min_particles),
            per_bin=(self.per_bin > 0, "above 0", self.per_bin),
            bin_m=(self.bin_m > 0, "above 0 m", self.bin_m),
            bin_rad=(0 < self.bin_rad <= 6.3, "above 0, at most 6.3 rad", self.bin_rad),
            check_moves=(self.check_moves >= 1, "at least 1", self.check_moves),
        )


@dataclass(frozen=True, slots=True)
class DeclarationSettings:
    """When our method says that it is oriented, localized or lost.

    Parameters
    ----------
    rule : {"clusters", "probability"}
        Labels and clusters, final once reached (paper III-D, see `ConvergenceSettings`), or
        as below (ours).
    enter, leave : float
        `p_within_2m` from which it is localized, and below which no longer (ours, chosen on
        development data).
    leave_inertial : float
        The same where the odometry is inertial: what it knows spreads again within a few
        metres (ours, chosen on development data).
    oriented_share, oriented_rad : float
        Oriented while this share of the belief lies this near to one drift (ours: 90 % and
        15 degrees).
    doubt_at_start : float
        Probability that the belief does not hold the truth before the first move (ours).
    doubt_floor : float
        It never falls below this (ours).
    stray_nats_per_m : float
        Evidence that a belief in the wrong place loses to walls with each metre (ours,
        fitted): what a belief loses less speaks for it, what it loses more against.
    lost : float
        Doubt above this means lost (ours).
    doubt_after_search : float
        Doubt once other places were taken in again (ours).
    search_share : float
        Share of the belief given to other places then (ours).
    search_every_m : float
        Metres between two such searches (ours).
    """

    rule: Literal["clusters", "probability"] = "clusters"
    enter: float = 0.98
    leave: float = 0.85
    leave_inertial: float = 0.95
    oriented_share: float = 0.9
    oriented_rad: float = 0.2617993877991494
    doubt_at_start: float = 0.05
    doubt_floor: float = 0.005
    stray_nats_per_m: float = 0.2
    lost: float = 0.5
    doubt_after_search: float = 0.2
    search_share: float = 0.5
    search_every_m: float = 8.0

    def __post_init__(self) -> None:
        check(
            "declaration",
            enter=(0 < self.enter <= 1, "above 0, at most 1", self.enter),
            leave=(0 <= self.leave <= self.enter, "0 to enter", self.leave),
            leave_inertial=(
                0 <= self.leave_inertial <= self.enter, "0 to enter", self.leave_inertial
            ),
            oriented_share=(
                0 < self.oriented_share <= 1, "above 0, at most 1", self.oriented_share
            ),
            doubt_at_start=(0 <= self.doubt_at_start < 1, "0 to below 1", self.doubt_at_start),
            doubt_floor=(0 <= self.doubt_floor < 1, "0 to below 1", self.doubt_floor),
            stray_nats_per_m=(self.stray_nats_per_m >= 0, "0 or more", self.stray_nats_per_m),
            lost=(0 < self.lost <= 1, "above 0, at most 1", self.lost),
            doubt_after_search=(
                0 <= self.doubt_after_search < 1, "0 to below 1", self.doubt_after_search
            ),
            search_share=(0 <= self.search_share < 1, "0 to below 1", self.search_share),
            search_every_m=(self.search_every_m > 0, "above 0 m", self.search_every_m),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class HintSettings:
    """How long a hint counts.

    Parameters
    ----------
    fade_m : float
        After so many metres 63 % of what it said is taken back (ours, chosen on development
        data).
    """

    fade_m: float = 40.0

    def __post_init__(self) -> None:
        check("hint", fade_m=(self.fade_m > 0, "above 0 m", self.fade_m))


@dataclass(frozen=True, slots=True)
class LevelSettings:
    """How people get from level to level of a building.

    Parameters
    ----------
    climb_per_s : float
        How soon somebody on stairs or in a lift has left the level, a rate (ours).
    reach_m : float
        Stairs count for so much around their outline, since plans and answers err; more than
        a corridor's half width would let people climb who only pass by (ours).
    """

    climb_per_s: float = 0.15
    reach_m: float = 0.3

    def __post_init__(self) -> None:
        check(
            "levels",
            climb_per_s=(self.climb_per_s >= 0, "0 or more per second", self.climb_per_s),
            reach_m=(0 <= self.reach_m <= 50, "0 to 50 m", self.reach_m),
        )


@dataclass(frozen=True, slots=True)
class RestartSettings:
    """What is kept when the odometry's frame is new, by the time without odometry.

    Parameters
    ----------
    walk_share : float
        How often somebody walks on meanwhile; the others stay where they are (ours).
    speed_m_s : float
        Of those who walk (ours; people walk indoors at 1.0 to 1.4).
    leg_s : float
        So long do they walk straight on, in the mean (ours).
    keep_s : float
        After this time nothing of the place holds any more in 63 % of the cases (ours: a lift,
        another building, a phone in other hands).
    """

    walk_share: float = 0.5
    speed_m_s: float = 1.2
    leg_s: float = 10.0
    keep_s: float = 1200.0

    def __post_init__(self) -> None:
        check(
            "restart",
            walk_share=(0 <= self.walk_share <= 1, "0 to 1", self.walk_share),
            speed_m_s=(self.speed_m_s >= 0, "0 m/s or more", self.speed_m_s),
            leg_s=(self.leg_s > 0, "above 0 s", self.leg_s),
            keep_s=(self.keep_s > 0, "above 0 s", self.keep_s),
        )


@dataclass(frozen=True, slots=True)
class JumpSettings:
    """When a move is a jump of the odometry and not of the phone, and what it leaves unknown.

    Parameters
    ----------
    speed_m_s : float
        Nobody moves faster than this for long (ours; who runs for a train does 4).
    slack_m : float
        But for so many metres, since times are recorded unevenly (ours).
    real_share : float
        Probability that the phone did move so (ours).
    turned_share, turn_rad : float
        Probability that a jump turns the frame, too, and how far, standard deviation (ours).
    """

    speed_m_s: float = 4.0
    slack_m: float = 1.0
    real_share: float = 0.1
    turned_share: float = 0.5
    turn_rad: float = 0.2

    def __post_init__(self) -> None:
        check(
            "jump",
            speed_m_s=(self.speed_m_s > 0, "above 0 m/s", self.speed_m_s),
            slack_m=(self.slack_m >= 0, "0 m or more", self.slack_m),
            real_share=(0 <= self.real_share < 1, "0 to below 1", self.real_share),
            turned_share=(0 <= self.turned_share <= 1, "0 to 1", self.turned_share),
            turn_rad=(0 <= self.turn_rad <= 3.2, "0 to 3.2 rad", self.turn_rad),
        )
