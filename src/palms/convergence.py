"""Mean shift clusters (paper III-D)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms._compiled import clusters
from palms.geometry import FloatArray

__all__ = ["Cluster", "dominant_cluster", "estimated_bandwidth_m", "mean_shift"]

TOLERANCE = 1e-3  # ours: a search ends when it moves less than this share of the bandwidth
MAX_ITERATIONS = 300  # ours
NEIGHBOURS_SHARE = 0.3  # scikit-learn's default quantile, which the authors' code uses
BANDWIDTH_SAMPLE = 500  # ours: particles that the estimate looks at


class Cluster(NamedTuple):
    """The dominant cluster.

    Attributes
    ----------
    mode_m : (2,)
        Where its density peaks.
    member : (N,) bool
        Which points belong to it.
    share : float
        Of all points.
    """

    mode_m: FloatArray
    member: npt.NDArray[np.bool_]
    share: float


def mean_shift(
    points_m: FloatArray, bandwidth_m: float
) -> tuple[FloatArray, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Cluster points by mean shift with a flat kernel (paper III-D).

    Parameters
    ----------
    points_m : (N, 2)
        N at least 1.
    bandwidth_m : float
        Radius of the kernel.

    Returns
    -------
    modes_m : (M, 2)
        Densest first.
    member : (N,)
        Index of each point's mode, the nearest.
    counts : (M,)
        Points of each mode.

    References
    ----------
    Comaniciu and Meer, Mean shift: a robust approach toward feature space analysis, 2002.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [0.2, 0.0], [9.0, 9.0]])
    >>> mean_shift(points, 1.0)[2].tolist()
    [2, 1]
    """
    points = np.ascontiguousarray(points_m)
    modes, member, counts = clusters.mean_shift(
        points, bandwidth_m, TOLERANCE * bandwidth_m, MAX_ITERATIONS
    )
    return modes, member, counts


def dominant_cluster(points_m: FloatArray, bandwidth_m: float | None) -> Cluster:
    """Return the cluster with the most points (paper III-D).

    Parameters
    ----------
    points_m : (N, 2)
    bandwidth_m : float or None
        None: `estimated_bandwidth_m` of the points.
    """
    modes, member, counts = mean_shift(points_m, bandwidth_m or estimated_bandwidth_m(points_m))
    k = int(counts.argmax())
    return Cluster(modes[k], member == k, float(counts[k]) / len(points_m))


def estimated_bandwidth_m(points_m: FloatArray) -> float:
    """Return the mean distance to the farthest of the nearest 30 % of points.

    What scikit-learn's MeanShift takes by default, and so the authors' code; on spread
    clouds it can reach tens of metres.
    """
    from scipy.spatial import KDTree

    stride = -(-len(points_m) // BANDWIDTH_SAMPLE)
    sample = points_m[::stride]
    k = max(1, int(NEIGHBOURS_SHARE * len(points_m)))
    farthest = KDTree(points_m).query(sample, k=[k])[0]
    return max(float(farthest.mean()), 1e-3)
