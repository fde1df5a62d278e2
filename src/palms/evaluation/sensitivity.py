"""The effect of each nuisance: one experiment as it is, others with one nuisance changed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palms.errors import FormatError, InputError
from palms.evaluation.bootstrap import Interval, aggregate, bootstrap_difference
from palms.evaluation.tables import by_method, units_of
from palms.io import read_json

__all__ = ["FIGURES", "Effect", "Trials", "nuisance_effects", "read_trials"]

FIGURES = ("false_localized", "useful")  # issue "Measure": what the bars show

Trials = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Effect:
    """What one nuisance does to one figure of one method.

    Parameters
    ----------
    nuisance : str
    method : str
    figure : str
        One of `FIGURES`.
    before, after : Interval
        As it is, and with the nuisance changed.
    change : Interval
        How much the figure rises, over units that both have.

    Examples
    --------
    >>> before, after = Interval(0.1, 0.0, 0.2, 4, 4), Interval(0.4, 0.3, 0.5, 4, 4)
    >>> change = Interval(0.3, 0.25, 0.35, 8, 4)
    >>> f"{Effect('furniture', 'paper', 'useful', before, after, change).change:.2f}"
    '0.30 [0.25, 0.35]'
    """

    nuisance: str
    method: str
    figure: str
    before: Interval
    after: Interval
    change: Interval


def nuisance_effects(base: Trials, changed: Mapping[str, Trials]) -> list[Effect]:
    """Compare an experiment with others that have one nuisance changed each, such as doubled.

    Parameters
    ----------
    base : sequence of mapping
        Trials of the experiment as it is: scene, walk, method and metrics by name.
    changed : mapping of str to sequence of mapping
        For each nuisance the trials of the experiment with it changed. Methods that the base
        does not have are left out.

    Returns
    -------
    list of Effect
        By method and figure, the largest change first.

    Examples
    --------
    >>> nuisance_effects([], {})
    []
    """
    known = by_method(base)
    effects = [
        _effect((nuisance, method, figure), known[method], chosen)
        for nuisance, trials in changed.items()
        for method, chosen in by_method(trials).items() if method in known
        for figure in FIGURES
    ]  # fmt: skip
    order = {method: i for i, method in enumerate(known)}
    return sorted(
        effects, key=lambda e: (order[e.method], FIGURES.index(e.figure), -abs(_or_0(e.change)))
    )


def _effect(about: tuple[str, str, str], base: Trials, changed: Trials) -> Effect:
    figure = about[2]
    before, after = (
        aggregate(trials, units_of(trials), (figure,))[figure] for trials in (base, changed)
    )
    had, has = ([_number(t[figure]) for t in trials] for trials in (base, changed))
    change = bootstrap_difference(had, has, units_of(base), units_of(changed))
    return Effect(*about, before, after, change)


def _number(value: float | None) -> float:
    return math.nan if value is None else value


def _or_0(change: Interval) -> float:
    return 0.0 if math.isnan(change.value) else change.value


def read_trials(folder: Path) -> list[dict[str, Any]]:
    """Read the trials of the ``results.json`` in a folder of `palms bench`.

    Raises
    ------
    InputError
        When there is none, or it is not of the schema palms-bench/1.

    Examples
    --------
    >>> read_trials(Path("no/such/folder"))
    Traceback (most recent call last):
    palms.errors.InputError: no/such/folder: expected results.json of palms bench, got none; ...
    """
    path = folder / "results.json"
    if not path.is_file():
        raise InputError(
            str(folder), expected="results.json of palms bench", got="none",
            fix="run palms bench with this --out first",
        )  # fmt: skip
    content = read_json(path)
    if not isinstance(content, dict) or content.get("schema") != "palms-bench/1":
        raise FormatError(str(path), expected="schema palms-bench/1", got="something else")
    return list(content["trials"])
