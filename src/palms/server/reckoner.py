"""Reckoner: dead reckoning of a log that still grows, by windows that overlap.

Each window lies in a frame of its own, as any inertial log does. The steps that two windows have in
common tell how the later one is turned; so all steps that are told lie in the frame of the first.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field, replace

import numpy as np

from palms.errors import InputError, PalmsWarning
from palms.geometry import FloatArray, circular_mean
from palms.inertial import (
    InertialLog,
    InertialSettings,
    find_steps,
    level_attitude,
    step_headings_rad,
    step_lengths_m,
)
from palms.server.messages.inputs import Inertial, Sample

__all__ = ["Reckoner", "reckoned"]

WINDOW_S = 40.0  # ours: some sixty steps
LONGEST_S = 600.0  # ours: who stands longer begins a new frame
OVERLAP_S = 15.0  # ours: so much of what was told stays in the window
SETTLED_S = 1.5  # ours: filters may still change what is newer
LOOK_EVERY_S = 1.0  # ours: answers come once a second
SAME_S = 0.15  # ours: half of the shortest step
N_COMMON = 12  # ours: the latest steps that two windows share

Readings = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, slots=True)
class Reckoner:
    """What is kept of an inertial log between two messages.

    Parameters
    ----------
    base_s : float or None
        Time of the first reading, on the phone's clock; other times count from it.
    readings : dict
        Times (N,) and values (N, k) by sensor.
    told : tuple of (end_s, heading_rad)
        The latest steps that were told, in the frame of the first window.
    looked_s : float
        When steps were looked for last.
    sign : float
        Of acceleration: 1 with Android's signs, -1 with the iPhone's; 0 while not known.
    """

    base_s: float | None = None
    readings: dict[str, Readings] = field(default_factory=dict)
    told: tuple[tuple[float, float], ...] = ()
    looked_s: float = -math.inf
    sign: float = 0.0


def reckoned(before: Reckoner, message: Inertial) -> tuple[Reckoner, tuple[Sample, ...]]:
    """Take readings; return the steps that they complete, as displacements.

    Parameters
    ----------
    before : Reckoner
    message : Inertial

    Examples
    --------
    >>> reckoned(Reckoner(), Inertial(seq=1, readings=()))[1]
    ()
    """
    if not message.readings:
        return before, ()
    base = message.readings[0].t_s if before.base_s is None else before.base_s
    grown = replace(before, base_s=base, readings=_grown(before.readings, message, base))
    grown = _forgotten(grown, max(float(time[-1]) for time, _ in grown.readings.values()))
    felt = _felt(grown.readings)
    if felt is None or "gyroscope" not in grown.readings:
        return grown, ()
    grown = replace(grown, sign=grown.sign or _sign(message.platform, felt))
    newest = float(felt[0][-1])
    if newest - grown.looked_s < LOOK_EVERY_S:
        return grown, ()
    grown = replace(grown, looked_s=newest)
    try:
        told, samples = _steps(grown, (felt[0], grown.sign * felt[1]))
    except InputError:  # too short yet, or sensors that have no time in common
        return _forgotten(grown, newest), ()
    return _forgotten(replace(grown, told=told), newest), samples


def _grown(readings: dict[str, Readings], message: Inertial, base_s: float) -> dict[str, Readings]:
    """Add the readings of a message; repeated and late ones find their place."""
    found = dict(readings)
    for name in {reading.sensor for reading in message.readings}:
        new = [reading for reading in message.readings if reading.sensor == name]
        time = np.array([reading.t_s - base_s for reading in new])
        values = np.array([reading.values for reading in new])
        if name in found:
            time = np.concatenate([found[name][0], time])
            values = np.concatenate([found[name][1], values])
        time, first = np.unique(time, return_index=True)
        found[name] = time, values[first]
    return dict(sorted(found.items()))


def _felt(readings: dict[str, Readings]) -> Readings | None:
    """Acceleration with gravity."""
    if "totalacceleration" in readings:
        return readings["totalacceleration"]
    if "accelerometer" not in readings or "gravity" not in readings:
        return None
    time, moved = readings["accelerometer"]
    at, gravity = readings["gravity"]
    down = [np.interp(time, at, gravity[:, k]) for k in range(3)]
    return time, moved + np.column_stack(down)


def _sign(platform: str, felt: Readings) -> float:
    if platform == "auto":  # people look at their screens: it looks up
        return 1.0 if float(np.median(felt[1][:, 2])) >= 0 else -1.0
    return 1.0 if platform == "android" else -1.0


def _steps(
    reckoner: Reckoner, felt: Readings
) -> tuple[tuple[tuple[float, float], ...], tuple[Sample, ...]]:
    """Return what has been told in the end, and the samples of what is new."""
    settings = InertialSettings()
    log = InertialLog.of_sensors(felt, rate=reckoner.readings["gyroscope"])
    steps = find_steps(log, settings)
    if len(steps) < 2:
        return reckoner.told, ()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PalmsWarning)
        heading = step_headings_rad(log, level_attitude(log, settings), steps)
    heading = heading + _turn(reckoner.told, steps.end_s, heading)
    length = step_lengths_m(steps, settings)
    last = reckoner.told[-1][0] + SAME_S if reckoner.told else -math.inf
    new = np.flatnonzero((steps.end_s > last) & (steps.end_s <= log.time_s[-1] - SETTLED_S))
    samples = tuple(
        Sample(
            t_s=(reckoner.base_s or 0.0) + float(steps.end_s[i]),
            displacement_m=(
                float(length[i] * math.cos(heading[i])), float(length[i] * math.sin(heading[i])),
            ),
        )
        for i in new
    )  # fmt: skip
    return reckoner.told + tuple((float(steps.end_s[i]), float(heading[i])) for i in new), samples


def _turn(told: tuple[tuple[float, float], ...], end_s: FloatArray, heading: FloatArray) -> float:
    """Return by how much this window's frame is turned from the first one's."""
    pairs = []
    for when, was in reversed(told):
        nearest = int(np.abs(end_s - when).argmin())
        if abs(float(end_s[nearest]) - when) < SAME_S:
            pairs.append(was - float(heading[nearest]))
        if len(pairs) == N_COMMON:
            break
    return circular_mean(np.array(pairs), np.ones(len(pairs))) if pairs else 0.0


def _forgotten(reckoner: Reckoner, newest_s: float) -> Reckoner:
    """Let go of what the next window does not need."""
    last = reckoner.told[-1][0] if reckoner.told else newest_s
    start = max(newest_s - LONGEST_S, min(newest_s - WINDOW_S, last - OVERLAP_S))
    kept = {
        name: (time[time >= start], values[time >= start])
        for name, (time, values) in reckoner.readings.items()
    }
    told = tuple(step for step in reckoner.told if step[0] >= start) or reckoner.told[-1:]
    return replace(reckoner, readings={n: r for n, r in kept.items() if len(r[0])}, told=told)
