"""The experiment: methods x scenes x walks x trials, on any data set.

Seeds come from (seed, scene, walk, trial), so a trial's numbers depend neither on the number
of workers nor on what ran before it. Finished trials are appended to a journal at once: a run
that was stopped goes on where it was.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import InputError, SettingsError
from palms.evaluation.metrics import sample_step, trial_metrics
from palms.evaluation.oracle import ORACLE, ORACLE_PARTICLES, oracle_settings, shared_settings
from palms.evaluation.provenance import machine, versions
from palms.evaluation.simulation.output import NUISANCES_FILE
from palms.evaluation.simulation.settings import InertialNoise, VioNoise
from palms.evaluation.subject import Subject, noise_of, reference_of
from palms.geometry import FloatArray
from palms.io import Case, open_dataset
from palms.io.plan_csv import rooms_path
from palms.io.truth import TRUTH_FILE
from palms.localizer import Track
from palms.settings import METHODS, Settings

__all__ = ["Batch", "Experiment", "Subject", "run_batch", "trial_seed"]

BATCH = 10  # ours: trials between two entries of the journal
SERIES_M = 2.0  # ours: spacing of the curves that the report draws
SAMPLE = 11  # ours: keys the random step of a trial, so that it shares no numbers with the filter

Record = dict[str, Any]


def trial_seed(seed: int, scene: str, walk: str, trial: int) -> int:
    """Return the seed of a trial; the same for every method.

    Examples
    --------
    >>> trial_seed(0, "E2", "w1", 0) == trial_seed(0, "E2", "w1", 0)
    True
    >>> trial_seed(0, "E2", "w1", 0) == trial_seed(0, "E2", "w1", 1)
    False
    """
    text = "\x1f".join([str(seed), scene, walk, str(trial)])
    digest = hashlib.blake2b(text.encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 11  # exact as a JSON number


@dataclass(frozen=True, slots=True)
class Batch:
    """Some trials of one method on one walk: the unit of work."""

    scene: str
    walk: str
    method: str
    trials: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Experiment:
    """What is to be run.

    Parameters
    ----------
    dataset : Path
    methods : sequence of str
        Named twice counts once.
    trials : int
        For each method and walk.
    seed : int
    particles : int, optional
        The methods' own numbers when left out.
    walk_source : {"arkit", "ronin"}
    only : sequence of str
        Patterns of walks, as ``scene`` or ``scene/walk`` with ``*`` and ``?``; all walks when
        left out.

    Raises
    ------
    InputError
        When there is no method.
    SettingsError
        When a method is unknown.

    Examples
    --------
    >>> Experiment(Path("data"), ("paper", "uniform"), trials=10).settings("paper").method
    'paper'
    """

    dataset: Path
    methods: tuple[str, ...]
    trials: int = 100
    seed: int = 0
    particles: int | None = None
    walk_source: str = "arkit"
    only: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "methods", tuple(dict.fromkeys(self.methods)))
        if not self.methods:
            raise InputError("methods", expected="at least one", got="none", fix="such as: paper")
        for name in self.methods:
            self.settings_json(name)  # an unknown method is said before the work

    @property
    def has_oracle(self) -> bool:
        """Whether the oracle takes part, which needs each walk's noise."""
        return ORACLE in self.methods

    def settings(self, method: str, noise: VioNoise | InertialNoise | None = None) -> Settings:
        """Return the settings of a method on a walk; only the oracle's depend on its noise."""
        if method == ORACLE:
            if noise is None:
                raise InputError(f"method {ORACLE}", expected="the noise of the walk", got="none")
            return oracle_settings(noise, self.particles or ORACLE_PARTICLES)
        if method not in METHODS:
            raise SettingsError(
                "method", expected="one of " + ", ".join((*METHODS, ORACLE)), got=repr(method)
            )
        settings = Settings.for_method(method)
        return settings if self.particles is None else settings.with_particles(self.particles)

    def settings_json(self, method: str) -> dict[str, Any]:
        """Return what results say of a method's settings; what a case decides is named so."""
        if method == ORACLE:
            found = shared_settings(self.particles or ORACLE_PARTICLES, self.walk_source)
        else:
            found = asdict(self.settings(method))
        said: dict[str, Any] = finite(found)
        return said

    def subject(self, case: Case) -> Subject:
        """Read the files of a case, with its noise when the oracle takes part."""
        return Subject.of(case, self.walk_source, self.has_oracle)

    def cases(self) -> tuple[Case, ...]:
        """Look up the walks, and whether each can be run: better now than after hours.

        Raises
        ------
        InputError
            When no walk is left, or one has no reference, no scan, not the odometry that is
            asked for, or no noise for the oracle to know.
        """
        found = open_dataset(self.dataset).cases
        cases = tuple(case for case in found if self._takes(case))
        if not cases:
            raise InputError(
                f"walks of {self.dataset}", expected=f"one called {' or '.join(self.only)}",
                got=", ".join(case.title for case in found[:3]) + (", ..." * (len(found) > 3)),
            )  # fmt: skip
        for case in cases:
            walk = case.walk()
            reference_of(case, walk)
            walk.odometry("ronin" if self.walk_source == "ronin" else "arkit")
            if not case.scan_paths:
                case.scan()  # says what is missing
            if case.above_paths or case.events_path.is_file():
                Subject.of(case, self.walk_source)  # says what is wrong with them
            if self.has_oracle:
                self.settings(ORACLE, noise_of(case, self.walk_source))
        return cases

    def _takes(self, case: Case) -> bool:
        names = (case.scene, case.title)
        return not self.only or any(fnmatchcase(n, each) for n in names for each in self.only)

    def batches(self, cases: Iterable[Case], done: set[tuple[Any, ...]]) -> list[Batch]:
        """Return what is still to be done, walk by walk."""
        todo = []
        for case in cases:
            for method in self.methods:
                left = [
                    t for t in range(self.trials) if (case.scene, case.name, method, t) not in done
                ]
                todo += [
                    Batch(case.scene, case.name, method, tuple(left[i : i + BATCH]))
                    for i in range(0, len(left), BATCH)
                ]
        return todo

    def to_json(self, cases: Sequence[Case]) -> dict[str, Any]:
        """Return what makes this experiment this one: its numbers and its data's content."""
        digest = hashlib.sha256()
        for case in cases:
            for file in _files(case, self.has_oracle):
                digest.update(file.name.encode() + file.read_bytes())
        return {
            "methods": list(self.methods), "trials": self.trials, "seed": self.seed,
            "particles": self.particles, "walk_source": self.walk_source,
            "walks": [case.title for case in cases], "data_sha256": digest.hexdigest(),
            "settings": {m: self.settings_json(m) for m in self.methods},
            "versions": versions(),
        }  # fmt: skip


