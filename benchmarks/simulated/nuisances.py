"""What doubling each nuisance does: every data set and its results, then figure and table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.simulated.steps import bench_only, read
from benchmarks.simulated.studies import Nuisances
from benchmarks.simulated.tables import by_size, nuisances_table
from palms.evaluation.charts import effects_figure
from palms.evaluation.sensitivity import Effect, nuisance_effects
from palms.plot.output import write_figure

SHOWN = 10  # in the figure; the table has all
DPI = 100.0
FIGURE = "nuisances.png"
WORDS = (
    "For each nuisance a bar from the figure as it is to the figure with the nuisance twice as "
    "strong, with the interval of the change; hatched where it is for the worse"
)


def run(plan: Nuisances, work: Path, jobs: int) -> Iterator[str]:
    """Simulate and run what is missing; yield each name when it is done."""
    for name in (None, *plan.names):
        bench_only(plan.study(name), work, jobs)
        yield name or "plain"


def write(plan: Nuisances, work: Path, figures: Path) -> str:
    """Write the figure into a folder and return the table."""
    results = read(plan.study(), work)
    changed = {name: read(plan.study(name), work)["trials"] for name in plan.names}
    effects = nuisance_effects(results["trials"], changed)
    write_figure(figures / FIGURE, effects_figure(largest(effects)), DPI)
    return nuisances_table(results, effects, f"![{WORDS}](figures/{FIGURE})")


def largest(effects: Sequence[Effect]) -> list[Effect]:
    """Return the effects of the nuisances that change most."""
    names = list(dict.fromkeys(effect.nuisance for effect in by_size(effects)))[:SHOWN]
    return [effect for effect in effects if effect.nuisance in names]
