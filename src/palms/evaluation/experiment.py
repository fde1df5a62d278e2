"""The experiment: methods x scenes x walks x trials, on any data set.

Seeds come from (seed, scene, walk, trial), so a trial's numbers depend neither on the number
of workers nor on what ran before it. Finished trials are appended to a journal at once: a run
that was stopped goes on where it was.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import InputError
from palms.evaluation.metrics import Answers, trial_metrics
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.io import Case, Dataset, open_dataset, read_json, write_json
from palms.localizer import Track, track_trials
from palms.odometry import Odometry
from palms.raster import rasterize
from palms.scan import Scan
from palms.settings import AnswerSettings, Settings

__all__ = ["Batch", "Experiment", "Journal", "Subject", "run_batch", "trial_seed"]

BATCH = 10  # ours: trials between two entries of the journal
SERIES_M = 2.0  # ours: spacing of the curves that the report draws

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
class Subject:
    """One walk of a data set, read: what a worker needs and no file more.

    Parameters
    ----------
    scene, walk : str
    plan : FloorPlan
    scan : Scan
    odometry : Odometry
    reference_m : (T, 2)
        Where the phone was; NaN where nobody knows.
    """

    scene: str
    walk: str
    plan: FloorPlan
    scan: Scan
    odometry: Odometry
    reference_m: FloatArray

    @classmethod
    def of(cls, case: Case, source: str = "arkit") -> Subject:
        """Read the files of a case.

        Raises
        ------
        InputError
            When a file is not what it should be, or the walk has no reference.
        """
        walk = case.walk()
        if walk.reference_m is None:
            raise InputError(
                str(case.walk_path), expected="reference positions", got="none",
                fix="add truth.csv or ARKit_PF, or take the walk out of the data set",
            )  # fmt: skip
        odometry = walk.odometry("ronin" if source == "ronin" else "arkit")
        return cls(case.scene, case.name, case.plan(), case.scan(), odometry, walk.reference_m)


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
    trials : int
        For each method and walk.
    seed : int
    particles : int, optional
        The methods' own numbers when left out.
    walk_source : {"arkit", "ronin"}
    """

    dataset: Path
    methods: tuple[str, ...]
    trials: int = 100
    seed: int = 0
    particles: int | None = None
    walk_source: str = "arkit"

    def settings(self, method: str) -> Settings:
        """Return the settings of a method."""
        settings = Settings.for_method(method)
        return settings if self.particles is None else settings.with_particles(self.particles)

    def opened(self) -> Dataset:
        """Look up the walks."""
        return open_dataset(self.dataset)

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
            for path in (case.plan_path, case.walk_path, *case.scan_paths):
                files = sorted(path.iterdir()) if path.is_dir() else [path]
                for file in files:
                    digest.update(file.name.encode() + file.read_bytes())
        return {
            "methods": list(self.methods), "trials": self.trials, "seed": self.seed,
            "particles": self.particles, "walk_source": self.walk_source,
            "walks": [case.title for case in cases], "data_sha256": digest.hexdigest(),
        }  # fmt: skip


def run_batch(subject: Subject, batch: Batch, experiment: Experiment) -> list[Record]:
    """Run some trials; return a record for each, fit for JSON."""
    from dataclasses import replace

    settings = replace(experiment.settings(batch.method), answer=AnswerSettings(hypotheses=0))
    raster = rasterize(subject.plan, settings.raster)
    seeds = [trial_seed(experiment.seed, batch.scene, batch.walk, t) for t in batch.trials]
    tracks = track_trials(raster, subject.scan, subject.odometry, settings, seeds)
    moves = subject.odometry.displacements_m
    records = []
    for trial, seed, track in zip(batch.trials, seeds, tracks, strict=True):
        metrics = trial_metrics(Answers.of(track), subject.reference_m, moves, raster)
        head = {
            "scene": batch.scene, "walk": batch.walk, "method": batch.method, "trial": trial,
            "seed": seed,
        }  # fmt: skip
        records.append({**head, **metrics.to_json(), "series": series(track, subject)})
    return records


