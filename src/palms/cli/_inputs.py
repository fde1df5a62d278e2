"""From what the user named to values."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from palms.errors import PalmsWarning, SettingsError

if TYPE_CHECKING:
    from palms.advice import Advice
    from palms.building import Building
    from palms.floorplan import FloorPlan
    from palms.heatmap import Candidates
    from palms.hints import Hint
    from palms.io import RecordedWalk
    from palms.localizer import Happening
    from palms.odometry import Odometry
    from palms.posterior import Posterior
    from palms.raster import PlanRaster
    from palms.scan import Scan
    from palms.settings import Settings

__all__ = [
    "Case",
    "Input",
    "make_settings",
    "read_case",
    "read_plan",
    "read_scan",
    "read_walk",
    "scaled",
    "scan_name",
    "walk_name",
]


def make_settings(
    method: str, cell_size_m: float | None = None, particles: int | None = None
) -> Settings:
    """Return the settings of a method with the numbers that the user gave.

    Raises
    ------
    SettingsError
        When there is no such method, or a number is out of its range.

    Examples
    --------
    >>> make_settings("paper", particles=500).start.n_particles
    500
    """
    from palms.settings import Settings

    if method == "oracle":
        raise SettingsError(
            "method oracle", expected="the noise that a walk was simulated with",
            got="a walk alone", fix="run it with: palms bench DATASET --methods oracle --out DIR",
        )  # fmt: skip
    settings = Settings.for_method(method)
    if cell_size_m is not None:
        settings = replace(settings, raster=replace(settings.raster, cell_size_m=cell_size_m))
    return settings if particles is None else settings.with_particles(particles)


@dataclass(frozen=True, slots=True)
class Case:
    """A plan, a scan and a walk that belong together, as read.

    Parameters
    ----------
    plan : FloorPlan
    scan : Scan
    walk : RecordedWalk
    odometry : Odometry
        Of the walk: by the source that was asked for, or the usual one.
    source : str
        Its name.
    scan_name, walk_name : str
        What to call scan and walk.
    building : Building, optional
        Where there are several levels; `plan` is the lowest.
    hints : tuple of Hint
        What is said of where it starts.
    raster : PlanRaster, optional
        The plan in cells, once it is made; where there are several levels the building has it.
    found : Candidates, Posterior or None
        Where the scan may have been taken, once that has been asked.
    advice : Advice, optional
        How much the scan tells, once it has been searched for.
    """

    plan: FloorPlan
    scan: Scan
    walk: RecordedWalk
    odometry: Odometry
    source: str
    scan_name: str
    walk_name: str
    building: Building | None = None
    hints: tuple[Hint, ...] = ()
    raster: PlanRaster | None = None
    found: Candidates | Posterior | None = None
    advice: Advice | None = None

    @property
    def ground(self) -> FloorPlan | PlanRaster | Building:
        """What it is looked for in."""
        return self.building or self.raster or self.plan

    @property
    def told(self) -> tuple[Happening, ...]:
        """What is known where the walk begins: hints, and the scan."""
        from palms.localizer import Happening

        said = (Happening(-math.inf, hint) for hint in self.hints)
        return (*said, Happening(-math.inf, self.scan, self.found))

    def plan_of(self, level: str | None) -> FloorPlan:
        """Return the plan of a level; the only one where none is named."""
        if self.building is None or level is None:
            return self.plan
        return self.building.level(level)


@dataclass(frozen=True, slots=True)
class Input:
    """A file that the user named, the format that it is of, and options for its reader.

    Parameters
    ----------
    path : Path
    format : str, optional
        Found out when left out.
    options : sequence of str, optional
        As ``name=value``.
    """

    path: Path
    format: str | None = None
    options: Sequence[str] | None = None

    def read(self, group: str) -> Any:  # noqa: ANN401
        """Read it as a floor plan, a scan or a walk."""
        from palms.io import read_any

        return read_any(group, self.path, self.format, self.options or ())


def scaled(options: Sequence[str] | None, scale_m: float | None) -> list[str]:
    """Return options for a reader, with the scale that was given by an option of its own.

    Examples
    --------
    >>> scaled(["invert=true"], 0.02)
    ['invert=true', 'scale=0.02']
    """
    given = [] if scale_m is None else [f"scale={scale_m!r}"]
    return [*(options or ()), *given]


def read_plan(given: Input) -> FloorPlan:
    """Read a floor plan."""
    from palms.io import FLOORPLANS

    plan: FloorPlan = given.read(FLOORPLANS)
    return plan


def read_scan(given: Input) -> Scan:
    """Read a scan."""
    from palms.io import SCANS

    scan: Scan = given.read(SCANS)
    return scan


def read_walk(given: Input) -> RecordedWalk:
    """Read a recorded walk."""
    from palms.io import ODOMETRY

    walk: RecordedWalk = given.read(ODOMETRY)
    return walk


def read_case(
    plan: Input | Building,
    scan: Input,
    walk: Input,
    odometry: Literal["arkit", "ronin"] | None = None,
) -> Case:
    """Read a plan, a scan and a walk, and make sure that scan and walk belong together.

    Parameters
    ----------
    plan, scan, walk : Input
        A building that was read is taken as it is.
    odometry : {"arkit", "ronin"}, optional
        Which of the walk; `RecordedWalk.usual_source` when left out.

    Raises
    ------
    InputError
        When one of them is at fault, or scan and walk are of different sessions.

    Warns
    -----
    PalmsWarning
        When none was asked for and the walk has no visual-inertial odometry.
    """
    from palms.io import check_same_session

    floor = read_plan(plan) if isinstance(plan, Input) else plan.levels[0]
    seen, recorded = read_scan(scan), read_walk(walk)
    source = odometry or recorded.usual_source
    moves = recorded.odometry(source)
    check_same_session(seen, moves)
    if odometry is None and source != "arkit":
        warnings.warn(
            f"{walk.path}: there is no arkit odometry; it is followed by {source}, all that it has",
            PalmsWarning,
            stacklevel=2,
        )
    names = scan_name(scan.path), walk_name(walk.path)
    several = None if isinstance(plan, Input) or len(plan.levels) == 1 else plan
    return Case(floor, seen, recorded, moves, source, *names, several)


def scan_name(path: Path) -> str:
    """Return what to call a scan: its session's folder, else its file.

    Examples
    --------
    >>> scan_name(Path("walk/Session_7/detectedPlanes.json")), scan_name(Path("scan.json"))
    ('Session_7', 'scan')
    """
    place = path.resolve()
    if place.is_dir():
        return place.name
    return place.parent.name if place.parent.name.startswith("Session_") else place.stem


def walk_name(path: Path) -> str:
    """Return what to call a walk: its file or folder.

    Examples
    --------
    >>> walk_name(Path("trajectories/E2/walk-1/walk-1.json"))
    'walk-1'
    """
    place = path.resolve()
    return place.name if place.is_dir() else place.stem
