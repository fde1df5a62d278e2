"""RecordedWalk: a walk as recorded, with what is known of the truth."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly, check_finite
from palms.io.truth import TRUTH_FILE, Truth
from palms.odometry import Odometry

__all__ = ["RecordedWalk", "WalkSource"]

WalkSource = Literal["arkit", "ronin"]

_SAME_TIME_S = 1e-3  # ours: how far the truth's clock may be from the walk's


@dataclass(frozen=True, slots=True)
class RecordedWalk:
    """A walk as recorded: odometry by one or two sources, and what is known of the truth.

    Parameters
    ----------
    arkit, ronin : Odometry, optional
        Visual-inertial odometry in the scan's frame, inertial odometry in its own; at
        least one of them, with the same times.
    reference_m : array_like (T, 2), optional
        Reference positions, map frame; NaN where there is none. None: nowhere.
    start_m : array_like (2,), optional
        Where the walk began, map frame.
    ahead_m : array_like (2,), optional
        A second map point, ahead of the start.
    session : tuple of str
        Names under which the walk goes as a session.
    building_id : str, optional
        The building, as the file has it.
    truth : Truth, optional
        The truth for every sample, when it is known.
    path : Path, optional
        The file that it came from.

    Raises
    ------
    InputError
        When there is no odometry, or lengths or times differ.

    Examples
    --------
    >>> walk = RecordedWalk(arkit=Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]]))
    >>> len(walk), walk.sources
    (2, ('arkit',))
    """

    arkit: Odometry | None = None
    ronin: Odometry | None = None
    reference_m: FloatArray = None  # type: ignore[assignment]
    start_m: FloatArray | None = None
    ahead_m: FloatArray | None = None
    session: tuple[str, ...] = ()
    building_id: str | None = None
    truth: Truth | None = None
    path: Path | None = None

    def __post_init__(self) -> None:
        known = [odometry for odometry in (self.arkit, self.ronin) if odometry is not None]
        if not known:
            raise InputError("walk", expected="ARKit or RoNIN odometry", got="neither")
        if len(known) == 2 and not np.array_equal(known[0].time_s, known[1].time_s):
            raise InputError("walk", expected="the same times in both odometries", got="others")
        reference = np.full((len(self), 2), np.nan)
        if self.reference_m is not None:
            reference = np.asarray(self.reference_m, dtype=np.float64)
        _check_reference(reference, self.time_s, self.truth)
        object.__setattr__(self, "reference_m", as_readonly(reference))
        object.__setattr__(self, "session", tuple(self.session))
        for name in ("start_m", "ahead_m"):
            if getattr(self, name) is not None:
                point = check_finite(getattr(self, name), f"the walk's {name}", (2,))
                object.__setattr__(self, name, point)

    @classmethod
    def of(cls, odometry: Odometry, path: Path | None = None) -> RecordedWalk:
        """Return the walk of an odometry alone, without a reference.

        Examples
        --------
        >>> RecordedWalk.of(Odometry([1, 2], [[1, 0], [2, 0]], source="inertial")).sources
        ('ronin',)
        """
        if odometry.source == "inertial":
            return cls(ronin=odometry, session=odometry.session, path=path)
        return cls(arkit=odometry, session=odometry.session, path=path)

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def time_s(self) -> FloatArray:
        """End of each move (T,)."""
        known = self.ronin if self.arkit is None else self.arkit
        return np.empty(0) if known is None else known.time_s

    @property
    def sources(self) -> tuple[WalkSource, ...]:
        """Which odometries there are."""
        names: tuple[WalkSource, ...] = ("arkit", "ronin")
        return tuple(name for name in names if getattr(self, name) is not None)

    @property
    def usual_source(self) -> WalkSource:
        """The odometry to follow when nobody says which: arkit, else the one that there is.

        Examples
        --------
        >>> RecordedWalk.of(Odometry([1, 2], [[1, 0], [2, 0]], source="inertial")).usual_source
        'ronin'
        """
        return self.sources[0]

    @property
    def has_reference(self) -> npt.NDArray[np.bool_]:
        """Which samples (T,) have a reference."""
        return np.asarray(np.isfinite(self.reference_m).all(axis=1))

    def odometry(self, source: WalkSource = "arkit") -> Odometry:
        """Return the odometry of one source.

        Raises
        ------
        InputError
            When the walk has none of that source.

        Examples
        --------
        >>> walk = RecordedWalk(arkit=Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]]))
        >>> walk.odometry("ronin")
        Traceback (most recent call last):
        palms.errors.InputError: odometry of the walk: expected one of arkit, got 'ronin'; choose...
        """
        found: Odometry | None = getattr(self, source) if source in self.sources else None
        if found is None:
            raise InputError(
                f"odometry of {self.path or 'the walk'}",
                expected=f"one of {', '.join(self.sources)}",
                got=repr(source),
                fix="choose a source that it has, with --walk-source",
            )
        return found


def _check_reference(reference: FloatArray, time_s: FloatArray, truth: Truth | None) -> None:
    samples = len(time_s)
    if truth is not None and len(truth) != samples:
        raise InputError(
            "the walk's truth", expected=f"{samples} rows, one for each sample",
            got=str(len(truth)), fix=f"remove the {TRUTH_FILE} of another walk",
        )  # fmt: skip
    if truth is not None and np.abs(truth.time_s - time_s).max() > _SAME_TIME_S:
        at = int(np.abs(truth.time_s - time_s).argmax())
        raise InputError(
            "the walk's truth", expected=f"{time_s[at]:.6g} s at sample {at}",
            got=f"{truth.time_s[at]:.6g} s", fix=f"remove the {TRUTH_FILE} of another walk",
        )  # fmt: skip
    if reference.shape != (samples, 2) or np.isinf(reference).any():
        raise InputError(
            "the walk's reference",
            expected=f"positions or NaN of shape ({samples}, 2)",
            got=f"shape {reference.shape}",
        )
