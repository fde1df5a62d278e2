"""Dead reckoning from a phone's inertial sensors: steps, their lengths and headings.

`dead_reckon` does it all; its parts are public, each a function of the log.

Examples
--------
>>> InertialSettings().length
'pendulum'
"""

from palms.inertial.carriage import Carriage, how_carried
from palms.inertial.heading import step_headings_rad
from palms.inertial.length import step_lengths_m
from palms.inertial.level import level_attitude, level_axis
from palms.inertial.log import InertialLog
from palms.inertial.reckoning import dead_reckon
from palms.inertial.settings import HeadingMethod, InertialSettings, LengthMethod
from palms.inertial.steps import Steps, find_steps

__all__ = [
    "Carriage",
    "HeadingMethod",
    "InertialLog",
    "InertialSettings",
    "LengthMethod",
    "Steps",
    "dead_reckon",
    "find_steps",
    "how_carried",
    "level_attitude",
    "level_axis",
    "step_headings_rad",
    "step_lengths_m",
]
