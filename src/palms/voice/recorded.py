"""What the voice would say on a recorded walk, with the times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from palms.advice import view_of
from palms.belief import Belief, Estimate, Stage
from palms.building import Building
from palms.floorplan import FloorPlan
from palms.geometry import wrap_angle
from palms.localizer import Happening, track
from palms.odometry import Odometry
from palms.particles import MoveInfo
from palms.scan import Scan
from palms.settings import Settings
from palms.voice.moments import Moment
from palms.voice.narrator import Narrator, Saying
from palms.voice.places import Voice
from palms.voice.preferences import Preferences
from palms.voice.surroundings import Surroundings

__all__ = ["Heard", "follow_moments", "moment_of", "narrate", "spoken"]


class Heard(NamedTuple):
    """A sentence, and when it is said.

    Attributes
    ----------
    step : int
        Index of the odometry's sample.
    time_s : float
        On the walk's clock.
    saying : Saying
    """

    step: int
    time_s: float
    saying: Saying


def moment_of(
    estimate: Estimate, belief: Belief | None, walked_m: float, facing_odom_rad: float | None
) -> Moment:
    """Return what the voice needs of an estimate and the belief behind it.

    Parameters
    ----------
    estimate : Estimate
    belief : Belief or None
    walked_m : float
    facing_odom_rad : float or None
        Where the phone looks, odom frame.

    Examples
    --------
    >>> moment_of(Estimate(1.0), None, 0.0, None).is_placed
    False
    """
    if belief is None or estimate.position_m is None:
        return Moment(str(estimate.stage), walked_m)
    x, y = (float(v) for v in estimate.position_m)
    facing = None
    if facing_odom_rad is not None:
        facing = float(wrap_angle(facing_odom_rad + belief.drift_rad))
    spread = None if estimate.stage == Stage.SEARCHING else belief.drift_spread_rad
    return Moment(
        str(estimate.stage), walked_m, (x, y), belief.radii_m[1], facing, spread,
        estimate.level, tuple(each.share for each in estimate.hypotheses), estimate.p_within_2m,
    )  # fmt: skip


def follow_moments(
    plan: FloorPlan | Building,
    scan: Scan | Sequence[Happening],
    odometry: Odometry,
    settings: Settings | None = None,
    seed: int = 0,
) -> list[Moment]:
    """Return a moment for each sample of a recorded walk.

    Parameters
    ----------
    plan, scan, odometry, settings
        As for `palms.track`.
    seed : int
    """
    moments: list[Moment] = []
    walked, facing = odometry.walked_m, odometry.facing_rad

    def watch(estimate: Estimate, belief: Belief, info: MoveInfo) -> None:
        step = len(moments)
        looks = None if facing is None else float(facing[step])
        moments.append(moment_of(estimate, belief, float(walked[step]), looks))

    track(plan, scan, odometry, settings, seed, watch)
    missing = len(odometry.time_s) - len(moments)  # before there was any belief
    return [Moment("searching", float(walked[step])) for step in range(missing)] + moments


def narrate(
    plan: FloorPlan | Building,
    scan: Scan | Sequence[Happening],
    odometry: Odometry,
    settings: Settings | None = None,
    seed: int = 0,
    preferences: Preferences | None = None,
) -> list[Heard]:
    """Return what is said unasked on a recorded walk.

    Parameters
    ----------
    plan, scan, odometry, settings
        As for `palms.track`.
    seed : int
    preferences : Preferences, optional

    Examples
    --------
    >>> from palms.io import open_dataset
    >>> from palms.sample import sample_folder
    >>> case = open_dataset(sample_folder()).cases[0]
    >>> heard = narrate(case.plan(), case.scan(), case.walk().odometry())
    >>> heard[0].saying.kind, heard[0].saying.text
    ('scan', 'Scan taken, eight walls. Many places possible.')
    """
    told = [Happening(-np.inf, scan)] if isinstance(scan, Scan) else list(scan)
    scans = [(time_s, what) for time_s, what, *_ in told if isinstance(what, Scan)]
    narrator = Narrator(Voice(Surroundings.of(plan), preferences or Preferences()))
    moments = follow_moments(plan, scan, odometry, settings, seed)
    return spoken(narrator, moments, odometry.time_s.tolist(), scans)


def spoken(
    narrator: Narrator,
    moments: Sequence[Moment],
    time_s: Sequence[float],
    scans: Sequence[tuple[float, Scan]] = (),
) -> list[Heard]:
    """Return what a narrator says unasked to moments.

    Parameters
    ----------
    narrator : Narrator
    moments : sequence of Moment
    time_s : sequence of float
        Of each moment.
    scans : sequence of (float, Scan)
        With the times that they were taken at.
    """
    waiting, heard = sorted(scans, key=lambda each: each[0]), []
    for step, (now_s, moment) in enumerate(zip(time_s, moments, strict=True)):
        while waiting and waiting[0][0] <= now_s:
            narrator = narrator.scanned(view_of(waiting.pop(0)[1]), None)
        narrator, saying = narrator.hear(moment, now_s)
        if saying is not None:
            heard.append(Heard(step, now_s, saying))
    return heard
