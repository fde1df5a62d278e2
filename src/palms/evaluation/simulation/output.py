"""Simulated cases as a data set."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from palms.errors import FormatError, InputError
from palms.evaluation.simulation.cases import (
    CaseSettings,
    SimulatedCase,
    Start,
    simulate_start,
    simulate_walk,
)
from palms.evaluation.simulation.nuisances import NuisanceRanges, Nuisances
from palms.evaluation.simulation.sites import Site
from palms.io import read_json, write_case, write_json, write_plan
from palms.io.events import EVENTS_FILE, write_events
from palms.io.values import StrPath, check_number

__all__ = [
    "NUISANCES_FILE",
    "PICTURE_FILE",
    "Count",
    "read_nuisances",
    "simulate_site",
    "write_simulated",
]

NUISANCES_FILE = "nuisances.json"
NUISANCES_SCHEMA = "palms-nuisances/1"
PICTURE_FILE = "picture.png"


class Count(NamedTuple):
    """How many starts, and walks from each.

    Examples
    --------
    >>> Count(7, 2).cases
    14
    """

    starts: int
    walks: int

    @property
    def cases(self) -> int:
        """How many walks in all."""
        return self.starts * self.walks


def simulate_site(
    site: Site, count: Count, settings: CaseSettings, ranges: NuisanceRanges | None = None
) -> Iterator[SimulatedCase]:
    """Simulate all cases of a building, one by one.

    Parameters
    ----------
    site : Site
    count : Count
    settings : CaseSettings
    ranges : NuisanceRanges, optional

    Yields
    ------
    SimulatedCase

    Examples
    --------
    >>> from palms.evaluation.simulation import generate_levels, make_site
    >>> site = make_site(generate_levels("office", 7, 1), seed=7)
    >>> cases = simulate_site(site, Count(1, 2), CaseSettings(length_m=20.0))
    >>> [case.name for case in cases]
    ['start-1-walk-1', 'start-1-walk-2']
    """
    starts: list[Start] = []
    for s in range(count.starts):
        starts.append(simulate_start(site, s, starts, settings, ranges))
        for w in range(count.walks):
            yield simulate_walk(site, starts[-1], w, settings, ranges)


def write_simulated(folder: StrPath, site: Site, case: SimulatedCase, picture: bool = True) -> Path:
    """Write a case into a data set, with all that belongs to it; return its folder.

    Parameters
    ----------
    folder : path
        The data set; created when it is not there. The site's drawings are written, too.
    site : Site
    case : SimulatedCase
    picture : bool
        Whether to draw it.

    Raises
    ------
    OutputError
        When it cannot be written, or there is such a case.

    Examples
    --------
    >>> import tempfile
    >>> from palms.evaluation.simulation import generate_levels, make_site
    >>> site = make_site(generate_levels("office", 7, 1), seed=7)
    >>> (case,) = simulate_site(site, Count(1, 1), CaseSettings(length_m=20.0))
    >>> with tempfile.TemporaryDirectory() as out:
    ...     written = write_simulated(out, site, case)
    ...     sorted(path.name for path in written.iterdir())
    ['Session_1001', 'nuisances.json', 'picture.png', 'start-1-walk-1.json', 'truth.csv']
    """
    for drawing in site.drawings:
        if not (Path(folder) / "maps" / f"{drawing.name}.csv").exists():
            write_plan(folder, drawing)
    written = write_case(folder, site.name, case.name, case.recorded, case.scans, case.labels)
    if case.events:
        write_events(case.events, written / EVENTS_FILE)
    content = {
        "schema": NUISANCES_SCHEMA,
        "seed": site.seed,
        "nuisances": case.nuisances.to_json(),
        "stretch": {
            "centre_m": site.stretch.centre_m.tolist(),
            "matrix": site.stretch.matrix.tolist(),
        },
    }
    write_json(written / NUISANCES_FILE, content)
    if picture:
        from palms.evaluation.simulation.picture import DPI, case_figure
        from palms.plot.output import write_figure

        write_figure(written / PICTURE_FILE, case_figure(site, case), DPI)
    return written


def read_nuisances(folder: StrPath) -> Nuisances:
    """Read the noise parameters of a case from its folder.

    Raises
    ------
    InputError
        When there are none: the case is not simulated.
    FormatError
        When the file is damaged.

    Examples
    --------
    >>> read_nuisances("no/such/case")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/case: expected nuisances.json of a simulated case, got none
    """
    path = Path(folder) / NUISANCES_FILE
    if not path.is_file():
        raise InputError(
            str(folder), expected=f"{NUISANCES_FILE} of a simulated case", got="none"
        )  # fmt: skip
    content = read_json(path)
    if not isinstance(content, dict) or content.get("schema") != NUISANCES_SCHEMA:
        raise FormatError(str(path), expected=f"schema {NUISANCES_SCHEMA}", got="something else")
    given = content.get("nuisances")
    missing = [name for name in NuisanceRanges.names() if name not in (given or {})]
    if not isinstance(given, dict) or missing:
        raise FormatError(
            str(path), expected="nuisances by name", got=f"none called {', '.join(missing[:3])}"
        )  # fmt: skip
    return Nuisances(
        **{name: check_number(given[name], f"{path}: {name}") for name in NuisanceRanges.names()}
    )
