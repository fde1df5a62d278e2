"""A simulated walk, what is said on it, and whether that is so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.voice.judge import Judge, Truth, Verdict
from palms.evaluation.simulation import (
    CaseSettings,
    generate_levels,
    make_site,
    simulate_start,
    simulate_walk,
)
from palms.odometry import Odometry
from palms.voice import Narrator, Preferences, Saying, Surroundings, Voice
from palms.voice.recorded import Heard, follow_moments, spoken

PLACES = ("localized", "found", "place")


@dataclass(frozen=True)
class Sentence:
    """A sentence of a walk; its verdict when it is about a place."""

    seed: int
    time_s: float
    walked_m: float
    saying: Saying
    verdict: Verdict | None
    error_m: float


@dataclass(frozen=True)
class Walk:
    """All sentences of a walk, and how long it was."""

    seed: int
    length_m: float
    sentences: tuple[Sentence, ...]

    @property
    def about_place(self) -> list[Sentence]:
        return [each for each in self.sentences if each.verdict is not None]

    def first_m(self, sure: bool = False) -> float | None:
        """How far it was walked when a place was said; without "probably" where that is asked."""
        told = (
            each.walked_m for each in self.about_place
            if each.verdict is not None and (each.verdict.is_sure or not sure)
        )  # fmt: skip
        return next(told, None)


def speak(seed: int, preferences: Preferences | None = None) -> Walk:
    """Simulate a building, a scan and a walk in it; judge what is said.

    Every second walker goes into rooms.
    """
    site = make_site(generate_levels("office", seed, 1), seed=seed)
    settings = CaseSettings(rooms=bool(seed % 2))
    case = simulate_walk(site, simulate_start(site, 0, [], settings), 0, settings)
    plan, odometry, truth = site.drawings[0], case.recorded.arkit, case.recorded.truth
    assert odometry is not None
    assert truth is not None
    around = Surroundings.of(plan)
    judge = Judge(around)
    moments = follow_moments(plan, case.scans[0], odometry, seed=seed)
    narrator = Narrator(Voice(around, preferences or Preferences()))
    sentences = []
    for heard in spoken(narrator, moments, odometry.time_s.tolist(), [(0.0, case.scans[0])]):
        here, place = truth.position_m[heard.step], moments[heard.step].position_m
        off = float("nan") if place is None else float(np.hypot(*(here - place)))
        was = Truth(float(here[0]), float(here[1]), float(case.facing_rad[heard.step]), off)
        sentences.append(_judged(seed, heard, was, judge, odometry))
    return Walk(seed, float(odometry.walked_m[-1]), tuple(sentences))


def _judged(seed: int, heard: Heard, was: Truth, judge: Judge, odometry: Odometry) -> Sentence:
    verdict = judge.judge(heard.saying, was) if heard.saying.kind in PLACES else None
    walked = float(odometry.walked_m[heard.step])
    return Sentence(seed, heard.time_s, walked, heard.saying, verdict, was.error_m)
