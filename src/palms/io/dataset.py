"""A whole data set: a folder with maps and trajectories.

::

    maps/<scene>.csv, <scene>-level-<name>.csv
    trajectories/<scene>/<walk>/events.json
    trajectories/<scene>/<walk>/<walk>.json, truth.csv
    trajectories/<scene>/<walk>/Session_<id>/detectedPlanes.json, label.txt, scan.json
    trajectories/<scene>/<walk>/Session_<id>/depths, poses, intrinsics

A session has planes, depth images or both. Names are looked up when the data set is opened;
plans, scans and walks are read when they are asked for. Unknown files are left alone.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from palms.errors import InputError, PalmsWarning
from palms.floorplan import FloorPlan
from palms.io.depth_folder import FORMAT as DEPTH
from palms.io.depth_folder import read_depth_folder
from palms.io.events import EVENTS_FILE, Event, read_events
from palms.io.happenings import happenings_of
from palms.io.label import Label, read_label
from palms.io.levels import with_level_name
from palms.io.plan_csv import plan_name, read_plan_csv
from palms.io.planes import PLANES_FILE, read_scan_json, scan_time_s
from palms.io.tracking import read_tracking, walk_file
from palms.io.values import StrPath, locating, parse_number
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry
from palms.scan import Scan

if TYPE_CHECKING:
    from palms.building import Building
    from palms.localizer import Happening

__all__ = ["Case", "Dataset", "check_same_session", "open_dataset"]


@dataclass(frozen=True, slots=True)
class Case:
    """One walk of a data set with its plan, scans and labels.

    Parameters
    ----------
    scene : str
        Name of the building or floor.
    plan_path : Path
        Its floor plan.
    name : str
        Name of the walk.
    walk_path : Path
        The walk's JSON file.
    scan_paths : tuple of Path
        Folders of its scans, in order of time.
    above_paths : tuple of Path
        Plans of the building's other levels, from the next one up.

    Examples
    --------
    >>> from pathlib import Path
    >>> Case("E2", Path("maps/E2.csv"), "w1", Path("w1.json"), ()).title
    'E2/w1'
    """

    scene: str
    plan_path: Path
    name: str
    walk_path: Path
    scan_paths: tuple[Path, ...]
    above_paths: tuple[Path, ...] = ()

    @property
    def title(self) -> str:
        """Scene and walk, to call it by."""
        return f"{self.scene}/{self.name}"

    @property
    def folder(self) -> Path:
        """The walk's folder."""
        return self.walk_path.parent

    @property
    def events_path(self) -> Path:
        """Where events stand, if there are any."""
        return self.folder / EVENTS_FILE

    def plan(self) -> FloorPlan:
        """Read the floor plan; the lowest where there are several."""
        return read_plan_csv(self.plan_path)

    def building(self) -> Building:
        """Read the plans of all levels."""
        from palms.building import Building

        if not self.above_paths:
            return Building((self.plan(),))
        paths = (self.plan_path, *self.above_paths)
        with locating(self.plan_path):
            return Building(tuple(with_level_name(read_plan_csv(path), path) for path in paths))

    def events(self) -> tuple[Event, ...]:
        """Read what happens during the walk; nothing where no file says so."""
        return read_events(self.events_path) if self.events_path.is_file() else ()

    def happenings(self, odometry: Odometry, building: Building) -> tuple[Happening, ...]:
        """Read what a method is told during the walk: scans and hints with their times.

        Parameters
        ----------
        odometry : Odometry
            Of this walk.
        building : Building
            That of this case.
        """
        return happenings_of(self.scans(), self.events(), odometry, building)

    def walk(self) -> RecordedWalk:
        """Read the walk."""
        return read_tracking(self.walk_path)

    def scans(self) -> tuple[Scan, ...]:
        """Read all scans, in order of time."""
        return tuple(_read_session(path) for path in self.scan_paths)

    def scan(self) -> Scan:
        """Read the first scan.

        Raises
        ------
        InputError
            When the walk has none.
        """
        if not self.scan_paths:
            raise InputError(
                str(self.folder),
                expected=f"a folder Session_<id> with {PLANES_FILE} or depths",
                got="none",
                fix="add the walk's scan",
            )
        return _read_session(self.scan_paths[0])

    def label(self, scan: int = 0) -> Label | None:
        """Read the label of a scan; None when it has none."""
        if not 0 <= scan < len(self.scan_paths):
            return None
        path = self.scan_paths[scan] / "label.txt"
        return read_label(path) if path.is_file() else None


@dataclass(frozen=True, slots=True)
class Dataset:
    """A data set: its folder `path` and its walks `cases`, by scene and name.

    Examples
    --------
    >>> from pathlib import Path
    >>> len(Dataset(Path("simulated"), ()))
    0
    """

    path: Path
    cases: tuple[Case, ...]

    def __len__(self) -> int:
        return len(self.cases)

    @property
    def scenes(self) -> tuple[str, ...]:
        """Names of the scenes that have walks."""
        return tuple(dict.fromkeys(case.scene for case in self.cases))


