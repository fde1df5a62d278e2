"""The finished trials of an experiment, on disk."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from palms.errors import InputError
from palms.evaluation.experiment import Experiment, Record
from palms.io import read_json, write_json
from palms.io.files import make_folder

__all__ = ["Journal"]


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
        self.folder = make_folder(folder)
        self.path = folder / "trials.jsonl"
        known = folder / "experiment.json"
        here = json.loads(json.dumps(identity))
        there = read_json(known) if known.exists() else None
        if there != here and (there is not None or self.path.exists()):
            raise InputError(
                str(folder), expected="an empty folder or this experiment's",
                got=f"another experiment's results{_differing(here, there)}",
                fix="choose another --out or remove it",
            )  # fmt: skip
        if there is None:
            write_json(known, here)
        self.records = list({_key(record): record for record in self._read()}.values())

    def _read(self) -> Iterator[Record]:
        """Read what was finished; a last line cut short by a kill is dropped from the file."""
        if not self.path.exists():
            return
        content = self.path.read_bytes()
        whole = content.rfind(b"\n") + 1
        if whole < len(content):
            with self.path.open("r+b") as file:
                file.truncate(whole)
        for number, line in enumerate(content[:whole].splitlines(), 1):
            try:
                record = json.loads(line)
                _key(record)
            except (ValueError, KeyError, TypeError):
                raise InputError(
                    f"{self.path} line {number}", expected="a finished trial as JSON",
                    got="something else", fix="remove the line; its trial is run again",
                ) from None  # fmt: skip
            yield record

    @property
    def done(self) -> set[tuple[Any, ...]]:
        """(scene, walk, method, trial) of what is finished."""
        return {_key(record) for record in self.records}

    def append(self, records: Sequence[Record]) -> None:
        """Add finished trials, on disk before this returns."""
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


def _key(record: Record) -> tuple[Any, ...]:
    return record["scene"], record["walk"], record["method"], record["trial"]


def _differing(here: Mapping[str, Any], there: object) -> str:
    """Say which numbers two experiments do not share, where that can be said."""
    if not isinstance(there, dict):
        return ""
    names = [name for name in here if there.get(name) != here[name]]
    return f" (other {', '.join(names)})" if names else ""
