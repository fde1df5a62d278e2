"""A walk of a data set, read: what methods are told of it, and how their answers are judged."""

from __future__ import annotations

import pickle
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from palms.building import Building
from palms.errors import FormatError, InputError
from palms.evaluation.answers import Answers
from palms.evaluation.oracle import ORACLE
from palms.evaluation.simulation.output import NUISANCES_FILE, read_nuisances
from palms.evaluation.simulation.settings import InertialNoise, VioNoise
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.io import Case, RecordedWalk
from palms.levels import on_atlas
from palms.localizer import Happening, Track, locate, track_trials
from palms.odometry import Odometry
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import Settings

__all__ = ["Subject", "noise_of", "reference_of"]


@dataclass(frozen=True, slots=True)
class Subject:
    """One walk of a data set, read: what a worker needs and no file more.

    Parameters
    ----------
    scene, walk : str
    plan : FloorPlan
        The lowest, where there are several.
    scan : Scan
        The first.
    odometry : Odometry
    reference_m : (T, 2)
        Where the phone was; NaN where nobody knows. In a building of several levels on its
        atlas.
    noise : VioNoise or InertialNoise, optional
        What the odometry's errors were drawn with, where somebody knows: for the oracle alone.
    building : Building, optional
        Where there are several levels.
    told : tuple of Happening
        All scans and hints with their times, where there is more than one scan: for our
        methods alone.
    reference_level : tuple of str, optional
        Name of the level that the phone was on, for each sample, where there are several.
    """

    scene: str
    walk: str
    plan: FloorPlan
    scan: Scan
    odometry: Odometry
    reference_m: FloatArray
    noise: VioNoise | InertialNoise | None = None
    building: Building | None = None
    told: tuple[Happening, ...] = ()
    reference_level: tuple[str, ...] | None = None

    @classmethod
    def of(cls, case: Case, source: str = "arkit", with_noise: bool = False) -> Subject:
        """Read the files of a case.

        Raises
        ------
        InputError
            When a file is not what it should be, the walk has no reference, or its noise is
            asked for and not there.
        """
        walk = case.walk()
        reference = reference_of(case, walk)
        odometry = walk.odometry("ronin" if source == "ronin" else "arkit")
        noise = noise_of(case, source) if with_noise else None
        building = _as_one(case.building())
        told = case.happenings(odometry, building)
        subject = cls(
            case.scene, case.name, building.levels[0], case.scan(), odometry, reference, noise,
            told=told if len(told) > 1 else (),
        )  # fmt: skip
        return subject if len(building.levels) == 1 else _in_building(subject, building, case, walk)

    def raster(self, settings: Settings) -> PlanRaster:
        """Return the cells that answers are judged on: those of all levels."""
        return self._building.atlas.raster(settings.raster)

    @property
    def _building(self) -> Building:
        return self.building or _as_one(Building((self.plan,)))

    def tracks(self, settings: Settings, seeds: Sequence[int]) -> Iterator[Track]:
        """Yield the track of each seed; only our methods are told more than one scan and plan."""
        settings = replace(settings, answer=replace(settings.answer, hypotheses=0))
        told = _searched(_ByContent(self, pickle.dumps(self, protocol=5)), settings)
        yield from track_trials(self.known(settings), told, self.odometry, settings, seeds)

    def known(self, settings: Settings) -> Building:
        """Return the building as a method knows it: all levels, or the lowest alone."""
        return self._building if settings.is_ours else _as_one(Building((self.plan,)))

    @property
    def shown(self) -> FloorPlan:
        """What answers and reference are drawn on: the plan, or the building's atlas."""
        return self._building.atlas.plan

    def laid_out(self, track: Track) -> Track:
        """Return a track as it lies on what is shown.

        A method that knows the lowest level alone answers with that.
        """
        if self.building is None:
            return track
        lowest, atlas = self.building.names[0], self.building.atlas
        return replace(
            track,
            estimates=tuple(
                on_atlas(replace(each, level=each.level or lowest), atlas) for each in track
            ),
        )

    def answers(self, track: Track) -> Answers:
        """Return the answers of a track, as they lie on what is shown."""
        return Answers.of(self.laid_out(track))


def _in_building(subject: Subject, building: Building, case: Case, walk: RecordedWalk) -> Subject:
    """Return a subject whose reference lies on the atlas, with its level."""
    if walk.truth is None:
        raise InputError(
            str(case.folder), expected="truth.csv with the level of each sample",
            got="none", fix="add it, or remove the plans of other levels",
        )  # fmt: skip
    known = building.names
    other = sorted(set(walk.truth.level) - set(known))
    if other:
        raise InputError(
            f"{case.folder}: levels of truth.csv", expected=f"some of {', '.join(known)}",
            got=", ".join(map(repr, other)),
        )  # fmt: skip
    shift = building.atlas.shift_m[[known.index(name) for name in walk.truth.level]]
    return replace(
        subject, building=building, reference_m=subject.reference_m + shift,
        reference_level=walk.truth.level,
    )  # fmt: skip


def reference_of(case: Case, walk: RecordedWalk) -> FloatArray:
    """Return the reference positions of a walk.

    Raises
    ------
    InputError
        When there are none.
    """
    if walk.reference_m is None or np.isnan(walk.reference_m).any(axis=1).all():
        raise InputError(
            str(case.walk_path), expected="reference positions", got="none",
            fix="add truth.csv or ARKit_PF, or take the walk out of the data set",
        )  # fmt: skip
    return walk.reference_m


def noise_of(case: Case, source: str = "arkit") -> VioNoise | InertialNoise:
    """Return what the errors of an odometry of a case were drawn with.

    Raises
    ------
    InputError
        When nobody knows.
    """
    try:
        found = read_nuisances(case.folder)
    except FormatError:
        raise
    except InputError:
        raise InputError(
            f"method {ORACLE} on {case.title}", expected=f"its noise in {NUISANCES_FILE}",
            got="none", fix=f"leave {ORACLE} out, or make the data with: palms simulate",
        ) from None  # fmt: skip
    return found.inertial if source == "ronin" else found.vio


class _ByContent:
    """A value as a key: two of the same content are one."""

    def __init__(self, value: Any, content: Hashable) -> None:  # noqa: ANN401
        self.value = value
        self.content = content

    def __hash__(self) -> int:
        return hash(self.content)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByContent) and self.content == other.content


def _as_one(building: Building) -> Building:
    """Return a building that batches share, with the cells and transforms made of it."""
    levels = tuple(
        (
            plan.level,
            plan.segments_m.tobytes(),
            plan.classes.tobytes(),
            *((room.name, room.polygon_m.tobytes()) for room in plan.rooms),
        )
        for plan in building.levels
    )
    return _shared(_ByContent(building, levels))


@lru_cache(maxsize=2)
def _shared(building: _ByContent) -> Building:
    found: Building = building.value
    return found


@lru_cache(maxsize=2)
def _searched(subject: _ByContent, settings: Settings) -> tuple[Happening, ...]:
    """Return what a method is told of a walk; its scans are searched for once for all batches."""
    walk: Subject = subject.value
    told = (walk.told if settings.is_ours else ()) or (Happening(-np.inf, walk.scan),)
    if not settings.start.by_scan:
        return told
    where = walk.known(settings)
    return tuple(
        each._replace(found=locate(where, each.what, settings))
        if isinstance(each.what, Scan)
        else each
        for each in told
    )
