"""Story: one walk, all that is known about it, for those who draw or tell it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from palms.building import Atlas
from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, as_readonly
from palms.heatmap import Candidates, Heatmaps, ScoreMaps, match, scan_drifts
from palms.localizer import Track
from palms.observation import likelihoods
from palms.odometry import Odometry
from palms.plot.recorder import Recorder, Snapshot
from palms.posterior import Posterior
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import Settings

__all__ = ["Story", "broken", "check_truth", "errors_m"]

_LEAP_M = 20.0  # ours: nobody walks so far in one step; the sheets of an atlas lie farther apart


@dataclass(frozen=True)
class Story:
    """One tracked walk and what led to it.

    Parameters
    ----------
    raster : PlanRaster
    odometry : Odometry
    track : Track
    recorder : Recorder
        The one that watched the track being made.
    scan : Scan, optional
    candidates : Candidates or Posterior, optional
        What the scan alone said.
    truth_m : array_like (T, 2), optional
        True positions at the odometry's times, map frame; NaN where unknown.
    scan_truth_m : array_like (2,), optional
        True place of the scan; the first of `truth_m` when left out.
    settings : Settings
    atlas : Atlas, optional
        Of a building of several levels: raster, track, recorder, candidates and truth then
        lie on it.

    Raises
    ------
    InputError
        When the truth is not as long as the walk.

    Examples
    --------
    >>> from palms import rasterize, track
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> raster, scan = rasterize(FloorPlan(room)), Scan(room - (2.0, 1.0))
    >>> walk, recorder = Odometry([1, 2], [[0.5, 0], [1, 0]]), Recorder()
    >>> answers = track(raster, scan, walk, watch=recorder)
    >>> story = Story(raster, walk, answers, recorder, scan, truth_m=[[2.5, 1.0], [3.0, 1.0]])
    >>> story.scan_place_m.tolist(), len(story.error_m)
    ([2.5, 1.0], 2)
    """

    raster: PlanRaster
    odometry: Odometry
    track: Track
    recorder: Recorder
    scan: Scan | None = None
    candidates: Candidates | Posterior | None = None
    truth_m: FloatArray | None = None
    scan_truth_m: FloatArray | None = None
    settings: Settings = field(default_factory=Settings)
    atlas: Atlas | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "truth_m", check_truth(self.truth_m, len(self.track)))
        if self.scan_truth_m is not None:
            object.__setattr__(self, "scan_truth_m", as_readonly(self.scan_truth_m))

    @property
    def plan(self) -> FloorPlan:
        """The floor plan."""
        return self.raster.plan

    @property
    def scan_place_m(self) -> FloatArray | None:
        """True place (2,) of the scan, as far as it is known."""
        if self.scan_truth_m is not None or self.truth_m is None:
            return self.scan_truth_m
        first: FloatArray = self.truth_m[0]
        return first if np.isfinite(first).all() else None

    @cached_property
    def heatmaps(self) -> Heatmaps | None:
        """The paper's heatmaps of the scan, four drifts; None without scan or candidates."""
        if self.scan is None or self.candidates is None:
            return None
        drifts_rad = scan_drifts(self.scan, self.raster, self.settings)
        return match(self.scan, self.raster, drifts_rad, self.settings.template)

    @property
    def maps(self) -> ScoreMaps | None:
        """The maps that the candidates come from; None without scan or candidates."""
        if self.scan is None or self.candidates is None:
            return None
        if self.settings.start.source == "posterior":
            return likelihoods(self.scan, self.raster, self.settings.observation)
        return self.heatmaps

    @cached_property
    def error_m(self) -> FloatArray | None:
        """Distance (T,) from answer to truth, infinite on another level; None without a truth."""
        if self.truth_m is None:
            return None
        error = errors_m(self.track, self.truth_m)
        if self.atlas is not None:
            known = ~np.isnan(error)
            answer, truth = self.track.position_m[known], self.truth_m[known]
            error[known] += np.where(
                self.atlas.level_of(answer) == self.atlas.level_of(truth), 0.0, np.inf
            )
        return error

    @property
    def t1_is_t2(self) -> bool:
        """Whether oriented and localized came together, or neither."""
        return self.track.oriented_at_s == self.track.localized_at_s

    def snapshot(self, moment: str) -> Snapshot | None:
        """Return the particles at a moment; None when it never came.

        Parameters
        ----------
        moment : {"start", "half", "t1", "t2", "end"}
            As `Recorder.moment`; "half" of the way to t2, or of the walk without one.
        """
        frames = self.recorder.frames
        if moment != "half" or not frames:
            return self.recorder.moment(moment)
        until = self.track.localized_at_s or frames[-1].time_s
        half = (frames[0].time_s + until) / 2
        return min(frames, key=lambda frame: abs(frame.time_s - half))

    def step_at(self, time_s: float) -> int:
        """Index of the odometry's sample at a time, the last one not later."""
        return max(0, int(np.searchsorted(self.odometry.time_s, time_s, side="right")) - 1)


def check_truth(truth_m: npt.ArrayLike | None, n: int) -> FloatArray | None:
    """Return true positions as a read-only (n, 2) array, or say what is wrong.

    Examples
    --------
    >>> check_truth([[1.0, 2.0]], 2)
    Traceback (most recent call last):
    palms.errors.InputError: truth: expected 2 positions (x, y), one for each answer, got (1, 2)
    """
    if truth_m is None:
        return None
    truth = as_readonly(truth_m)
    if truth.shape != (n, 2):
        raise InputError(
            "truth",
            expected=f"{n} positions (x, y), one for each answer",
            got=str(truth.shape),
        )
    return truth


def errors_m(track: Track, truth_m: FloatArray) -> FloatArray:
    """Distance (T,) in metres from each answer to the truth; NaN where either is missing."""
    return np.asarray(np.linalg.norm(track.position_m - truth_m, axis=1))


def broken(path_m: FloatArray) -> FloatArray:
    """Return a path (N, 2) with a gap (NaN) where it goes on in another place: another level.

    Examples
    --------
    >>> broken(np.array([[0.0, 0.0], [1.0, 0.0], [90.0, 0.0]]))[:, 0].tolist()
    [0.0, 1.0, nan, 90.0]
    """
    leaps = np.flatnonzero(np.linalg.norm(np.diff(path_m, axis=0), axis=1) > _LEAP_M)
    return np.insert(path_m, leaps + 1, np.nan, axis=0)
