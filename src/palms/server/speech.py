"""Speech: a session in words, for whoever walks."""

from __future__ import annotations

import time
from collections.abc import Callable

from palms.advice import View, view_of
from palms.server import messages
from palms.server.follower import Follower, Outcome
from palms.voice import Moment, Narrator, Preferences, Saying, Voice

__all__ = ["Speech", "moment_of"]


def moment_of(estimate: messages.Estimate) -> Moment:
    """Return what the voice needs of an estimate.

    Examples
    --------
    >>> moment_of(messages.Estimate(seq=1, t_s=2.0, stage="searching")).position_m is None
    True
    """
    x, y = estimate.x_m, estimate.y_m
    return Moment(
        estimate.stage, estimate.walked_m, None if x is None or y is None else (x, y),
        estimate.radius_95_m, estimate.facing_rad, estimate.drift_spread_rad, estimate.level,
        tuple(place.p for place in estimate.hypotheses), estimate.p_within_2m,
    )  # fmt: skip


class Speech:
    """What one session says to its walker.

    Who comes back after a restart of the server is told no more than what is new.

    Parameters
    ----------
    follower : Follower
    now_s : callable
        A clock that never goes back: the rules are about ears, not about the phone's clock.
    """

    def __init__(self, follower: Follower, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._n = 0
        self._latest = follower.estimate()
        narrator = Narrator(Voice(follower.floor.around))
        known = follower.seq > 0
        self._narrator = narrator.caught_up(moment_of(self._latest)) if known else narrator

    def meanwhile(self, outcome: Outcome) -> None:
        """Take what an input led to, while nobody listens."""
        self._latest = outcome.estimate
        self._narrator = self._narrator.meanwhile(moment_of(outcome.estimate))

    def follow(
        self, message: messages.Input, outcome: Outcome, facing_rad: float | None
    ) -> list[messages.Say]:
        """Return what is to be said after an input.

        Parameters
        ----------
        message : messages.Input
        outcome : Outcome
            What it led to.
        facing_rad : float or None
            Where the phone looks, odom frame.
        """
        self._latest = outcome.estimate
        said = [self._reply(message, outcome, facing_rad)]
        self._narrator, unasked = self._narrator.hear(moment_of(outcome.estimate), self._now_s())
        said.append(unasked)
        return [self._numbered(each) for each in said if each is not None]

    def _reply(
        self, message: messages.Input, outcome: Outcome, facing_rad: float | None
    ) -> Saying | None:
        """Return what answers the input itself."""
        now, now_s, said = self._narrator, self._now_s(), None
        match message:
            case messages.Scan():
                view = None if outcome.scan is None else view_of(outcome.scan)
                now = now.scanned(view or View(0, True, ()), facing_rad)
            case messages.Tell() if outcome.heard is not None:
                now, said = now.note(message.text, outcome.heard, now_s)
            case messages.Pause():
                now, said = now.pause(now_s)
            case messages.Resume():
                now, said = now.resume(message.same_frame, now_s)
        self._narrator = now
        return said

    def ask(self, question: messages.Question) -> messages.Say:
        """Return the answer to a question."""
        self._narrator, saying = self._narrator.answer(question, self._now_s())
        return self._numbered(saying)

    def prefer(self, wanted: messages.Preferences) -> list[messages.Say]:
        """Take preferences; return what is said when they cannot be met."""
        preferences = Preferences(**wanted.model_dump(exclude={"type"}))
        self._narrator, saying = self._narrator.preferring(preferences, self._now_s())
        return [] if saying is None else [self._numbered(saying)]

    def _numbered(self, saying: Saying) -> messages.Say:
        self._n += 1
        latest = self._latest
        return messages.Say(
            number=self._n, seq=latest.seq, t_s=latest.t_s if latest.seq else None,
            kind=saying.kind, text=saying.text, details=saying.details,
            urgent=saying.is_urgent, language=saying.language,
        )  # fmt: skip