def series(track: Track, subject: Subject) -> dict[str, list[Any]]:
    """Return what curves need, about every two metres walked; steps without reference left out."""
    walked = subject.odometry.walked_m
    known = np.flatnonzero(~np.isnan(subject.reference_m).any(axis=1))
    marks = np.arange(0.0, walked[-1] + SERIES_M, SERIES_M)
    chosen = np.unique(known[np.minimum(np.searchsorted(walked[known], marks), len(known) - 1)])
    error = np.linalg.norm(track.position_m - subject.reference_m, axis=1)
    picked = [track.estimates[i] for i in chosen]
    return {
        "walked_m": _rounded(walked[chosen]),
        "error_m": _rounded(error[chosen]),
        "localized": [int(e.is_localized) for e in picked],
        "p1": _rounded([e.p_within_1m for e in picked], 4),
        "p2": _rounded([e.p_within_2m for e in picked], 4),
        "r68_m": _rounded([np.nan if e.radius_68_m is None else e.radius_68_m for e in picked]),
        "r95_m": _rounded([np.nan if e.radius_95_m is None else e.radius_95_m for e in picked]),
    }


def _rounded(values: Iterable[float], digits: int = 3) -> list[float | None]:
    return [None if np.isnan(v) else round(float(v), digits) for v in values]


class Journal:
    """The finished trials of an experiment, on disk: one JSON object a line.

    Parameters
    ----------
    folder : Path
        Made when it is not there.
    identity : mapping
        What `Experiment.to_json` says; a folder of another experiment is refused.

    Raises
    ------
    InputError
        When the folder holds another experiment's results.
    """

    def __init__(self, folder: Path, identity: Mapping[str, Any]) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.path = folder / "trials.jsonl"
        known = folder / "experiment.json"
        if known.exists() and read_json(known) != json.loads(json.dumps(identity)):
            raise InputError(
                str(folder), expected="an empty folder or this experiment's",
                got="another experiment's results", fix="choose another --out or remove it",
            )  # fmt: skip
        if not known.exists():
            write_json(known, dict(identity))
        self.records = list(self._read())

    def _read(self) -> Iterator[Record]:
        """Read what was finished; a last line cut short by a kill is dropped from the file."""
        if not self.path.exists():
            return
        content = self.path.read_bytes()
        whole = content.rfind(b"\n") + 1
        if whole < len(content):
            with self.path.open("r+b") as file:
                file.truncate(whole)
        for line in content[:whole].splitlines():
            yield json.loads(line)

    @property
    def done(self) -> set[tuple[Any, ...]]:
        """(scene, walk, method, trial) of what is finished."""
        return {(r["scene"], r["walk"], r["method"], r["trial"]) for r in self.records}

    def append(self, records: Sequence[Record]) -> None:
        """Add finished trials, on disk before this returns."""
        import os

        text = "".join(json.dumps(r, allow_nan=False) + "\n" for r in records)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        self.records += records

    def ordered(self, experiment: Experiment) -> list[Record]:
        """Return all records in an order that no worker decides."""
        rank = {method: i for i, method in enumerate(experiment.methods)}
        return sorted(
            self.records, key=lambda r: (r["scene"], r["walk"], rank[r["method"]], r["trial"])
        )


def as_results(experiment: Experiment, records: Sequence[Record]) -> dict[str, Any]:
    """Return the content of results.json, schema palms-bench/1."""
    from importlib.metadata import version

    names = ("palms-localization", "numpy", "scipy", "numba")
    trials = [{k: v for k, v in r.items() if k != "series"} for r in records]
    return {
        "schema": "palms-bench/1",
        "trials": trials,
        "settings": {m: finite(asdict(experiment.settings(m))) for m in experiment.methods},
        "experiment": {
            "methods": list(experiment.methods), "trials": experiment.trials,
            "seed": experiment.seed, "particles": experiment.particles,
            "walk_source": experiment.walk_source,
        },
        "versions": {name: version(name) for name in names},
    }  # fmt: skip


def finite(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """Return a JSON value with infinities as words."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, float) and not np.isfinite(value):
        return str(value)
    return value
