"""The tables, each with the commands that make it and what it was made on."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.simulated.studies import Study
from palms.evaluation.bootstrap import Interval, bootstrap_difference, bootstrap_interval
from palms.evaluation.sensitivity import Effect
from palms.evaluation.simulation import is_angled
from palms.evaluation.tables import (
    HEADLINE,
    PAPER,
    Rows,
    by_method,
    markdown_table,
    table_rows,
    units_of,
)

Results = dict[str, Any]


def paper_table(study: Study, results: Results) -> str:
    """Return the paper's experiment: methods by figures."""
    trials = results["trials"]
    return _joined(_commands(study), made_on(results), *_pair(trials))


def buildings_table(study: Study, results: Results) -> str:
    """Return all buildings, then the third with wings at other than right angles."""
    trials = results["trials"]
    angled = [t for t in trials if is_angled(int(t["scene"].rpartition("-")[2]))]
    parts = [_commands(study), made_on(results), "### All generated buildings", *_pair(trials)]
    if angled:
        few = f"{len({t['scene'] for t in angled})} of {len({t['scene'] for t in trials})}"
        parts += [f"### Those without right angles alone: {few}", *_pair(angled)]
    return _joined(*parts)


def doubling_table(study: Study, results: Results) -> str:
    """Return `useful` of the oracle by particles, and what doubling them changes."""
    each = len(results["trials"]) // len(study.runs)
    runs = [results["trials"][k * each : (k + 1) * each] for k in range(len(study.runs))]
    rows = [["particles", "useful", "change by doubling"]]
    for k, (run, trials) in enumerate(zip(study.runs, runs, strict=True)):
        value = bootstrap_interval([t["useful"] for t in trials], walks_of(trials))
        change = "" if k == 0 else signed(doubled_by(runs[k - 1], trials), 4)
        rows.append([f"{run.particles:,}", f"{value:.4f}", change])
    return _joined(
        _commands(study), made_on({**results, "trials": runs[0]}, "walks"), markdown_table(rows)
    )


def doubled_by(before: Rows, after: Rows) -> Interval:
    """Return how `useful` changes, with an interval over walks."""
    useful = [[t["useful"] for t in trials] for trials in (before, after)]
    return bootstrap_difference(*useful, walks_of(before), walks_of(after))


def nuisances_table(results: Results, effects: Sequence[Effect], picture: str) -> str:
    """Return the figures as they are, and what each doubled nuisance changes."""
    methods, figures = (list(dict.fromkeys(key)) for key in zip(
        *((e.method, e.figure) for e in effects), strict=True
    ))  # fmt: skip
    found = {(e.nuisance, e.method, e.figure): e for e in effects}
    columns = [(method, figure) for method in methods for figure in figures]
    first = effects[0].nuisance
    rows = [
        ["doubled", *(f"{method}: {figure}" for method, figure in columns)],
        ["nothing", *(f"{found[first, *column].before:.2f}" for column in columns)],
    ]
    for name in dict.fromkeys(e.nuisance for e in by_size(effects)):
        changes = (found[name, *column].change for column in columns)
        rows.append([f"`{name}`", *(signed(change, 2) for change in changes)])
    words = "The first row has the figures as they are, the others by how much they change:"
    return _joined(made_on(results), picture, words, markdown_table(rows))


def by_size(effects: Sequence[Effect]) -> list[Effect]:
    """Return the effects, the largest change of any figure first."""
    return sorted(effects, key=lambda e: -np.nan_to_num(abs(e.change.value)))


def signed(interval: Interval, digits: int) -> str:
    """Return a change with its sign and interval.

    Examples
    --------
    >>> signed(Interval(0.5, -0.25, 1.0, 4, 4), 2)
    '+0.50 [-0.25, +1.00]'
    """
    return f"{interval:+.{digits}f}"


def walks_of(trials: Rows) -> list[tuple[str, str]]:
    """Return the walk of each trial."""
    return [(t["scene"], t["walk"]) for t in trials]


def _commands(study: Study) -> str:
    return "\n".join(["```sh", *map(shlex.join, study.commands()), "```"])


def made_on(results: Results, units: str | None = None) -> str:
    trials = results["trials"]
    over = units or ("buildings" if len(units_of(trials)[0]) == 1 else "walks")
    each = {m: len(chosen) // len(set(walks_of(chosen))) for m, chosen in by_method(trials).items()}
    usual = max(each.values())
    apart = [f"{n} of {method}" for method, n in each.items() if n != usual]
    counted = " but ".join([f"{usual} trial{'s' * (usual > 1)} of each method", *apart])
    versions = {k: v for k, v in results["versions"].items() if k != "palms-localization"}
    return (
        f"{_walks(trials)}, {counted}; intervals over {over}; seed {results['experiment']['seed']};"
        f" {results['machine']['Processor']}; "
        + ", ".join(f"{name} {value}" for name, value in versions.items())
        + "."
    )


def _walks(trials: Rows) -> str:
    scenes, walks = {t["scene"] for t in trials}, set(walks_of(trials))
    if len(walks) == len(scenes):
        return f"{len(scenes)} buildings, one walk each" if len(scenes) > 1 else "One walk"
    return f"{len(walks)} walks in {len(scenes)} building{'s' * (len(scenes) > 1)}"


def _pair(trials: Rows) -> list[str]:
    return [
        markdown_table(table_rows(trials, HEADLINE)),
        "The paper's columns:",
        markdown_table(table_rows(trials, PAPER)),
    ]


def _joined(*parts: str) -> str:
    return "\n\n".join(parts)
