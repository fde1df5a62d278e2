"""The effect of each nuisance: one experiment as it is, others with one nuisance changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palms.errors import FormatError, InputError
from palms.evaluation.bootstrap import Interval, aggregate
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

    Examples
    --------
    >>> before, after = Interval(0.1, 0.0, 0.2, 4, 4), Interval(0.4, 0.3, 0.5, 4, 4)
    >>> Effect("furniture", "paper", "useful", before, after).change
    0.3
    """

    nuisance: str
    method: str
    figure: str
    before: Interval
    after: Interval

    @property
    def change(self) -> float:
        """How much the figure rises."""
        return self.after.value - self.before.value


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
    before = _figures(base)
    effects = [
        Effect(nuisance, method, figure, before[method][figure], figures[figure])
        for nuisance, trials in changed.items()
        for method, figures in _figures(trials).items() if method in before
        for figure in FIGURES
    ]  # fmt: skip
    order = {method: i for i, method in enumerate(before)}
    return sorted(effects, key=lambda e: (order[e.method], FIGURES.index(e.figure), -abs(e.change)))


def _figures(trials: Trials) -> dict[str, dict[str, Interval]]:
    return {
        method: aggregate(chosen, units_of(chosen), FIGURES)
        for method, chosen in by_method(trials).items()
    }


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
