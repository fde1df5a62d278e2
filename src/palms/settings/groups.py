"""The groups of settings: every number, its unit and its origin."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from palms.settings.checks import check

__all__ = [
    "LIMITS",
    "AnswerSettings",
    "CandidateSettings",
    "ConvergenceSettings",
    "Limits",
    "MotionSettings",
    "RasterSettings",
    "StartSettings",
    "TemplateSettings",
]


@dataclass(frozen=True, slots=True)
class RasterSettings:
    """How a floor plan becomes cells.

    Parameters
    ----------
    cell_size_m : float
        Side of a cell (paper silent, ours; the authors' code has the same).
    margin_m : float
        Border around the walls, and how far outside of the building a phone may be
        (ours).
    wall_weight, door_weight, opening_weight, glass_weight : float
        What a metre of each class counts in matching (ours; a plan without classes is
        all wall, which is the paper).
    max_cells : int
        Refuse larger rasters; 2e7 cells need about half a gigabyte (ours).
    closing_m : float
        Gaps up to twice this are closed to find the inside of a building (ours).
    enclosed_share : float
        A plan that encloses less than this share of its walls' hull has holes; then the
        hull counts as inside (ours).
    """

    cell_size_m: float = 0.1
    margin_m: float = 2.0
    wall_weight: float = 1.0
    door_weight: float = 0.5
    opening_weight: float = 0.0
    glass_weight: float = 0.5
    max_cells: int = 20_000_000
    closing_m: float = 1.5
    enclosed_share: float = 0.9

    def __post_init__(self) -> None:
        check(
            "raster",
            cell_size_m=(0.01 <= self.cell_size_m <= 1.0, "0.01 to 1 m", self.cell_size_m),
            margin_m=(self.margin_m >= 0, "0 m or more", self.margin_m),
            max_cells=(self.max_cells >= 1, "at least 1", self.max_cells),
            enclosed_share=(0 <= self.enclosed_share <= 1, "0 to 1", self.enclosed_share),
        )


@dataclass(frozen=True, slots=True)
class Limits:
    """What plans, scans and walks are checked against at the door; not for tuning.

    Parameters
    ----------
    min_plan_m, max_plan_m : float
        A plan narrower or wider is not in metres (ours; the largest buildings are about
        2 km long).
    max_scan_range_m : float
        Walls that lie wholly beyond this are not the scanner's; its range is 5 m
        (paper V), doubled because planes grow while the user turns (ours).
    min_wall_m : float
        Shorter walls of a scan are dropped (ours).
    max_wall_m : float
        A scan with a longer wall is not in metres (ours).
    max_speed_m_s : float
        A walk whose median speed is higher is not in metres and seconds (ours).
    max_jump_m : float
        No single move is longer (ours).
    """

    min_plan_m: float = 1.0
    max_plan_m: float = 5000.0
    max_scan_range_m: float = 10.0
    min_wall_m: float = 0.1
    max_wall_m: float = 100.0
    max_speed_m_s: float = 50.0
    max_jump_m: float = 1000.0


LIMITS = Limits()


@dataclass(frozen=True, slots=True)
class TemplateSettings:
    """The paper's convolution kernel RW - alpha * CES.

    Parameters
    ----------
    wall_sigma_m : float
        Gaussian smoothing of the observed walls (paper III-B; width silent, ours).
    wall_scale : {"peak", "sum"}
        RW scaled to a peak of 1 (paper silent, ours) or to a sum of 1 (authors' code).
    empty_weight : float
        alpha (paper III-B: 1; authors' code: 10).
    empty_shrink : float
        Certainly empty triangles are scaled by this towards the observation point
        (paper III-B "slightly"; authors' code: 0.7).
    empty_erode_cells : int
        Cells eroded from certainly empty space (authors' code: 1).
    empty_range_m : float
        Certainly empty space ends here (authors' code: 10 m).
    truncate_cells : int
        Half width of the Gaussian's window; 0 means 4 sigma (authors' code: 3).
    range_sigma_m : float
        Walls weigh exp(-r^2 / 2 sigma^2) by their range r; infinite means equally
        (authors' code: 10 m).
    floor_at_zero : bool
        Whether negative scores are raised to 0 (authors' code).
    """

    wall_sigma_m: float = 0.3
    wall_scale: Literal["peak", "sum"] = "peak"
    empty_weight: float = 1.0
    empty_shrink: float = 0.7
    empty_erode_cells: int = 0
    empty_range_m: float = math.inf
    truncate_cells: int = 0
    range_sigma_m: float = math.inf
    floor_at_zero: bool = False

    def __post_init__(self) -> None:
        check(
            "template",
            wall_sigma_m=(0 < self.wall_sigma_m <= 2, "above 0, at most 2 m", self.wall_sigma_m),
            empty_weight=(self.empty_weight >= 0, "0 or more", self.empty_weight),
            empty_shrink=(0 < self.empty_shrink <= 1, "above 0, at most 1", self.empty_shrink),
        )


@dataclass(frozen=True, slots=True)
class CandidateSettings:
    """Which cells of the heatmaps may be the place of the scan.

    Parameters
    ----------
    quantile : float
        Cells at or above this quantile are candidates (paper III-C: 0.99).
    per_map : bool
        False: one threshold over all maps together, as many cells in each as come out
        (paper III-C, the text). True: the top of each map, and equally many particles
        from each (paper, caption of Fig. 1).
    """

    quantile: float = 0.99
    per_map: bool = False

    def __post_init__(self) -> None:
        check("candidates", quantile=(0 < self.quantile < 1, "between 0 and 1", self.quantile))


@dataclass(frozen=True, slots=True)
class StartSettings:
    """Where particles start.

    Parameters
    ----------
    source : {"scan", "uniform", "uniform-ori", "posterior"}
        From the heatmaps (paper III-C), everywhere with any drift (paper IV-B, Uniform),
        everywhere with four drifts (paper IV-B, Uniform + Ori), or from the posterior that
        the likelihood of a scan gives (ours, see `ObservationSettings`).
    n_particles : int
        Number of particles (paper IV-B: 2,000).
    orientation_from : {"plan", "axes"}
        theta aligns the scan with the plan (paper III-A) or with the axes of the map
        (authors' code).
    orientation_moves : int
        First moves that give Uniform + Ori its theta (paper IV-B "the first few
        tracking points"; 8 is ours).
    spare_share : float
        Share of the particles that starts anywhere, so that a scan of what the plan does not
        show loses nothing; how much they weigh is `ObservationSettings.elsewhere` (ours).
    """

    source: Literal["scan", "uniform", "uniform-ori", "posterior"] = "scan"
    n_particles: int = 2000
    orientation_from: Literal["plan", "axes"] = "plan"
    orientation_moves: int = 8
    spare_share: float = 0.5

    def __post_init__(self) -> None:
        check(
            "start",
            n_particles=(1 <= self.n_particles <= 5_000_000, "1 to 5,000,000", self.n_particles),
            orientation_moves=(self.orientation_moves >= 1, "at least 1", self.orientation_moves),
            spare_share=(0 <= self.spare_share < 1, "0 to below 1", self.spare_share),
        )

    @property
    def by_scan(self) -> bool:
        """Whether a scan decides where particles start.

        Examples
        --------
        >>> StartSettings().by_scan, StartSettings(source="uniform").by_scan
        (True, False)
        """
        return self.source in ("scan", "posterior")


@dataclass(frozen=True, slots=True)
class MotionSettings:
    """How far a particle's move may differ from the odometry's, and what a wall does.

    Noise is stated for a step of `step_m`. With ``scaling="distance"`` its variance grows
    with the length of the move, so that the same walk sampled differently spreads the same;
    with ``"sample"`` it is the same for every sample.

    Parameters
    ----------
    step_m : float
        The step for which the other numbers hold (ours: about a human step).
    length_m, direction_rad, drift_rad : float
        Standard deviations of a step's length and direction, and of the drift's change
        (paper silent, ours: fitted to visual-inertial odometry; authors' code: 0.356,
        0.05, 0.015).
    drift_rad_per_sqrt_s : float
        Standard deviation of the drift's change in a second, whether the phone moves or not;
        it grows with the root of the time (paper silent, which we read as none).
    jitter_m : float
        Spread of a resampled particle's place (paper III-C "with noise added"; 0.1 m is
        ours and the authors').
    scaling : {"distance", "sample"}
        See above (authors' code: sample).
    hit_weight : float
        What a particle that hits a wall keeps of its weight. 0: it is replaced by a
        copy of a random survivor (paper III-C); above 0 it passes through (authors'
        code: 0.3).
    scale_sd : float
        Spread of the particles' scale, metres walked per metre of odometry, around 1
        (paper silent, which we read as none).
    drift_rate_rad_per_s : float
        Spread of the steady turn of a walk's frame (paper silent, which we read as none).
    leg_scale_sd : float
        By so much does the scale of a leg differ from the walk's, standard deviation (paper
        silent, which we read as none).
    leg_m : float
        After so many metres 63 % of that is forgotten (ours: people change their step at
        corners and doors).
    """

    step_m: float = 0.65
    length_m: float = 0.05
    direction_rad: float = 0.025
    drift_rad: float = 0.007
    drift_rad_per_sqrt_s: float = 0.0
    jitter_m: float = 0.1
    scaling: Literal["distance", "sample"] = "distance"
    hit_weight: float = 0.0
    scale_sd: float = 0.0
    drift_rate_rad_per_s: float = 0.0
    leg_scale_sd: float = 0.0
    leg_m: float = 7.5

    def __post_init__(self) -> None:
        check(
            "motion",
            step_m=(self.step_m > 0, "above 0 m", self.step_m),
            length_m=(self.length_m >= 0, "0 m or more", self.length_m),
            direction_rad=(self.direction_rad >= 0, "0 or more", self.direction_rad),
            drift_rad=(self.drift_rad >= 0, "0 or more", self.drift_rad),
            drift_rad_per_sqrt_s=(
                self.drift_rad_per_sqrt_s >= 0,
                "0 or more",
                self.drift_rad_per_sqrt_s,
            ),
            jitter_m=(self.jitter_m >= 0, "0 m or more", self.jitter_m),
            hit_weight=(0 <= self.hit_weight <= 1, "0 to 1", self.hit_weight),
            scale_sd=(0 <= self.scale_sd <= 0.3, "0 to 0.3", self.scale_sd),
            drift_rate_rad_per_s=(
                self.drift_rate_rad_per_s >= 0,
                "0 or more",
                self.drift_rate_rad_per_s,
            ),
            leg_scale_sd=(0 <= self.leg_scale_sd <= 0.3, "0 to 0.3", self.leg_scale_sd),
            leg_m=(self.leg_m > 0, "above 0 m", self.leg_m),
        )


@dataclass(frozen=True, slots=True)
class ConvergenceSettings:
    """When the filter is oriented (t1) and localized (t2).

    Parameters
    ----------
    step1 : {"label", "dispersion"}
        One label holds `label_share` of the particles (paper III-D), or their dispersion,
        the root of the summed variances, is under `dispersion_m` (paper IV-B, Uniform).
    label_share : float
        (paper III-D: 0.8)
    dispersion_m : float
        (paper IV-B "a threshold"; 3 m is ours)
    cluster_share : float
        Share of the dominant label's particles in its dominant cluster (paper III-D: 0.5).
    bandwidth_m : float or None
        Of the flat mean-shift kernel (paper silent, ours: 1 m). None: estimated from the
        particles, as scikit-learn does by default (authors' code).
    recluster_steps : int
        Steps between two clusterings after t2 (paper III-D: 20; authors' code: 10).
    search_steps : int
        Steps between two clusterings before t2 (paper silent, ours: 1; authors' code: 5).
    withdraw : bool
        Whether t2 is withdrawn when the dominant label changes (authors' code).
    divide_particles : bool
        Whether the particle count is divided by the number of labels after t1
        (authors' code).
    """

    step1: Literal["label", "dispersion"] = "label"
    label_share: float = 0.8
    dispersion_m: float = 3.0
    cluster_share: float = 0.5
    bandwidth_m: float | None = 1.0
    recluster_steps: int = 20
    search_steps: int = 1
    withdraw: bool = False
    divide_particles: bool = False

    def __post_init__(self) -> None:
        check(
            "convergence",
            label_share=(0 < self.label_share <= 1, "above 0, at most 1", self.label_share),
            cluster_share=(0 < self.cluster_share <= 1, "above 0, at most 1", self.cluster_share),
            bandwidth_m=(
                self.bandwidth_m is None or self.bandwidth_m > 0,
                "above 0 m",
                self.bandwidth_m,
            ),
            recluster_steps=(self.recluster_steps >= 1, "at least 1", self.recluster_steps),
            search_steps=(self.search_steps >= 1, "at least 1", self.search_steps),
        )


@dataclass(frozen=True, slots=True)
class AnswerSettings:
    """What every answer reports.

    Parameters
    ----------
    hypotheses : int
        Live places named with their share; 0 leaves them out and saves time (ours).
    hypothesis_radius_m : float
        Radius of such a place (ours: as `p_within_2m`).
    heading_move_m : float
        Shorter moves give no heading (ours).
    local_spread : float
        So much of the belief's spread within 2 m of the answer counts in `p_within_1m` and in
        `radius_95_m`: it is mostly the width of a corridor, of which walkers keep to the middle
        (1: paper; 0.6: ours, fitted).
    core_spread : float
        The same for `radius_68_m`, if it is less: errors gather more, and reach farther, than
        the belief does (1: paper; 0.5: ours, fitted).
    local_spread_inertial, core_spread_inertial : float
        The same where the odometry is inertial: then the belief spreads along corridors, too
        (1: paper; 0.8 and 0.7: ours, fitted).
    """

    hypotheses: int = 5
    hypothesis_radius_m: float = 2.0
    heading_move_m: float = 0.05
    local_spread: float = 1.0
    core_spread: float = 1.0
    local_spread_inertial: float = 1.0
    core_spread_inertial: float = 1.0

    def __post_init__(self) -> None:
        check(
            "answer",
            hypotheses=(0 <= self.hypotheses <= 100, "0 to 100", self.hypotheses),
            hypothesis_radius_m=(
                self.hypothesis_radius_m > 0, "above 0 m", self.hypothesis_radius_m
            ),
            heading_move_m=(self.heading_move_m >= 0, "0 m or more", self.heading_move_m),
            local_spread=(0.5 <= self.local_spread <= 1, "0.5 to 1", self.local_spread),
            core_spread=(0.3 <= self.core_spread <= 1, "0.3 to 1", self.core_spread),
            local_spread_inertial=(
                0.5 <= self.local_spread_inertial <= 1, "0.5 to 1", self.local_spread_inertial
            ),
            core_spread_inertial=(
                0.3 <= self.core_spread_inertial <= 1, "0.3 to 1", self.core_spread_inertial
            ),
        )  # fmt: skip
