"""Follower: a localizer with what it needs to take a phone's inputs and to answer.

Same plan, same settings, same seed, same inputs: same state, to the bit. The clock of the server,
the network and the other sessions have no part in it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palms.belief import Hypothesis, Stage
from palms.errors import InputError
from palms.geometry import wrap_angle
from palms.hints import Hint
from palms.io.track_json import lonlat
from palms.localizer import Localizer
from palms.odometry import Move
from palms.randomness import as_key
from palms.scan import Scan
from palms.server import messages
from palms.server.floor import Floor
from palms.server.intake import Intake, away_s, clocked, in_new_frame, taken
from palms.server.levels import LevelKnown, check_kept, level_hint, level_known, level_told
from palms.server.reckoner import Reckoner, reckoned
from palms.server.scans import read_scan
from palms.settings import Settings
from palms.voice import Understood, understand

__all__ = ["Floor", "Follower", "Outcome", "Terms"]

START_SURE = 0.9  # ours: how often the level that a walk is said to start on is right
WORTH_SAYING = 0.01  # ours: places of less probability are not told
log = logging.getLogger("palms.server")


@dataclass(frozen=True, slots=True)
class Terms:
    """What a session was opened with, for good."""

    method: str = "palms"
    particles: int | None = None
    seed: int = 0
    source: str = "vio"
    frame: str = "scan"
    start_level: str | None = None

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
    hint : Hint or None
        The hint that was taken.
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
    hint: Hint | None = None
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
    >>> from palms.server.naming import Namer
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
        self.intake = Intake()
        self.seq = 0
        self._reckoner = Reckoner()
        self.watch: Callable[[Move], object] | None = None
        self._was_localized = False
        self._heard: Understood | None = None
        self._stage = Stage.SEARCHING
        self._is_away = False  # since the frame is new, until something comes with a time
        self._level_known: LevelKnown | None = None
        kind: Any = terms.source
        self.localizer = Localizer(
            floor.ground, terms.settings(), as_key(terms.seed), terms.frame == "own", source=kind
        )
        self.settings = self.localizer.settings
        if terms.start_level is not None:
            self.localizer.hint(Hint(level=terms.start_level, probability=START_SURE))

    def apply(self, message: messages.Input) -> Outcome:
        """Take one input; what is wrong with it is said, and no state is half-done.

        Parameters
        ----------
        message : messages.Input
            Its sequence number is the caller's business.
        """
        self.seq, self._heard = message.seq, None
        events: list[messages.EventKind] = []
        held, error, is_defect = None, None, False
        try:
            held = self._take(message, events)
        except InputError as problem:
            error = str(problem)
        except Exception:  # whatever it is, the other sessions and this one go on
            log.exception("an input could not be followed")
            error, is_defect = "a defect of palms; its log says more", True
        events += self._stage_events()
        t_s = self._phone_time()
        told = tuple((kind, t_s) for kind in events)
        self._level_known = level_known(self.localizer, self._level_known)
        scan = held if isinstance(held, Scan) else None
        hint = held if isinstance(held, Hint) else None
        return Outcome(self.estimate(), told, scan, hint, error, is_defect, self._heard)

    def _take(
        self, message: messages.Input, events: list[messages.EventKind]
    ) -> Scan | Hint | None:
        """Take an input; return the scan or the hint that it holds."""
        match message:
            case messages.Odometry():
                for sample in message.samples:
                    self._move(sample)
            case messages.Scan():
                events.append("scanning")
                return self._observe(message)
            case messages.Hint() | messages.LevelChange():
                return self._listen(message)
            case messages.Tell():
                return self._hear(message)
            case messages.Inertial():
                self._reckoner, samples = reckoned(self._reckoner, message)
                for sample in samples:
                    self._move(sample)
            case messages.Pause():
                events.append("paused")
                self.intake = replace(self.intake, is_paused=True)
            case messages.Resume():
                events.append("resumed" if message.same_frame else "restarted")
                self._resume(message)
        return None

    def _listen(self, message: messages.Hint | messages.LevelChange) -> Hint | None:
        """Take what somebody, or the phone's barometer, says of where it is."""
        if isinstance(message, messages.Hint):
            hint = _hint(message, self.floor)
        else:
            if message.t_s is not None:
                self._come_back(message.t_s)
                self.intake = clocked(self.intake, message.t_s)
            hint = level_hint(message, self.floor, self._level_known)
        if hint is not None:
            self.localizer.hint(hint)
            self._level_known = level_told(hint, self.floor) or self._level_known
        return hint

    def _move(self, sample: messages.Sample) -> None:
        if not self.intake.is_paused:
            self._come_back(sample.t_s)
        self.intake, move = taken(self.intake, sample)
        if move is not None:
            self.localizer.move(move)
            if self.watch is not None:
                self.watch(move)

    def _observe(self, message: messages.Scan) -> Scan:
        scan = read_scan(message, self.intake.position_m or (0.0, 0.0))
        self._come_back(message.t_s)
        self.intake = clocked(self.intake, message.t_s)
        if self.intake.position_m is None:
            x, y = (float(v) for v in scan.position_m)
            self.intake = replace(self.intake, position_m=(x, y))
        self.localizer.observe(scan, np.array(self.intake.position_m))
        return scan

    def _hear(self, message: messages.Tell) -> Hint | None:
        """Take free words as a hint, where they are understood."""
        around = self.floor.around
        self._heard = heard = understand(message.text, around.rooms, around.levels)
        if heard.kind not in ("room", "level"):
            return None
        level = heard.level if self.floor.building is not None else None
        if heard.room is None and level is None:
            return None
        return self._listen(
            messages.Hint.model_construct(
                seq=message.seq, room=heard.room, level=level, probability=heard.probability
            )
        )

    def _resume(self, message: messages.Resume) -> None:
        self.intake = replace(self.intake, is_paused=False)
        if message.same_frame:
            return
        self.intake = in_new_frame(self.intake)
        self._reckoner = Reckoner()
        self._is_away = message.away_s is None
        self.localizer.restart(message.away_s or 0.0)

    def _come_back(self, t_s: float) -> None:
        """Let the belief spread by the time that passed before the new frame began."""
        passed_s = away_s(self.intake, t_s) if self._is_away else 0.0
        self._is_away = False
        if passed_s > 0:
            self.localizer.restart(passed_s)

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
        level = self.floor.level if found.level is None else found.level
        common: dict[str, Any] = {
            "seq": self.seq, "t_s": self._phone_time() or 0.0, "stage": str(found.stage),
            "level": level, "p_level": 0.0 if level is None else found.p_level,
            "walked_m": self.intake.walked_m, "n_late": self.intake.n_late,
        }  # fmt: skip
        if found.position_m is None or belief is None:
            return messages.Estimate.model_construct(**common)
        x, y = (float(v) for v in found.position_m)
        facing = self.intake.facing_rad
        return messages.Estimate.model_construct(
            **common, **self._on_earth(x, y), x_m=x, y_m=y, room=self.floor.name_of(x, y, level),
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

    def _place(self, found: Hypothesis) -> messages.Place:
        level = self.floor.level if found.level is None else found.level
        return messages.Place.model_construct(
            x_m=found.x_m, y_m=found.y_m, p=found.share, drift_rad=found.drift_rad, level=level,
            room=self.floor.name_of(found.x_m, found.y_m, level),
        )  # fmt: skip

    def _on_earth(self, x: float, y: float) -> dict[str, Any]:
        origin = self.floor.origin
        if origin is None:
            return {}
        lon, lat = lonlat(origin, (x, y))
        return {"lon": lon, "lat": lat}


def _hint(message: messages.Hint, floor: Floor) -> Hint | None:
    """Return the hint of a message; None where it says what is known."""
    place, level = message.place_m, message.level
    if level is not None and floor.building is None:
        check_kept(level, floor)
        level = None
        if message.room is None and place is None:
            return None
    return Hint(
        place_m=None if place is None else np.array(place), radius_m=message.radius_m,
        room=message.room, level=level, probability=message.probability,
    )  # fmt: skip
