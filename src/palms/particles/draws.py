"""Particles are weighed, and drawn by their weight."""

from __future__ import annotations

import math
import sys
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from palms._compiled import weights as by_weight
from palms.geometry import FloatArray
from palms.particles.particles import Particles
from palms.randomness import RandomKey

__all__ = ["effective_sample_size", "resample_systematic", "reweight", "thin"]

_THIN = 5  # purpose of random numbers


def reweight(particles: Particles, factor: npt.ArrayLike) -> tuple[Particles, float]:
    """Multiply the weights by factors (N,); return the logarithm of what they kept, too.

    When nothing would be left the weights stay, and the logarithm is that of the smallest
    number: the evidence contradicts every particle.

    Examples
    --------
    >>> two = Particles([[0, 0], [1, 0]], [0, 0], [1, 1], [0, 1], [0.5, 0.5])
    >>> more, kept = reweight(two, [1.0, 0.5])
    >>> more.weight.round(3).tolist(), round(kept, 3)
    ([0.667, 0.333], -0.288)
    """
    weight = np.empty(len(particles))
    total = by_weight.weighed(
        particles.weight, np.ascontiguousarray(factor, dtype=np.float64), weight
    )
    if total <= sys.float_info.min:
        return particles, math.log(sys.float_info.min)
    return replace(particles, weight=weight / total), math.log(total)


def thin(particles: Particles, n: int, key: RandomKey) -> Particles:
    """Keep n particles, drawn by weight."""
    index = resample_systematic(particles.weight, n, key.child(_THIN))
    return particles.take(index, np.full(n, 1 / n))


def resample_systematic(weights: FloatArray, n: int, key: RandomKey) -> npt.NDArray[np.int64]:
    """Return n indices drawn in proportion to the weights, by systematic resampling.

    One random offset for all (Kitagawa 1996): each index comes out as often as its share of
    n says, rounded up or down.

    Examples
    --------
    >>> from palms.randomness import as_key
    >>> resample_systematic(np.array([0.5, 0.0, 0.5]), 4, as_key(0)).tolist()
    [0, 0, 2, 2]
    """
    out = np.empty(n, np.int64)
    by_weight.systematic(np.ascontiguousarray(weights), n, key.uniform(), out)
    return out


def effective_sample_size(weight: FloatArray) -> float:
    """Return 1 / sum of squared weights, the number of particles that count (Kong 1994).

    Examples
    --------
    >>> effective_sample_size(np.array([0.5, 0.5, 0.0]))
    2.0
    """
    total, squares = by_weight.moments(np.ascontiguousarray(weight))
    return float(total**2 / squares)