def _files(case: Case, with_noise: bool) -> Iterator[Path]:
    """Yield the files that the numbers of a case rest on."""
    beside = [rooms_path(case.plan_path), case.folder / TRUTH_FILE]
    if with_noise:
        beside.append(case.folder / NUISANCES_FILE)
    for path in case.above_paths:
        beside += [path, rooms_path(path)]
    beside.append(case.events_path)
    for path in (case.plan_path, case.walk_path, *case.scan_paths, *beside):
        yield from sorted(path.iterdir()) if path.is_dir() else [path] if path.exists() else []


def run_batch(subject: Subject, batch: Batch, experiment: Experiment) -> list[Record]:
    """Run some trials; return a record for each, fit for JSON."""
    settings = experiment.settings(batch.method, subject.noise)
    seeds = [trial_seed(experiment.seed, batch.scene, batch.walk, t) for t in batch.trials]
    raster, moves = subject.raster(settings), subject.odometry.displacements_m
    reference = subject.reference_m, subject.reference_level
    records = []
    for trial, seed, track in zip(
        batch.trials, seeds, subject.tracks(settings, seeds), strict=True
    ):
        answers = subject.answers(track)
        metrics = trial_metrics(answers, reference[0], moves, raster, reference[1])
        rng = np.random.default_rng([seed, SAMPLE])
        stated = sample_step(answers, reference[0], rng, reference[1])
        head = {
            "scene": batch.scene, "walk": batch.walk, "method": batch.method, "trial": trial,
            "seed": seed,
        }  # fmt: skip
        sampled = {
            "sampled_p_within_1m": min(1.0, stated[0]) if stated else None,
            "sampled_within_1m": stated[1] if stated else None,
        }
        curves = series(track, answers.off_m(*reference), subject)
        records.append({**head, **metrics.to_json(), **sampled, "series": curves})
    return records


def series(track: Track, error_m: FloatArray, subject: Subject) -> dict[str, list[Any]]:
    """Return what curves need, about every two metres walked; steps without reference left out."""
    walked = subject.odometry.walked_m
    known = np.flatnonzero(~np.isnan(subject.reference_m).any(axis=1))
    marks = np.arange(0.0, walked[-1] + SERIES_M, SERIES_M)
    chosen = np.unique(known[np.minimum(np.searchsorted(walked[known], marks), len(known) - 1)])
    picked = [track.estimates[i] for i in chosen]
    return {
        "walked_m": _rounded(walked[chosen]),
        "error_m": _rounded(error_m[chosen]),
        "localized": [int(e.is_localized) for e in picked],
        "p1": _rounded([e.p_within_1m for e in picked], 4),
        "p2": _rounded([e.p_within_2m for e in picked], 4),
        "r68_m": _rounded([np.nan if e.radius_68_m is None else e.radius_68_m for e in picked]),
        "r95_m": _rounded([np.nan if e.radius_95_m is None else e.radius_95_m for e in picked]),
    }


def _rounded(values: Iterable[float], digits: int = 3) -> list[float | None]:
    return [round(v, digits) if math.isfinite(v) else None for v in map(float, values)]


def as_results(experiment: Experiment, records: Sequence[Record]) -> dict[str, Any]:
    """Return the content of results.json, schema palms-bench/1."""
    return {
        "schema": "palms-bench/1",
        "trials": [{k: v for k, v in r.items() if k != "series"} for r in records],
        "settings": {m: experiment.settings_json(m) for m in experiment.methods},
        "experiment": {
            "dataset": experiment.dataset.absolute().name,
            "methods": list(experiment.methods), "trials": experiment.trials,
            "seed": experiment.seed, "particles": experiment.particles,
            "walk_source": experiment.walk_source, "only": list(experiment.only),
        },
        "versions": versions(), "machine": machine(),
    }  # fmt: skip


def finite(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """Return a JSON value with infinities as words."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value
