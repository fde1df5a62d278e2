"""The presets of the methods, by name."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

from palms.errors import SettingsError
from palms.settings.groups import (
    AnswerSettings,
    CandidateSettings,
    ConvergenceSettings,
    MotionSettings,
    RasterSettings,
    StartSettings,
    TemplateSettings,
)
from palms.settings.ours import (
    DeclarationSettings,
    HintSettings,
    JumpSettings,
    LevelSettings,
    ObservationSettings,
    ResamplingSettings,
    RestartSettings,
)

__all__ = ["METHODS", "Settings"]

METHODS = ("palms", "paper", "authors", "uniform", "uniform-ori", "no-scan")


_START = StartSettings(source="posterior", n_particles=30_000)
_ANSWER = AnswerSettings(
    local_spread=0.6, core_spread=0.5, local_spread_inertial=0.8, core_spread_inertial=0.7
)
_RESAMPLING = ResamplingSettings("adaptive")
_DECLARATION = DeclarationSettings("probability")
_VIO = MotionSettings(
    length_m=0.024, direction_rad=0.037, drift_rad=0.0, drift_rad_per_sqrt_s=0.0045,
    jitter_m=0.0, hit_weight=0.03, scale_sd=0.03,
)  # fmt: skip
_INERTIAL = replace(
    _VIO, direction_rad=0.07, drift_rad_per_sqrt_s=0.002, hit_weight=0.01,
    drift_rate_rad_per_s=0.0024, scale_sd=0.09, leg_scale_sd=0.1,
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Settings:
    """All settings of a method; change one with `dataclasses.replace`.

    `Settings()` is ours. Each group's own defaults are the paper's, where the paper has it.

    Parameters
    ----------
    method : str
        Name of the method, one of `METHODS`.
    raster, template, candidates, start, motion, convergence, answer
        The groups of the paper's method; ours leaves out template, candidates and convergence.
    observation, resampling, declaration, levels, restart
        The groups of ours.
    inertial : MotionSettings
        In place of `motion` where the odometry is inertial; the paper has one for both.

    Examples
    --------
    >>> Settings.paper().template.empty_weight
    1.0
    >>> Settings.for_method("authors").motion.hit_weight
    0.3
    >>> Settings().for_odometry("inertial").motion.scale_sd
    0.09
    """

    method: str = "palms"
    raster: RasterSettings = field(default_factory=RasterSettings)
    template: TemplateSettings = field(default_factory=TemplateSettings)
    candidates: CandidateSettings = field(default_factory=CandidateSettings)
    start: StartSettings = _START
    motion: MotionSettings = _VIO
    convergence: ConvergenceSettings = field(default_factory=ConvergenceSettings)
    answer: AnswerSettings = _ANSWER
    observation: ObservationSettings = field(default_factory=ObservationSettings)
    resampling: ResamplingSettings = _RESAMPLING
    declaration: DeclarationSettings = _DECLARATION
    levels: LevelSettings = field(default_factory=LevelSettings)
    restart: RestartSettings = field(default_factory=RestartSettings)
    jump: JumpSettings = field(default_factory=JumpSettings)
    hint: HintSettings = field(default_factory=HintSettings)
    inertial: MotionSettings = _INERTIAL

    @classmethod
    def paper(cls) -> Settings:
        """Return section III of the paper as written."""
        return cls(
            "paper", start=StartSettings(), motion=MotionSettings(),
            resampling=ResamplingSettings(), declaration=DeclarationSettings(),
            inertial=MotionSettings(), answer=AnswerSettings(),
        )  # fmt: skip

    @classmethod
    def authors(cls) -> Settings:
        """Return what the authors published as code, as far as it differs from the paper."""
        motion = MotionSettings(
            length_m=0.356, direction_rad=0.05, drift_rad=0.015, scaling="sample", hit_weight=0.3
        )
        return replace(
            cls.paper(), method="authors",
            template=TemplateSettings(
                wall_scale="sum", empty_weight=10.0, empty_erode_cells=1, empty_range_m=10.0,
                truncate_cells=3, range_sigma_m=10.0, floor_at_zero=True,
            ),
            start=StartSettings(orientation_from="axes"),
            motion=motion, inertial=motion,
            convergence=ConvergenceSettings(
                bandwidth_m=None, recluster_steps=10, search_steps=5, withdraw=True,
                divide_particles=True,
            ),
            resampling=ResamplingSettings("every-step"),
        )  # fmt: skip

    @classmethod
    def uniform(cls) -> Settings:
        """Return paper IV-B, Uniform: everywhere, with any drift; step 1 by dispersion."""
        return replace(
            cls.paper(),
            method="uniform",
            start=StartSettings(source="uniform"),
            convergence=ConvergenceSettings(step1="dispersion"),
        )

    @classmethod
    def uniform_ori(cls) -> Settings:
        """Return paper IV-B, Uniform + Ori: four drifts, from the plan and the first moves."""
        return replace(cls.paper(), method="uniform-ori", start=StartSettings(source="uniform-ori"))

    @classmethod
    def no_scan(cls) -> Settings:
        """Return our filter without a scan."""
        return replace(
            cls(), method="no-scan", start=StartSettings(source="uniform", n_particles=100_000)
        )

    @classmethod
    def for_method(cls, name: str) -> Settings:
        """Return the preset of a method by its name.

        Raises
        ------
        SettingsError
            When there is no such method.
        """
        presets: dict[str, Any] = {
            "palms": cls, "paper": cls.paper, "authors": cls.authors, "uniform": cls.uniform,
            "uniform-ori": cls.uniform_ori, "no-scan": cls.no_scan,
        }  # fmt: skip
        if name not in presets:
            raise SettingsError("method", expected="one of " + ", ".join(METHODS), got=repr(name))
        preset: Settings = presets[name]()
        return preset

    @property
    def is_ours(self) -> bool:
        """Whether the method takes scans at any time, hints and levels."""
        return self.declaration.rule == "probability"

    def for_odometry(self, source: Literal["vio", "inertial"]) -> Settings:
        """Return the settings for a kind of odometry: how it errs, and what follows from that."""
        if source == "vio":
            return self
        answer = replace(
            self.answer, local_spread=self.answer.local_spread_inertial,
            core_spread=self.answer.core_spread_inertial,
        )  # fmt: skip
        declaration = replace(self.declaration, leave=self.declaration.leave_inertial)
        return replace(self, motion=self.inertial, answer=answer, declaration=declaration)

    def with_particles(self, n_particles: int) -> Settings:
        """Return the same settings with another number of particles."""
        return replace(self, start=replace(self.start, n_particles=n_particles))
