"""The largest of very many scores."""

from __future__ import annotations

import numpy as np
from numba import njit

BINS = 4096


FEW = 2048  # so many are sorted; more are divided into bins again


@njit(cache=True, nogil=True)
def _sorted_at(values, index):
    """Shell sort in place and return one value; numpy's sort takes numba seconds to compile."""
    n = values.shape[0]
    gap = n // 2
    while gap > 0:
        for k in range(gap, n):
            v, j = values[k], k
            while j >= gap and values[j - gap] > v:
                values[j] = values[j - gap]
                j -= gap
            values[j] = v
        gap //= 2
    return values[index]


@njit(cache=True, nogil=True)
def nth_largest(values, n):
    """Return the n-th largest (n from 1) of float32 values (N,), exact and safe with ties.

    Histogram of all, then of the bin that holds the rank, until that bin holds one value or
    few; three passes as a rule.
    """
    low, high = np.inf, -np.inf
    for v in values:
        low = min(low, float(v))
        high = max(high, float(v))
    rank = n
    while True:
        if high <= low:
            return np.float32(low)
        counts = np.zeros(BINS, np.int64)
        factor = (BINS - 1) / (high - low)
        for v in values:
            if low <= v <= high:
                counts[int((v - low) * factor)] += 1
        b = BINS - 1
        while counts[b] < rank:
            rank -= counts[b]
            b -= 1
        new_low, new_high = np.inf, -np.inf
        kept = np.empty(counts[b], np.float32)
        m = 0
        for v in values:
            if low <= v <= high and int((v - low) * factor) == b:
                kept[m] = v
                m += 1
                new_low = min(new_low, float(v))
                new_high = max(new_high, float(v))
        if new_low == new_high:
            return np.float32(new_low)
        if m <= FEW:
            return _sorted_at(kept, m - rank)
        low, high = new_low, new_high


@njit(cache=True, nogil=True)
def at_least(scores, threshold):
    """Flat indices of the scores (R, C) at or above a threshold, in order."""
    flat = scores.ravel()
    n = 0
    for v in flat:
        n += v >= threshold
    out = np.empty(n, np.int64)
    m = 0
    for i in range(flat.shape[0]):
        if flat[i] >= threshold:
            out[m] = i
            m += 1
    return out


@njit(cache=True, nogil=True)
def peak(scores, inside):
    """Largest of the scores (R, C) where a mask is set; -inf where none is."""
    flat, where = scores.ravel(), inside.ravel()
    high = np.float32(-np.inf)
    for i in range(flat.shape[0]):
        if flat[i] > high and where[i]:
            high = flat[i]
    return high


@njit(cache=True, nogil=True)
def at_least_inside(scores, inside, threshold):
    """Flat indices of the scores (R, C) at or above a threshold where a mask is set, in order."""
    flat, where = scores.ravel(), inside.ravel()
    n = 0
    for i in range(flat.shape[0]):
        n += flat[i] >= threshold and where[i]
    out = np.empty(n, np.int64)
    m = 0
    for i in range(flat.shape[0]):
        if flat[i] >= threshold and where[i]:
            out[m] = i
            m += 1
    return out
