"""Recorder: watches a walk and keeps what pictures need."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from palms.belief import Belief, Estimate, Stage
from palms.particles import MoveInfo, Particles
from palms.plot.style import GROUPS, groups_of

__all__ = ["MOMENTS", "Recorder", "Snapshot", "by_weight"]

MOMENTS: Final = ("start", "t1", "t2", "end")


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The particles at one moment of a walk.

    Parameters
    ----------
    estimate : Estimate
        The answer then.
    position_m : (N, 2) float32
        Of some of the particles, chosen in proportion to their weights.
    group : (N,) int8
        In which style each is drawn: 0 to 3, see `palms.plot.style.groups_of`; 4 when
        there are no labels to tell them apart.

    Examples
    --------
    >>> snapshot = Snapshot(Estimate(2.5), np.zeros((3, 2), np.float32), np.zeros(3, np.int8))
    >>> snapshot.time_s
    2.5
    """

    estimate: Estimate
    position_m: npt.NDArray[np.float32]
    group: npt.NDArray[np.int8]

    @property
    def time_s(self) -> float:
        """When it was, on the walk's clock."""
        return self.estimate.time_s


class Recorder:
    """Keeps copies of the particles while a walk is tracked: pass it as `watch`.

    Parameters
    ----------
    every : int
        Steps between two of the `frames`, at least 1.
    n_particles : int
        Most particles that a snapshot keeps.

    Attributes
    ----------
    frames : list of Snapshot
        Every `every`-th step, from the first one on.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, Scan, track
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> recorder = Recorder(every=2)
    >>> walk = Odometry([1, 2, 3], [[0.5, 0], [1, 0], [1.5, 0]])
    >>> answers = track(FloorPlan(room), Scan(room - (2.0, 1.0)), walk, watch=recorder)
    >>> [frame.time_s for frame in recorder.frames], recorder.moment("end").time_s
    ([1.0, 3.0], 3.0)
    """

    def __init__(self, every: int = 1, n_particles: int = 2000) -> None:
        self.every = max(1, every)
        self.n_particles = max(1, n_particles)
        self.frames: list[Snapshot] = []
        self._by_label, self._any_drift = True, False
        self._step = 0
        self._kept: dict[str, Snapshot] = {}
        self._last: tuple[Estimate, Particles] | None = None

    def __call__(self, estimate: Estimate, belief: Belief, info: MoveInfo) -> None:
        """Take what happened in one move; nothing is changed."""
        particles = belief.particles
        if self._step == 0:
            self._by_label = int(particles.label.max()) < len(GROUPS)
            self._any_drift = (
                not particles.label.any() and float(np.ptp(particles.drift_rad)) > np.pi
            )
        begins = [name for name in MOMENTS[:3] if self._begins(name, estimate.stage)]
        is_frame = self._step % self.every == 0
        if begins or is_frame:
            snapshot = self._snapshot(estimate, particles)
            self._kept |= dict.fromkeys(begins, snapshot)
            if is_frame:
                self.frames.append(snapshot)
        self._last = estimate, particles
        self._step += 1

    def __len__(self) -> int:
        """Return the number of moves that were watched."""
        return self._step

    def moment(self, name: str) -> Snapshot | None:
        """Return the snapshot of a moment of the paper's Fig. 3; None when it never came.

        Parameters
        ----------
        name : {"start", "t1", "t2", "end"}
            After the first move, when first oriented, when first localized, after the last.
        """
        if name == "end":
            return None if self._last is None else self._snapshot(*self._last)
        return self._kept.get(name)

    def _begins(self, name: str, stage: Stage) -> bool:
        reached = {
            "start": True,
            "t1": stage in (Stage.ORIENTED, Stage.LOCALIZED),
            "t2": stage == Stage.LOCALIZED,
        }
        return name not in self._kept and reached[name]

    def _snapshot(self, estimate: Estimate, particles: Particles) -> Snapshot:
        chosen = by_weight(particles.weight, self.n_particles)
        group = groups_of(particles.label[chosen], particles.drift_rad[chosen], self._by_label)
        if self._any_drift:
            group[:] = len(GROUPS)
        return Snapshot(estimate, particles.position_m[chosen].astype(np.float32), group)


def by_weight(weight: npt.NDArray[np.float64], n: int) -> npt.NDArray[np.int64]:
    """Return indices of up to n particles, evenly spaced along the summed weights.

    Examples
    --------
    >>> by_weight(np.array([0.25, 0.25, 0.5, 0.0]), 2).tolist()
    [0, 2]
    """
    if len(weight) <= n and np.ptp(weight) == 0:
        return np.arange(len(weight))
    n = min(n, len(weight))
    total = np.cumsum(weight)
    at = (np.arange(n) + 0.5) / n * total[-1]
    return np.asarray(np.minimum(np.searchsorted(total, at), len(weight) - 1))