def open_dataset(path: StrPath) -> Dataset:
    """Look up what a data set holds, without reading plans, scans and walks.

    Parameters
    ----------
    path : path
        The folder that holds ``maps`` and ``trajectories``.

    Raises
    ------
    InputError
        When one of them is missing, a scene has no plan, or there is no walk at all.

    Warns
    -----
    PalmsWarning
        For each folder with scans but no walk, which is left out.

    Examples
    --------
    >>> open_dataset("no/such/folder")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/folder: expected a data set with the folders maps and ...
    """
    root = Path(path)
    missing = [name for name in ("maps", "trajectories") if not (root / name).is_dir()]
    if missing:
        got = f"no {' and no '.join(missing)}" if root.is_dir() else "no folder there"
        raise InputError(
            str(path),
            expected="a data set with the folders maps and trajectories",
            got=got,
            fix="check the folder, or make one with: palms simulate",
        )
    plans = {file.stem: file for file in _visible(root / "maps") if file.suffix.lower() == ".csv"}
    cases: list[Case] = []
    for scene in _visible(root / "trajectories"):
        if scene.is_dir() and any(folder.is_dir() for folder in _visible(scene)):
            plan = _plan_of(scene.name, plans, root)
            cases += _cases_of(scene, plan, _above(plan, plans, root))
    if not cases:
        raise InputError(
            str(root / "trajectories"), expected="<scene>/<walk>/<walk>.json", got="no walk",
            fix="check the folder",
        )  # fmt: skip
    return Dataset(root, tuple(cases))


def _visible(folder: Path) -> list[Path]:
    try:
        return sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    except OSError as error:
        raise InputError(
            str(folder), expected="a folder that can be read", got=str(error.strerror),
            fix="check the rights",
        ) from None  # fmt: skip


def _plan_of(scene: str, plans: dict[str, Path], root: Path) -> Path:
    if scene in plans:
        return plans[scene]
    fitting = [path for path in plans.values() if scene in (path.name, plan_name(path))]
    if len(fitting) == 1:
        return fitting[0]
    raise InputError(
        str(root / "maps"),
        expected=f"the plan {scene}.csv of the scene {scene}",
        got=", ".join(sorted(plans)[:5]) or "no plan",
        fix="add it, or remove the scene",
    )


def _above(plan: Path, plans: dict[str, Path], root: Path) -> tuple[Path, ...]:
    """Return the plans of a scene's other levels, by their numbers, else by their names."""
    start = f"{plan.stem}-level-"
    levels = {
        name.removeprefix(start): path
        for name, path in plans.items()
        if name.startswith(start) and not (root / "trajectories" / name).is_dir()
    }
    numbers = {name: parse_number(name) for name in levels}
    numbered = all(number is not None for number in numbers.values())
    ordered = sorted(levels, key=lambda name: (numbers[name] or 0.0 if numbered else 0.0, name))
    return tuple(levels[name] for name in ordered)


def _cases_of(scene: Path, plan: Path, above: tuple[Path, ...]) -> list[Case]:
    cases = []
    for folder in _visible(scene):
        if not folder.is_dir():
            continue
        scans = _scans_of(folder)
        if not any(f.suffix == ".json" and f.name != EVENTS_FILE for f in _visible(folder)):
            if scans:
                warnings.warn(
                    f"{folder}: scans without a walk; left out", PalmsWarning, stacklevel=3
                )
            continue
        cases.append(Case(scene.name, plan, folder.name, walk_file(folder), scans, above))
    return cases


def _scans_of(folder: Path) -> tuple[Path, ...]:
    found = [
        entry
        for entry in _visible(folder)
        if entry.name.startswith("Session_")
        and ((entry / PLANES_FILE).is_file() or DEPTH.recognizes(entry))
    ]
    if len(found) > 1:
        found.sort(key=lambda entry: (scan_time_s(entry), entry.name))
    return tuple(found)


def _read_session(folder: Path) -> Scan:
    """Read the scan of a session: its planes, else what its depth images show."""
    has_planes = (folder / PLANES_FILE).is_file()
    return read_scan_json(folder) if has_planes else read_depth_folder(folder)


def check_same_session(scan: Scan, walk: Odometry | RecordedWalk) -> None:
    """Refuse a scan and a walk of two phone sessions: they share neither frame nor start.

    Nothing is said when either names no session.

    Parameters
    ----------
    scan : Scan
        The scan.
    walk : Odometry or RecordedWalk
        The walk.

    Raises
    ------
    InputError
        When both name sessions and none agrees.

    Examples
    --------
    >>> walk = Odometry([1, 2], [[1, 0], [2, 0]], session=("8",))
    >>> check_same_session(Scan([[[2, -2], [2, 2]]], session="Session_8"), walk)
    >>> check_same_session(Scan([[[2, -2], [2, 2]]], session="7"), walk)
    Traceback (most recent call last):
    palms.errors.InputError: scan and walk: expected one session, got the scan of 7 and the ...
    """
    names = [name.removeprefix("Session_") for name in walk.session]
    if scan.session is None or not names:
        return
    own = scan.session.removeprefix("Session_")
    if own not in names:
        raise InputError(
            "scan and walk",
            expected="one session",
            got=f"the scan of {own} and the walk of {', '.join(names)}",
            fix="take the scan that was made at the start of this walk",
        )
