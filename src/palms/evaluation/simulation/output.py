"""Simulated cases as a data set."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from palms.evaluation.simulation.cases import (
    CaseSettings,
    SimulatedCase,
    Start,
    simulate_start,
    simulate_walk,
)
from palms.evaluation.simulation.nuisances import NuisanceRanges
from palms.evaluation.simulation.sites import Site
from palms.io import write_case, write_json, write_plan
from palms.io.events import EVENTS_FILE, write_events
from palms.io.values import StrPath

__all__ = ["NUISANCES_FILE", "PICTURE_FILE", "Count", "simulate_site", "write_simulated"]

NUISANCES_FILE = "nuisances.json"
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
        "schema": "palms-nuisances/1",
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
