"""The lines of the table: goal, what was reached, and the command that measured it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.goals.figures import (
    Trials,
    alarms_per_km,
    figure,
    mean,
    metres_ratio,
    of,
    off_by,
    ratio,
    reliability_of,
)
from benchmarks.simulated.events import BY_M, found_again, is_wrong, right_after_m, right_by
from palms.evaluation.simulation import is_angled

Find = Callable[[str], Trials]

BUILDINGS = "python -m benchmarks.simulated buildings"
EVENTS = "python -m benchmarks.simulated events"
RADISH = "python -m benchmarks.real --starts reporting"
MALL = "python -m benchmarks.mall"
NUISANCES = "python -m benchmarks.simulated nuisances"


@dataclass(frozen=True)
class Line:
    """One goal.

    Parameters
    ----------
    what, goal, reached : str
    met : bool or None
        None where there is nothing to meet.
    command : str
        That measured it.
    """

    what: str
    goal: str
    reached: str
    met: bool | None
    command: str


def buildings(find: Find) -> Iterator[Line]:
    """Yield the lines of the simulated buildings: all, and those without right angles."""
    trials = find("buildings")
    angled = [t for t in trials if is_angled(int(t["scene"].rpartition("-")[2]))]
    for chosen, where in (
        (trials, "400 buildings"),
        (angled, f"the {len(of(angled))} without right angles"),
    ):
        ours = of(chosen)
        for name, word in (
            ("wrong", "`wrong`, of all walks"),
            ("false_localized", "`false_localized`"),
        ):
            found = figure(ours, name)
            yield Line(
                f"{where}: {word}", "at most 1 %", f"{_percent(found)}", found.value <= 0.01,
                BUILDINGS,
            )  # fmt: skip
        yield from _against_oracle(chosen, where)


def _against_oracle(trials: Trials, where: str) -> Iterator[Line]:
    for name in ("declared", "useful"):
        found = ratio(trials, name)
        each = f"{mean(of(trials), name):.2f} and {mean(of(trials, 'oracle'), name):.2f}"
        yield Line(
            f"{where}: `{name}` over the oracle's", "at least 0.95", f"{found:.2f} ({each})",
            found >= 0.95, BUILDINGS,
        )  # fmt: skip
    found = metres_ratio(trials)
    yield Line(
        f"{where}: metres to a right declaration over the oracle's, both right", "at most 1.15",
        f"{found:.2f}", found <= 1.15, BUILDINGS,
    )  # fmt: skip


def calibration(find: Find) -> Iterator[Line]:
    """Yield the lines of radii, probabilities and alarms."""
    trials = find("buildings")
    ours = of(trials)
    for name, low, high in (("coverage_68", 0.65, 0.71), ("coverage_95", 0.92, 0.98)):
        found = figure(ours, name)
        yield Line(
            f"400 buildings: {name}", f"{low:.2f} to {high:.2f}", f"{found:.2f}",
            low <= round(found.value, 2) <= high, BUILDINGS,
        )  # fmt: skip
    radius = figure(ours, "radius_95_m_median")
    yield Line(
        "median radius_95 while localized", "at most 1.5 m", f"{radius:.2f} m",
        radius.value <= 1.5, BUILDINGS,
    )  # fmt: skip
    stated, oracles = reliability_of(ours), reliability_of(of(trials, "oracle"))
    missed = off_by(stated)
    yield Line(
        "reliability of p_within_1m", "each bin within 0.03, or inside its interval",
        "all" if not missed else "not " + "; ".join(missed), not missed, BUILDINGS,
    )  # fmt: skip
    over = stated.brier.value / oracles.brier.value
    yield Line(
        "its Brier score over the oracle's", "at most 1.05", f"{over:.2f} ({stated.brier:.3f})",
        over <= 1.05, BUILDINGS,
    )  # fmt: skip
    alarms = alarms_per_km(ours)
    yield Line(
        "false alarms of `lost` in 1,000 m", "at most 1", f"{alarms:.2f}", alarms.value <= 1,
        BUILDINGS,
    )  # fmt: skip


def nuisances(find: Find, names: tuple[str, ...]) -> Iterator[Line]:
    """Yield the line of the doubled nuisances."""
    false = {name: mean(of(find(f"nuisances {name}")), "false_localized") for name in names}
    worst = max(false, key=lambda name: false[name])
    above = sum(value > 0.02 for value in false.values())
    yield Line(
        "every nuisance doubled, one at a time: `false_localized`", "at most 2 %",
        f"{100 * false[worst]:.1f} % at the worst (`{worst}`); {above} of {len(names)} above",
        above == 0, NUISANCES,
    )  # fmt: skip


def radish(find: Find) -> Iterator[Line]:
    """Yield the lines of the real laser scans."""
    goals = {"as-is": (0.01, 0.75, 10.0), "10cm": (0.02, 0.70, 12.0), "20cm": (0.03, 0.60, 15.0)}
    for grade, (false, useful, metres) in goals.items():
        ours = of([t for t in find("radish") if (t["suite"], t["grade"]) == ("clean", grade)])
        found = figure(ours, "false_localized")
        yield Line(
            f"Radish, plan {grade}: `false_localized`", f"at most {100 * false:.0f} %",
            _percent(found), found.value <= false, RADISH,
        )  # fmt: skip
        found = figure(ours, "useful")
        yield Line(
            f"Radish, plan {grade}: `useful`", f"at least {useful:.2f}", f"{found:.2f}",
            found.value >= useful, RADISH,
        )  # fmt: skip
        found = figure(ours, "right_after_m_median")
        yield Line(
            f"Radish, plan {grade}: median metres to a right declaration", f"at most {metres:.0f}",
            f"{found:.0f}", found.value <= metres, RADISH,
        )  # fmt: skip


def mall(find: Find) -> Iterator[Line]:
    """Yield the line of the mall."""
    ours = of([t for t in find("mall") if not t["crosses"] and t["frame"] == "scan"])
    found = figure(ours, "wrong")
    yield Line(
        "mall, walks without crossing legs: `wrong`", "0 seen", _percent(found),
        found.value == 0, MALL,
    )  # fmt: skip


def events(find: Find) -> Iterator[Line]:
    """Yield the lines of what happens on the way."""
    yield from _inertial(find("inertial"))
    soon = right_by(BY_M)
    one, two, oracle = (
        float(np.mean([soon(t) for t in of(find(name), method)]))
        for name, method in (
            ("plain", "palms"),
            ("second-scan", "palms"),
            ("second-scan", "oracle"),
        )
    )
    yield Line(
        f"a second scan after 20 m: declared rightly by {BY_M:.0f} m",
        "1.5 times one scan's, or 95 % of the oracle's",
        f"{two:.2f}: {two / one:.2f} times, {100 * two / oracle:.0f} %",
        two >= 1.5 * one or two >= 0.95 * oracle, EVENTS,
    )  # fmt: skip
    again, oracles = (
        float(np.nanmean([found_again(t) for t in of(find("jump"), method)]))
        for method in ("palms", "oracle")
    )
    yield Line(
        "a jump by 20 m: found again within 30 m", "95 % of the oracle's",
        f"{again:.2f}; the oracle's {oracles:.2f}",
        again >= 0.95 * oracles if oracles else None, EVENTS,
    )  # fmt: skip
    scanned = float(np.nanmean([found_again(t) for t in of(find("jump-and-scan"))]))
    yield Line(
        "the same after a new scan", "0.95", f"{scanned:.2f}", scanned >= 0.95, EVENTS,
    )  # fmt: skip
    yield from _hints(find)


def _inertial(trials: Trials) -> Iterator[Line]:
    false, declared = figure(of(trials), "false_localized"), ratio(trials, "declared")
    if math.isnan(declared):
        yield Line(
            "inertial odometry, unknown frame: `false_localized`; declared over the oracle's",
            "at most 1 %; at least 0.90", "neither ever declares", None, EVENTS,
        )  # fmt: skip
        return
    yield Line(
        "inertial odometry, unknown frame: `false_localized`", "at most 1 %", _percent(false),
        false.value <= 0.01, EVENTS,
    )  # fmt: skip
    yield Line(
        "the same: declared over the oracle's", "at least 0.90", f"{declared:.2f}",
        declared >= 0.9, EVENTS,
    )  # fmt: skip


def _hints(find: Find) -> Iterator[Line]:
    before = [right_after_m(t) for t in of(find("plain"))]
    for name, words in (("right-room", "the right room"), ("right-place", "the right 5 m")):
        after = [right_after_m(t) for t in of(find(name))]
        share = float(np.median(after) / np.median(before))
        yield Line(
            f"a hint, {words}: metres to a right declaration", "halved",
            f"median {np.median(before):.1f} to {np.median(after):.1f} m", share <= 0.5, EVENTS,
        )  # fmt: skip
    plain = float(np.mean([is_wrong(t) for t in of(find("plain"))]))
    for name in ("wrong-room", "wrong-place"):
        wrong = float(np.mean([is_wrong(t) for t in of(find(name))]))
        yield Line(
            f"a hint, {name.replace('-', ' ')}, 0.8 stated: `wrong`", "no more than without",
            f"{100 * wrong:.1f} % (without {100 * plain:.1f} %)", wrong <= plain, EVENTS,
        )  # fmt: skip


def _percent(found: object) -> str:
    value, low, high = (100 * getattr(found, name) for name in ("value", "low", "high"))
    return f"{value:.1f} % [{low:.1f}, {high:.1f}]"
