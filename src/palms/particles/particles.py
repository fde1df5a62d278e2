"""Particles: what the phone's pose may be."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms._compiled import clusters
from palms._compiled import filter as loops
from palms._compiled import weights as by_weight
from palms.errors import InputError
from palms.geometry import FloatArray, wrap_angle

__all__ = ["Particles"]

_FIELDS = (
    ("position_m", np.float64), ("drift_rad", np.float64), ("scale", np.float64),
    ("label", np.int32), ("weight", np.float64), ("drift_rate_rad_per_s", np.float64),
    ("leg_scale", np.float64), ("hint_nats", np.float64),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Particles:
    """What the phone's pose may be: many guesses, each with a weight.

    Parameters
    ----------
    position_m : (N, 2)
        In the map frame.
    drift_rad : (N,)
        Angle from odom vectors to map vectors; not wrapped, so that it stays continuous.
    scale : (N,)
        Metres walked per metre of odometry.
    label : (N,) int32
        The candidate drift a particle came from.
    weight : (N,)
        Sum 1.
    drift_rate_rad_per_s : (N,), optional
        Steady turn of the walk's frame; None where it does not turn.
    leg_scale : (N,), optional
        By so much is the scale of the leg that is walked now larger than the walk's; None
        where all legs have one scale.
    hint_nats : (N,), optional
        What hints say for each of them and has not faded yet; None where nobody said anything.

    Examples
    --------
    >>> two = Particles([[0, 0], [1, 0]], [0, 0], [1, 1], [0, 1], [0.5, 0.5])
    >>> two.mean_m().tolist()
    [0.5, 0.0]
    """

    position_m: FloatArray
    drift_rad: FloatArray
    scale: FloatArray
    label: npt.NDArray[np.int32]
    weight: FloatArray
    drift_rate_rad_per_s: FloatArray | None = None
    leg_scale: FloatArray | None = None
    hint_nats: FloatArray | None = None

    def __post_init__(self) -> None:
        for name, dtype in _FIELDS:
            given = getattr(self, name)
            if given is None:
                continue
            array = np.ascontiguousarray(given, dtype)
            array.setflags(write=False)
            if array is not given:
                object.__setattr__(self, name, array)
        n = len(self.weight)
        if n == 0 or self.position_m.shape != (n, 2) or len(self.drift_rad) != n:
            raise InputError("particles", expected="as many of each, at least 1", got=str(n))

    def __len__(self) -> int:
        return len(self.weight)

    def mean_m(self, members: npt.NDArray[np.bool_] | None = None) -> FloatArray:
        """Weighted mean position (2,) of all particles or of some of them."""
        return self.mean_pose(members)[0]

    def mean_pose(self, members: npt.NDArray[np.bool_] | None = None) -> tuple[FloatArray, float]:
        """Weighted mean position (2,), and drift in (-pi, pi], of all or of some of them."""
        if members is None:
            return self.mean_poses(np.zeros(len(self), np.int8), 1)[0]
        return self.mean_poses(members.astype(np.int8) - 1, 1)[0]

    def mean_poses(self, place: npt.NDArray[np.int8], n: int) -> list[tuple[FloatArray, float]]:
        """Mean pose of the particles of each of n places; NaN where there are none.

        Parameters
        ----------
        place : (N,) int8
            The place that each particle belongs to, or -1.
        n : int
        """
        sums = self._sums(place, n)
        with np.errstate(invalid="ignore"):
            mean = sums[:, 1:3] / sums[:, :1]
        drift = np.arctan2(sums[:, 4], sums[:, 3]).tolist()
        return [(mean[k], wrap_angle(drift[k])) for k in range(n)]

    def drift_agreement(self) -> float:
        """Length of the mean of all drifts as unit vectors: 1 where they agree, 0 all around."""
        ((weight, _, _, east, north),) = self._sums(np.zeros(len(self), np.int8), 1)
        return math.hypot(east, north) / float(weight)

    def _sums(self, place: npt.NDArray[np.int8], n: int) -> FloatArray:
        """Return sums (n, 5) for n places: weight; x, y, the drift's cosine and sine by weight."""
        sums = np.empty((n, 5))
        loops.gathered(self.position_m, self.drift_rad, self.weight, place, sums)
        return sums

    def dispersion_m(self, mean_m: FloatArray | None = None) -> float:
        """Root of the summed variances of the positions; quicker where their mean is known."""
        x, y = self.mean_m() if mean_m is None else mean_m
        return math.sqrt(clusters.variance(self.position_m, self.weight, x, y))

    def take(self, index: npt.NDArray[np.int64], weight: FloatArray) -> Particles:
        """Return some of them, by index (M,), with new weights (M,)."""
        may_be = (self.drift_rate_rad_per_s, self.leg_scale, self.hint_nats)
        return Particles(
            self.position_m[index], self.drift_rad[index], self.scale[index], self.label[index],
            weight, *(None if each is None else each[index] for each in may_be),
        )  # fmt: skip

    def turned_rad(self, duration_s: float) -> FloatArray:
        """Drifts (N,) after some time, by the steady turn alone."""
        if self.drift_rate_rad_per_s is None:
            return self.drift_rad
        turned: FloatArray = self.drift_rad + duration_s * self.drift_rate_rad_per_s
        turned.setflags(write=False)  # one kind of array for the loop that takes it
        return turned

    @property
    def scale_now(self) -> FloatArray:
        """Metres walked per metre of odometry (N,), on the leg that is walked now."""
        if self.leg_scale is None:
            return self.scale
        scale: FloatArray = self.scale + self.leg_scale
        scale.setflags(write=False)  # as in `turned_rad`
        return scale

    def label_shares(self) -> FloatArray:
        """Share of the weight that each label holds."""
        shares: FloatArray = by_weight.by_label(self.label, self.weight)
        return shares
