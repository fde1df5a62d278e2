"""Every number of the method, with its unit and where it comes from.

Three presets: `Settings()` is our best, `Settings.paper()` the paper's section III
(where the paper is silent the number says "paper silent, ours"), `Settings.authors()`
what the authors published as code. `Settings.for_method` finds them by name.
"""

from palms.settings.groups import (
    LIMITS,
    AnswerSettings,
    CandidateSettings,
    ConvergenceSettings,
    Limits,
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
from palms.settings.presets import METHODS, Settings

__all__ = [
    "LIMITS",
    "METHODS",
    "AnswerSettings",
    "CandidateSettings",
    "ConvergenceSettings",
    "DeclarationSettings",
    "HintSettings",
    "JumpSettings",
    "LevelSettings",
    "Limits",
    "MotionSettings",
    "ObservationSettings",
    "RasterSettings",
    "ResamplingSettings",
    "RestartSettings",
    "Settings",
    "StartSettings",
    "TemplateSettings",
]
