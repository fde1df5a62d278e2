"""Damaged copies of good walk files give a PalmsError or a valid walk, never anything else."""

from __future__ import annotations

import functools
import json
from pathlib import Path

import pytest
from hypothesis import given, settings

from palms.errors import PalmsError
from palms.io import RecordedWalk, formats, read_walk
from palms.io.registry import ODOMETRY
from tests.io.damage import damaged, damages, outcome
from tests.io.sensor_records import pushed, records

DATA = Path(__file__).parent / "data" / "walks"
FILES = {
    "tum-z.tum": "tum",
    "arkit-3x4-ns.txt": "poses",
    "arkit-4x4-columns.csv": "poses",
    "arkit-transform.json": "poses",
    "arcore-ms.jsonl": "poses",
    "stray-odometry.csv": "poses",
    "steps.csv": "steps",
    "ronin.npy": "ronin",
    "android.txt": "android",
    "sensor-logger-ios.zip": "sensor-logger",
}
GOOD = {name: (DATA / name).read_bytes() for name in FILES}
FILES["export.json"] = FILES["pushed.jsonl"] = "sensor-logger"
GOOD["export.json"] = json.dumps(records("ios")).encode()
GOOD["pushed.jsonl"] = "\n".join(map(json.dumps, pushed("android"))).encode()
SLOW = ("android.txt", "sensor-logger-ios.zip", "export.json", "pushed.jsonl")


def attempt(path: Path, name: str | None) -> None:
    outcome(functools.partial(read_walk, path, format=name), RecordedWalk, path)


def check(folder: Path, name: str, damages) -> None:
    path = folder / name
    path.write_bytes(damaged(GOOD[name], damages))
    for kind in (None, FILES[name]):
        attempt(path, kind)


@pytest.mark.parametrize("name", sorted(set(FILES) - set(SLOW)))
@settings(derandomize=True, deadline=None, max_examples=80)
@given(damages=damages)
def test_damaged_copies(tmp_path_factory, name, damages):
    check(tmp_path_factory.getbasetemp(), name, damages)


@pytest.mark.parametrize("name", SLOW)
@settings(derandomize=True, deadline=None, max_examples=25)
@given(damages=damages)
def test_damaged_copies_of_sensor_logs(tmp_path_factory, name, damages):
    check(tmp_path_factory.getbasetemp(), name, damages)


@pytest.mark.parametrize("kind", sorted(set(FILES.values())))
@pytest.mark.parametrize("name", [*FILES, "empty", "text", "binary", "zip"])
def test_files_of_another_format(tmp_path, kind, name):
    others = {"empty": b"", "text": b"hello\nworld\n", "binary": bytes(range(256)) * 9,
              "zip": b"PK\x03\x04" + bytes(99)}  # fmt: skip
    path = tmp_path / ("a" + Path(name).suffix)
    path.write_bytes(GOOD.get(name, others.get(name)))
    attempt(path, kind)


@pytest.mark.parametrize("kind", [reader.name for reader in formats(ODOMETRY)])
def test_nothing_there_and_a_folder(tmp_path, kind):
    for path in (tmp_path / "none", tmp_path):
        with pytest.raises(PalmsError) as caught:
            read_walk(path, format=kind)
        assert "\n" not in str(caught.value)
