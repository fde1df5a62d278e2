"""Plans and walks written into a data set, each whole or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Sequence
from pathlib import Path

from palms.errors import InputError, OutputError
from palms.floorplan import FloorPlan
from palms.io.files import make_folder
from palms.io.label import Label, write_label
from palms.io.plan_csv import write_plan_csv
from palms.io.planes import write_scan_json
from palms.io.tracking import write_tracking
from palms.io.values import StrPath
from palms.io.walk import RecordedWalk
from palms.scan import Scan

__all__ = ["write_case", "write_plan"]


def _checked_name(name: str, what: str) -> str:
    if not name or name.startswith(".") or any(c in name for c in "/\\\x00"):
        raise InputError(what, expected="a name that a file can have", got=repr(name))
    return name


def write_plan(folder: StrPath, plan: FloorPlan) -> Path:
    """Write a plan into a data set, as ``maps/<plan.name>.csv``; return its path.

    Parameters
    ----------
    folder : path
        The data set; created when it is not there.
    plan : FloorPlan
        The plan; its name becomes the scene's.

    Raises
    ------
    InputError
        When its name cannot be a file's.
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_plan(folder, FloorPlan([[[0, 0], [8, 0]]], name="E2")).name
    'E2.csv'
    """
    name = _checked_name(plan.name, "name of the plan")
    path = make_folder(Path(folder) / "maps") / f"{name}.csv"
    write_plan_csv(plan, path)
    return path


def write_case(
    folder: StrPath,
    scene: str,
    name: str,
    walk: RecordedWalk,
    scans: Sequence[Scan],
    labels: Sequence[Label | None] = (),
) -> Path:
    """Write a walk with its scans and labels into a data set, whole or not at all.

    Parameters
    ----------
    folder : path
        The data set; created when it is not there.
    scene, name : str
        Name of the scene (that of its plan) and of the walk.
    walk : RecordedWalk
        The walk.
    scans : sequence of Scan
        Its scans, in order of time.
    labels : sequence of Label or None
        Their labels; may be shorter.

    Returns
    -------
    Path
        The folder ``trajectories/<scene>/<name>``.

    Raises
    ------
    InputError
        When a name cannot be a folder's.
    OutputError
        When it cannot be written, or that folder already holds something.

    Examples
    --------
    >>> import tempfile
    >>> from palms import Odometry
    >>> from palms.io import open_dataset
    >>> plan = FloorPlan([[[0, 0], [8, 0]]], name="E2")
    >>> walk = RecordedWalk(arkit=Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = write_plan(folder, plan)
    ...     scans, labels = [Scan([[[2, -2], [2, 2]]])], [Label((1, 1), 0)]
    ...     _ = write_case(folder, "E2", "w1", walk, scans, labels)
    ...     open_dataset(folder).cases[0].label().position_m.tolist()
    [1.0, 1.0]
    """
    parent = Path(folder) / "trajectories" / _checked_name(scene, "name of the scene")
    target = make_folder(parent) / _checked_name(name, "name of the walk")
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise OutputError(
            str(target), expected="a new folder", got="one with files in it",
            fix="remove it or choose another",
        )  # fmt: skip
    part = make_folder(parent / f".{secrets.token_hex(6)}.part")
    try:
        write_tracking(walk, part / f"{name}.json")
        for session, scan, label in _sessions(walk, scans, labels):
            write_scan_json(scan, make_folder(part / session))
            if label is not None:
                write_label(label, part / session / "label.txt")
        os.replace(part, target)
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(str(target), got=str(error.strerror)) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return target


def _sessions(
    walk: RecordedWalk, scans: Sequence[Scan], labels: Sequence[Label | None]
) -> list[tuple[str, Scan, Label | None]]:
    """Folder of each scan; several of one session get a number, scan.json names it."""
    padded = [*labels, *[None] * (len(scans) - len(labels))]
    named: list[tuple[str, Scan, Label | None]] = []
    used: set[str] = set()
    for index, (scan, label) in enumerate(zip(scans, padded, strict=False), start=1):
        own = scan.session or next(iter(walk.session), str(index))
        base = f"Session_{_checked_name(own.removeprefix('Session_'), 'session of the scan')}"
        folder = base if base not in used else f"{base}_scan{index}"
        used.add(folder)
        named.append((folder, scan, label))
    return named
