"""Narrator: what is said when; rules and their why: docs/explanation/voice.md.

A narrator is a value. It gets moments as they come and returns itself, one moment later, and
what is to be said, if anything. What could not be said in time is not said later: it compares
what the listener was told last with what is known now.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, NamedTuple

from palms.advice import View
from palms.voice.hints import noted
from palms.voice.moments import Moment
from palms.voice.places import Placed, Voice, sentence
from palms.voice.preferences import MIN_GAP_S, Preferences
from palms.voice.searching import Seen, scanned, searching
from palms.voice.understanding import Understood

__all__ = ["Kind", "Narrator", "Question", "Saying"]

Kind = Literal[
    "scan", "progress", "oriented", "localized", "place", "unsure", "lost", "found", "hint",
    "answer", "pause", "resume", "settings",
]  # fmt: skip
Question = Literal["where", "details", "repeat", "near", "options"]
OF_STAGE: frozenset[Kind] = frozenset(["localized", "unsure", "lost", "found"])
URGENT: frozenset[Kind] = frozenset(["unsure", "lost"])
PROVEN_M = 2.0  # ours: so far one walks before a place that was just found is told
SURE, DOUBTED, SURE_M = 0.99, 0.95, 20.0  # ours: probable for so far, and "probably" is left out
AGAIN_M, FEWER_M = 20.0, 5.0  # ours: how often progress is told; how often when it is better
NEXT_M = 8.0  # ours: how often another neighbour is told in one and the same room
OLD_M = 2.0  # ours: what was said before so many metres is said to be of then


@dataclass(frozen=True, slots=True)
class Saying:
    """A sentence to be said.

    Parameters
    ----------
    kind : str
        As in `palms.server.messages.Say`.
    text : str
        One short sentence.
    details : str or None
        One more, for who wants it.
    language : str
        Of both.
    """

    kind: Kind
    text: str
    details: str | None = None
    language: str = "en"

    @property
    def is_urgent(self) -> bool:
        """Whether it may interrupt another."""
        return self.kind in URGENT


class _Spoken(NamedTuple):
    """What was said last, and when."""

    saying: Saying
    now_s: float
    walked_m: float


@dataclass(frozen=True)
class Narrator:
    """Says what is worth saying, when it may be said.

    Parameters
    ----------
    voice : Voice
    moment : Moment
        The latest.
    told : str
        What the listener knows of the stage: ``searching``, ``oriented``, ``localized``,
        ``unsure`` or ``lost``.
    key : tuple of str or None
        The place that was told last.
    was_placed : bool
        Whether a place was ever told.
    since_m : float or None
        Walked when it became localized; None while it is not.
    sure_m : float or None
        Walked when it became very probable; None while it is not.
    needs_scan : bool
        Whether a place that was told has been lost or unsure since the last scan.
    seen : Seen or None
        A scan that nothing was said about.
    counted : (int or None, float) or None
        How many places were possible when it spoke last, and how far one had walked.
    free_s : float
        When the listener was last spoken to.
    last : tuple or None

    Examples
    --------
    >>> from palms.floorplan import FloorPlan, Room
    >>> from palms.voice.surroundings import Surroundings
    >>> hall = Room("Hall", [[0, 0], [9, 0], [9, 6], [0, 6]])
    >>> plan = FloorPlan([[[0, 0], [9, 0]]], rooms=(hall,))
    >>> narrator = Narrator(Voice(Surroundings.of(plan)))
    >>> narrator, saying = narrator.hear(Moment("localized", 30.0, (4.0, 3.0), 0.8), 50.0)
    >>> saying.text  # just now; it may be gone again
    'One place is likely. Walk on a little.'
    >>> narrator, saying = narrator.hear(Moment("localized", 33.0, (7.0, 3.0), 0.8), 55.0)
    >>> saying.text, saying.details
    ('Found: probably Hall.', 'Accurate to 2 metres.')
    """

    voice: Voice
    moment: Moment = field(default_factory=lambda: Moment("searching"))
    told: str = "searching"
    key: tuple[str, ...] | None = None
    was_placed: bool = False
    since_m: float | None = None
    sure_m: float | None = None
    needs_scan: bool = False
    seen: Seen | None = None
    counted: tuple[int | None, float] | None = None
    free_s: float = -math.inf
    last: _Spoken | None = None

    # What it is told

    def hear(self, moment: Moment, now_s: float) -> tuple[Narrator, Saying | None]:
        """Take a moment; return what is to be said unasked, if anything.

        Parameters
        ----------
        moment : Moment
        now_s : float
            On a clock that never goes back, the listener's.
        """
        now = self._at(moment)
        passed_s = now_s - now.free_s
        kind = None if passed_s < MIN_GAP_S else now._news()
        if kind is None or not now._may_say(kind, passed_s):
            return now, None
        saying = now._saying(kind, *now._words(kind))
        return now._after(kind)._spoken(saying, now_s), saying

    def scanned(self, view: View, facing_rad: float | None) -> Narrator:
        """Take what a scan has seen; it is said with the next moment."""
        return replace(self, seen=Seen(view, facing_rad), needs_scan=False)

    def meanwhile(self, moment: Moment) -> Narrator:
        """Take a moment while nobody listens."""
        return self._at(moment)

    def caught_up(self, moment: Moment) -> Narrator:
        """Return a narrator whose listener knows all this already: after a replay."""
        now = replace(self._at(moment), since_m=moment.walked_m - PROVEN_M)
        now = replace(now, seen=None, counted=(moment.n_places, moment.walked_m))
        if moment.is_placed:
            return replace(now, told="localized", was_placed=True, key=now._placed.key)
        return replace(now, told=moment.stage, since_m=None)

    def preferring(self, preferences: Preferences, now_s: float) -> tuple[Narrator, Saying | None]:
        """Take preferences; return what is said when they cannot be met."""
        now = replace(self, voice=replace(self.voice, preferences=preferences))
        texts, wanted = now.voice.texts, preferences.language
        if wanted.partition("-")[0].lower() == texts.language:
            return now, None
        saying = now._saying("settings", texts.say("language", language=wanted, name=texts.name))
        return now._spoken(saying, now_s), saying

    # What it is asked

    def answer(self, what: Question, now_s: float) -> tuple[Narrator, Saying]:
        """Answer a question."""
        text, details = self._answer(what, now_s)
        saying = self._saying("answer", text, details)
        if what == "repeat":
            return replace(self, free_s=now_s), saying
        return self._spoken(saying, now_s), saying

    def note(self, text: str, heard: Understood, now_s: float) -> tuple[Narrator, Saying]:
        """Say what free words were understood as; see `palms.voice.hints.noted`."""
        saying = self._saying("hint", noted(self.voice, text, heard))
        return self._spoken(saying, now_s), saying

    def pause(self, now_s: float) -> tuple[Narrator, Saying]:
        """Say that it pauses."""
        saying = self._saying("pause", self.voice.texts.say("pause"))
        return self._spoken(saying, now_s), saying

    def resume(self, same_frame: bool, now_s: float) -> tuple[Narrator, Saying]:
        """Say that it goes on; in a new frame a scan is wanted, and the place is told anew."""
        saying = self._saying("resume", self.voice.texts.say("resume" if same_frame else "restart"))
        now = self if same_frame else replace(self, told="searching", since_m=None, key=None)
        return now._spoken(saying, now_s), saying

    # How it decides

    def _at(self, moment: Moment) -> Narrator:
        since, sure = self.since_m, self.sure_m
        if not moment.is_placed:
            since = None
        elif since is None:
            since = moment.walked_m
        if since is None or moment.p_within_2m < (DOUBTED if self._is_sure else SURE):
            sure = None
        elif sure is None:
            sure = moment.walked_m
        left = self.told == "localized" and not moment.is_placed
        lost = self.needs_scan or left or moment.stage == "lost"
        return replace(self, moment=moment, since_m=since, sure_m=sure, needs_scan=lost)

    @property
    def _is_sure(self) -> bool:
        """Whether the place may be told without a doubt: very probable for a good while."""
        if self.sure_m is None or self.needs_scan:
            return False
        return self.moment.walked_m - self.sure_m >= SURE_M

    @cached_property
    def _placed(self) -> Placed:
        return self.voice.placed(self.moment, self._is_sure)

    @property
    def _is_placed(self) -> bool:
        """Whether the place may be told: localized, and for a little while."""
        if not self.moment.is_placed or self.since_m is None:
            return False
        return self.moment.walked_m - self.since_m >= PROVEN_M

    def _may_say(self, kind: Kind, passed_s: float) -> bool:
        """Whether something may be said unasked, so long after the last word."""
        if kind in OF_STAGE:
            return passed_s >= MIN_GAP_S
        wanted = self.voice.preferences
        return not wanted.quiet and passed_s >= wanted.every_s

    def _news(self) -> Kind | None:
        """Return what the listener does not know yet, the most important first."""
        if (kind := self._news_of_stage()) is not None:
            return kind
        if self.seen is not None:
            return "scan"
        if self.told == "localized":
            return "place" if self._has_moved_on() else None
        if self.moment.stage == "oriented" and self.told == "searching":
            return "oriented"
        return "progress" if self._has_come_on() else None

    def _news_of_stage(self) -> Kind | None:
        if self.moment.stage == "lost":
            return "lost" if self.told != "lost" else None
        if self.told != "localized":
            new: Kind = "found" if self.was_placed else "localized"
            return new if self._is_placed else None
        return None if self.moment.is_placed else "unsure"

    def _has_come_on(self) -> bool:
        if self.counted is None:
            return True
        n, walked_m = self.counted
        on_m, now = self.moment.walked_m - walked_m, self.moment.n_places
        fewer = now is not None and (n is None or now < n)
        return on_m >= AGAIN_M or (on_m >= FEWER_M and fewer)

    def _has_moved_on(self) -> bool:
        """Whether another place is to be told: another room, or after a while a neighbour."""
        if not self._is_placed:
            return False
        key, told = self._placed.key, self.key or ()
        if key[:2] != told[:2]:
            return True
        _, walked_m = self.counted or (None, -math.inf)
        return key != told and self.moment.walked_m - walked_m >= NEXT_M

    def _words(self, kind: Kind) -> tuple[str, str | None]:
        texts = self.voice.texts
        if kind in ("localized", "found", "place"):
            placed = self._placed
            told = placed.text if kind == "place" else texts.say(kind, place=placed.text)
            return sentence(told), placed.details
        if kind == "unsure":
            return texts.say("unsure"), None
        if kind == "scan":
            assert self.seen is not None
            return scanned(self.voice, self.seen, self.moment)
        places, advice = searching(self.voice, self.moment)
        if kind == "oriented":
            return texts.say("oriented"), places if advice is None else f"{places} {advice}"
        return places, advice

    def _after(self, kind: Kind) -> Narrator:
        """Return the narrator when its listener knows that."""
        stage = {"localized": "localized", "found": "localized", "unsure": "unsure", "lost": "lost",
                 "oriented": "oriented"}.get(kind, self.told)  # fmt: skip
        now = replace(
            self, told=stage, seen=None if kind == "scan" else self.seen,
            counted=(self.moment.n_places, self.moment.walked_m),
        )  # fmt: skip
        if kind in ("localized", "found", "place"):
            return replace(now, was_placed=True, key=self._placed.key)
        return now if kind == "scan" else replace(now, key=None)

    def _answer(self, what: Question, now_s: float) -> tuple[str, str | None]:
        if what == "repeat":
            return self._again(now_s)
        if not self._is_placed:
            text, details = searching(self.voice, self.moment)
            return (details or text, None) if what == "details" else (text, details)
        if what == "near":
            return self.voice.around(self.moment, self._is_sure), None
        placed = self._placed
        if what == "details" and placed.details is not None:
            return placed.details, None
        return sentence(placed.text), placed.details

    def _again(self, now_s: float) -> tuple[str, str | None]:
        """Return what was said last; how long ago, when one has walked on since."""
        if self.last is None:
            return self.voice.texts.say("nothing"), None
        saying, then_s, walked_m = self.last
        if self.moment.walked_m - walked_m < OLD_M:
            return saying.text, saying.details
        ago_s = max(round(now_s - then_s), 1)
        return sentence(self.voice.texts.say("ago.many", n=ago_s, text=saying.text)), saying.details

    def _saying(self, kind: Kind, text: str, details: str | None = None) -> Saying:
        if self.voice.preferences.details and details is not None:
            text, details = f"{text} {details}", None
        return Saying(kind, text, details, self.voice.texts.language)

    def _spoken(self, saying: Saying, now_s: float) -> Narrator:
        last = _Spoken(saying, now_s, self.moment.walked_m)
        return replace(self, free_s=now_s, last=last)
