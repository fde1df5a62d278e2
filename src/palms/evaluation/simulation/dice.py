"""Random choices that rest on ``rng.random()`` alone, so that buildings stay as they are.

The other methods of a numpy Generator may draw differently in another version of numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TypeVar

import numpy as np

__all__ = ["chance", "pick", "uniform", "weighted", "whole"]

T = TypeVar("T")


def uniform(rng: np.random.Generator, span: tuple[float, float]) -> float:
    """Return a number between two.

    Examples
    --------
    >>> 2.0 <= uniform(np.random.default_rng(0), (2.0, 3.0)) <= 3.0
    True
    """
    low, high = span
    return low + (high - low) * float(rng.random())


def whole(rng: np.random.Generator, span: tuple[int, int]) -> int:
    """Return a whole number between two, both included.

    Examples
    --------
    >>> whole(np.random.default_rng(0), (4, 4))
    4
    """
    low, high = span
    return low + min(int((high - low + 1) * float(rng.random())), high - low)


def chance(rng: np.random.Generator, share: float) -> bool:
    """Return True in this share of the cases.

    Examples
    --------
    >>> chance(np.random.default_rng(0), 1.0)
    True
    """
    return float(rng.random()) < share


def pick(rng: np.random.Generator, items: Sequence[T]) -> T:
    """Return one of the items.

    Examples
    --------
    >>> pick(np.random.default_rng(0), ["a", "a"])
    'a'
    """
    return items[whole(rng, (0, len(items) - 1))]


def weighted(rng: np.random.Generator, weights: Sequence[float]) -> int:
    """Return an index, each as often as its weight says.

    Examples
    --------
    >>> weighted(np.random.default_rng(0), [0.0, 1.0, 0.0])
    1
    """
    sums = list(accumulate(weights))
    mark = float(rng.random()) * sums[-1]
    return next(i for i, total in enumerate(sums) if mark < total)
