"""Follower: a localizer with what it needs to take a phone's inputs and to answer.

Same plan, same settings, same seed, same inputs: same state, to the bit. The clock of the server,
the network and the other sessions have no part in it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from palms.belief import Stage
from palms.errors import InputError
from palms.geometry import wrap_angle
from palms.hints import Hint
from palms.io.track_json import lonlat
from palms.localizer import Localizer
from palms.odometry import Move
from palms.randomness import as_key
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.server import messages
from palms.server.intake import Intake, clocked, taken
from palms.server.naming import Namer
from palms.server.reckoner import Reckoner, reckoned
from palms.server.scans import read_scan
from palms.settings import Settings
from palms.voice import Surroundings, Understood, understand

__all__ = ["Floor", "Follower", "Outcome", "Terms"]

WORTH_SAYING = 0.01  # ours: places of less probability are not told
_RESTART = 31  # purpose of random numbers
log = logging.getLogger("palms.server")


@dataclass(frozen=True)
class Floor:
    """A level that sessions share: its raster, and who names its rooms."""

    raster: PlanRaster
    name_of: Namer
    level: str

    @cached_property
    def around(self) -> Surroundings:
        """Its rooms, for the voice; made once."""
        return Surroundings((self.raster.plan,), (self.level,))


@dataclass(frozen=True, slots=True)
class Terms:
    """What a session was opened with, for good."""

    method: str = "palms"
    particles: int | None = None
    seed: int = 0
    source: str = "vio"
    frame: str = "scan"

    def settings(self) -> Settings:
        """Return the settings of its method.

        Raises
        ------
        SettingsError
            When there is no such method.
        """
        settings = Settings.for_method(self.method)
        return settings if self.particles is None else settings.with_particles(self.particles)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What an input led to.

    Parameters
    ----------
    estimate : messages.Estimate
    events : tuple of (kind, t_s)
    scan : Scan or None
        The scan that was taken, for whoever wants heatmaps.
    error : str or None
        Why the input, or a part of it, could not be used.
    is_defect : bool
        Whether palms is to blame for that.
    heard : Understood or None
        What free words were understood as.
    """

    estimate: messages.Estimate
    events: tuple[tuple[messages.EventKind, float | None], ...] = ()
    scan: Scan | None = None
    error: str | None = None
    is_defect: bool = False
    heard: Understood | None = None


