"""Weights: multiplied, summed up, drawn by."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def weighed(weight, factor, out):
    """Fill out (N,) with the products of weights and factors (N,); return their sum."""
    total = 0.0
    for i in range(weight.shape[0]):
        out[i] = weight[i] * factor[i]
        total += out[i]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def moments(weight):
    """Sum of the weights (N,), and of their squares."""
    total, squares = 0.0, 0.0
    for i in range(weight.shape[0]):
        total += weight[i]
        squares += weight[i] * weight[i]
    return total, squares


@njit(cache=True, nogil=True, error_model="numpy")
def by_label(label, weight):
    """Sum of the weights (N,) of each label (N,), from label 0 to the highest."""
    highest = 0
    for i in range(label.shape[0]):
        highest = max(highest, label[i])
    sums = np.zeros(highest + 1)
    last, run = 0, 0.0  # labels come in runs: a run's sum need not go through memory
    for i in range(label.shape[0]):
        if label[i] != last:
            sums[last] = run
            last = label[i]
            run = sums[last]
        run += weight[i]
    sums[last] = run
    return sums


@njit(cache=True, nogil=True, error_model="numpy")
def systematic(weights, n, u, out):
    """Fill out (n,) with indices drawn by systematic resampling at offset u in [0, 1)."""
    total = 0.0
    for i in range(weights.shape[0]):
        total += weights[i]
    j = 0
    reached = weights[0]
    last = weights.shape[0] - 1
    for k in range(n):
        wanted = (k + u) * total / n
        while reached <= wanted and j < last:
            j += 1
            reached += weights[j]
        out[k] = j
