"""How time grows: with particles, with the plan, with its walls, with the drifts, with trials."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import quickest_ms
from benchmarks.populations import KEY, MOVE, spread
from benchmarks.world import campus, crowded, raster, scan, walk
from palms.heatmap import match, scan_drifts
from palms.io.files import make_folder, write_bytes
from palms.localizer import track_trials
from palms.particles import advance, start_everywhere
from palms.plot import image_bytes
from palms.plot.style import ANSWER, INK, MUTED, SCAN, TRUTH, new_figure, styled
from palms.raster import rasterize
from palms.settings import MotionSettings, Settings

STYLES = ((SCAN, "o", "solid"), (ANSWER, "s", (0, (4, 1.6))), (TRUTH, "^", (0, (1, 1.6))))
SIDE = "side of the plan in m (1 km: cells of 0.2 m)"
PARTICLES = (250, 1000, 4000, 16_000, 64_000, 250_000, 1_000_000)
SIDES_M = (30, 60, 120, 250, 400)
WALLS = (100, 1000, 10_000, 100_000)
DRIFTS = (4, 12, 36, 72, 180, 360)
ALONE, TOGETHER = (1, 3, 10, 30, 100), (300, 1000, 2000, 4200)


@dataclass(frozen=True)
class Curve:
    """Times against a size; drawn in the panel of its `over`."""

    over: str
    name: str
    size: tuple[float, ...]
    time_ms: tuple[float, ...]


def curves() -> Iterator[Curve]:
    """Measure all but the trials."""
    motion, plan = MotionSettings(), raster()
    yield _curve(
        "particles", "one step", PARTICLES,
        lambda n: _step(start_everywhere(plan, n, KEY)),
    )  # fmt: skip
    sides = [*SIDES_M, 1000]
    plans = {side: campus(float(side), _cells_of(side)) for side in sides}
    yield _curve(SIDE, "rasterise", sides,
                 lambda side: lambda: rasterize(plans[side].plan, _cells_of(side)))  # fmt: skip
    drifts = scan_drifts(scan(), plan)
    yield _curve(SIDE, "4 heatmaps", sides,
                 lambda side: lambda: list(match(scan(), plans[side], drifts)))  # fmt: skip
    plans.clear()
    yield _curve("walls", "rasterise", WALLS, lambda n: lambda: rasterize(crowded(n).plan))
    yield _curve(
        "walls", "one step of 2,000 particles", WALLS,
        lambda n: lambda: advance(spread(2000), MOVE, crowded(n), motion, KEY),
    )  # fmt: skip
    yield _curve(
        "drifts", "heatmaps", DRIFTS,
        lambda n: lambda: sum(1 for _ in match(scan(), plan, np.arange(n) * 2 * np.pi / n)),
    )  # fmt: skip


def trials(alone: Sequence[int] = ALONE, together: Sequence[int] = TOGETHER) -> Iterator[Curve]:
    """Measure trials of the paper's method on one and two cores, by the wall's clock: minutes.

    Few trials are a run of their own. The others are one run, looked at when so many of its
    trials have come: that takes as long as if it ended there.
    """
    sizes = (*alone, *together)
    for jobs in (1, 2):
        name = f"{jobs} core{'s' * (jobs > 1)}"
        list(_arrivals_ms((2,), jobs))  # not counted: loads the loops
        times: list[float] = []
        for marks in (*((n,) for n in alone), together):
            for time_ms in _arrivals_ms(marks, jobs):
                times.append(time_ms)
                print(f"{sizes[len(times) - 1]:,} trials, {name}: {time_ms / 1e3:.3g} s",
                      file=sys.stderr)  # fmt: skip
        yield Curve("trials", name, sizes, tuple(times))


def _arrivals_ms(marks: Sequence[int], jobs: int) -> Iterator[float]:
    """Follow as many trials as the last mark says; yield the time when so many have come."""
    start = time.perf_counter()
    tracks = track_trials(raster(), scan(), walk(), Settings.paper(), range(marks[-1]), jobs)
    for number, _ in enumerate(tracks, start=1):
        if number in marks:
            yield 1e3 * (time.perf_counter() - start)


def _cells_of(side_m: float) -> Any:
    from benchmarks.bench_heatmaps import KILOMETRE
    from palms.settings import RasterSettings

    return KILOMETRE if side_m > 400 else RasterSettings()


def _step(particles: Any) -> Callable[[], object]:
    return lambda: advance(particles, MOVE, raster(), MotionSettings(), KEY)


def _curve(
    over: str, name: str, sizes: Sequence[float], work: Callable[[Any], Callable[[], object]]
) -> Curve:
    return Curve(over, name, tuple(sizes), tuple(quickest_ms(work(size)) for size in sizes))


@styled
def draw(found: Sequence[Curve], path: Path) -> None:
    """Draw the curves, a panel for each size, and a line of slope 1 in each."""
    panels = list(dict.fromkeys(curve.over for curve in found))
    rows = -(-len(panels) // 2)
    figure = new_figure(7.2, 2.9 * rows)
    for k, over in enumerate(panels):
        axes = figure.add_subplot(rows, min(2, len(panels)), k + 1)
        mine = [curve for curve in found if curve.over == over]
        for curve, (colour, marker, dashes) in zip(mine, STYLES, strict=False):
            axes.loglog(curve.size, curve.time_ms, color=colour, marker=marker, linestyle=dashes,
                        markersize=4, label=curve.name)  # fmt: skip
        _linear(axes, mine[0])
        axes.set_xlabel(over)
        axes.set_ylabel("ms")
        axes.legend(loc="upper left")
    make_folder(path.parent)
    write_bytes(path, image_bytes(figure))


def _linear(axes: Any, curve: Curve) -> None:
    """A grey line that grows as the size does (a plan: its cells), down from the last point."""
    size, plan = np.array(curve.size), curve.over == SIDE
    line = curve.time_ms[-1] * (size / size[-1]) ** (2 if plan else 1)
    axes.loglog(size, line, color=MUTED, linewidth=0.7, zorder=0)
    word = "linear in cells" if plan else "linear"
    axes.annotate(word, (size[-2], line[-2]), (10, -20), textcoords="offset points", color=INK,
                  fontsize=7)  # fmt: skip


def as_json(found: Sequence[Curve]) -> list[dict[str, Any]]:
    """The curves as JSON."""
    return [asdict(curve) for curve in found]