class Follower:
    """Takes inputs one after the other and answers each.

    Parameters
    ----------
    floor : Floor
    terms : Terms

    Examples
    --------
    >>> from palms import FloorPlan, rasterize
    >>> plan = FloorPlan([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> follower = Follower(Floor(rasterize(plan), Namer(plan), "1"), Terms())
    >>> outcome = follower.apply(messages.Scan(
    ...     seq=1, t_s=5.0, planes=((((4, -1), (4, 3))), (((-2, 3), (4, 3))), (((-2, -1), (-2, 3))))
    ... ))
    >>> outcome.error, outcome.estimate.t_s, outcome.events[0]
    (None, 5.0, ('scanning', 5.0))
    """

    def __init__(self, floor: Floor, terms: Terms) -> None:
        self.floor = floor
        self.terms = terms
        self.settings = terms.settings()
        self.intake = Intake()
        self.seq = 0
        self._reckoner = Reckoner()
        self.watch: Callable[[Move], object] | None = None
        self._n_restarts = 0
        self._was_localized = False
        self._heard: Understood | None = None
        self._stage = Stage.SEARCHING
        self.localizer = self._new()

    def _new(self) -> Localizer:
        key = as_key(self.terms.seed)
        if self._n_restarts:
            key = key.child(_RESTART, self._n_restarts)
        own, source = self.terms.frame == "own", self.terms.source
        kind: Any = source
        return Localizer(self.floor.raster, self.settings, key, own, source=kind)

    def apply(self, message: messages.Input) -> Outcome:
        """Take one input; what is wrong with it is said, and no state is half-done.

        Parameters
        ----------
        message : messages.Input
            Its sequence number is the caller's business.
        """
        self.seq, self._heard = message.seq, None
        events: list[messages.EventKind] = []
        scan, error, is_defect = None, None, False
        try:
            scan = self._take(message, events)
        except InputError as problem:
            error = str(problem)
        except Exception:  # whatever it is, the other sessions and this one go on
            log.exception("an input could not be followed")
            error, is_defect = "a defect of palms; its log says more", True
        events += self._stage_events()
        t_s = self._phone_time()
        told = tuple((kind, t_s) for kind in events)
        return Outcome(self.estimate(), told, scan, error, is_defect, self._heard)

    def _take(self, message: messages.Input, events: list[messages.EventKind]) -> Scan | None:
        match message:
            case messages.Odometry():
                for sample in message.samples:
                    self._move(sample)
            case messages.Scan():
                events.append("scanning")
                return self._observe(message)
            case messages.Hint():
                self.localizer.hint(_hint(message))
            case messages.Tell():
                self._listen(message.text)
            case messages.Inertial():
                self._reckoner, samples = reckoned(self._reckoner, message)
                for sample in samples:
                    self._move(sample)
            case messages.Pause():
                events.append("paused")
                self.intake = replace(self.intake, is_paused=True)
            case messages.Resume():
                events.append("resumed" if message.same_frame else "restarted")
                self._resume(message.same_frame)
        return None

    def _move(self, sample: messages.Sample) -> None:
        self.intake, move = taken(self.intake, sample)
        if move is not None:
            self.localizer.move(move)
            if self.watch is not None:
                self.watch(move)

    def _observe(self, message: messages.Scan) -> Scan:
        scan = read_scan(message, self.intake.position_m or (0.0, 0.0))
        self.intake = clocked(self.intake, message.t_s)
        if self.intake.position_m is None:
            x, y = (float(v) for v in scan.position_m)
            self.intake = replace(self.intake, position_m=(x, y))
        self.localizer.observe(scan, np.array(self.intake.position_m))
        return scan

    def _listen(self, text: str) -> None:
        """Take free words as a hint, where they are understood."""
        around = self.floor.around
        self._heard = understand(text, around.rooms, around.levels)
        if self._heard.kind == "room":
            hint = Hint(room=self._heard.room, probability=self._heard.probability)
            self.localizer.hint(hint)

    def _resume(self, same_frame: bool) -> None:
        self.intake = replace(self.intake, is_paused=False)
        if same_frame:
            return
        self.intake = Intake(walked_m=self.intake.walked_m, n_late=self.intake.n_late)
        self._reckoner = Reckoner()
        self._n_restarts += 1
        self.localizer = self._new()

    def _stage_events(self) -> list[messages.EventKind]:
        before, now = self._stage, self.localizer.estimate.stage
        self._stage = now
        if now == before:
            return []
        if now == Stage.LOCALIZED:
            kind: messages.EventKind = "relocalized" if self._was_localized else "localized"
            self._was_localized = True
            return [kind]
        if now == Stage.LOST:
            return ["lost"]
        if before == Stage.LOCALIZED:
            return ["unsure"]
        return ["oriented"] if now == Stage.ORIENTED and before == Stage.SEARCHING else []

    def _phone_time(self) -> float | None:
        offset = self.intake.offset_s
        return None if offset is None else offset + self.localizer.estimate.time_s

    def estimate(self) -> messages.Estimate:
        """Return the answer now, as it goes to clients."""
        found, belief = self.localizer.estimate, self.localizer.belief
        common: dict[str, Any] = {
            "seq": self.seq, "t_s": self._phone_time() or 0.0, "stage": str(found.stage),
            "level": self.floor.level, "walked_m": self.intake.walked_m,
            "n_late": self.intake.n_late,
        }  # fmt: skip
        if found.position_m is None or belief is None:
            return messages.Estimate.model_construct(**common)
        x, y = (float(v) for v in found.position_m)
        facing = self.intake.facing_rad
        return messages.Estimate.model_construct(
            **common, **self._on_earth(x, y), x_m=x, y_m=y, room=self.floor.name_of(x, y),
            heading_rad=found.heading_rad, drift_rad=found.drift_rad,
            drift_spread_rad=self._drift_spread(),
            facing_rad=None if facing is None else float(wrap_angle(facing + belief.drift_rad)),
            p_within_1m=found.p_within_1m, p_within_2m=found.p_within_2m,
            radius_68_m=found.radius_68_m, radius_95_m=found.radius_95_m,
            hypotheses=tuple(
                self._place(each) for each in found.hypotheses if each.share >= WORTH_SAYING
            ),
        )  # fmt: skip

    def _drift_spread(self) -> float | None:
        """Return how sure the drift is; nobody asks while it may be anything."""
        belief = self.localizer.belief
        if belief is None or belief.stage == Stage.SEARCHING:
            return None
        return belief.drift_spread_rad

    def _place(self, found: Any) -> messages.Place:  # noqa: ANN401
        return messages.Place.model_construct(
            x_m=found.x_m, y_m=found.y_m, p=found.share, drift_rad=found.drift_rad,
            room=self.floor.name_of(found.x_m, found.y_m),
        )  # fmt: skip

    def _on_earth(self, x: float, y: float) -> dict[str, Any]:
        origin = self.floor.raster.plan.origin
        if origin is None:
            return {}
        lon, lat = lonlat(origin, (x, y))
        return {"lon": lon, "lat": lat}


def _hint(message: messages.Hint) -> Hint:
    place = message.place_m
    return Hint(
        place_m=None if place is None else np.array(place), radius_m=message.radius_m,
        room=message.room, probability=message.probability,
    )  # fmt: skip
