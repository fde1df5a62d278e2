"""The paper's Fig. 1: from a scan and a plan to particles of four drifts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecFromSubplotSpec
from matplotlib.image import AxesImage
from matplotlib.patches import Circle
from matplotlib.transforms import ScaledTranslation

from palms.errors import InputError
from palms.geometry import FloatArray
from palms.heatmap import Candidates, ScoreMaps
from palms.particles import Particles
from palms.plot.plans import draw_plan
from palms.plot.recorder import by_weight
from palms.plot.style import (
    GROUPS,
    INK,
    MUTED,
    SCAN,
    GroupStyle,
    degrees,
    draw_particles,
    frame_map,
    group_entries,
    groups_of,
    new_figure,
    styled,
    truth_entry,
    truth_mark,
)
from palms.posterior import Posterior
from palms.scan import Scan

__all__ = ["draw_scan", "pipeline_figure"]

_RINGS_M = (1.0, 3.0, 5.0)  # paper V: the scanner's range is 5 m
_PIXELS = 330  # of the longer side of a heatmap; more than its panel shows
_PARTICLES = 2000
_HATCHED = 0.25  # of the template's bound: emptier cells are hatched, to be told in grey


@styled
def pipeline_figure(
    heatmaps: ScoreMaps,
    candidates: Candidates | Posterior,
    particles: Particles | None = None,
    truth_m: npt.ArrayLike | None = None,
) -> Figure:
    """Draw how a scan becomes particles: scan, plan, template, heatmaps, particles.

    Parameters
    ----------
    heatmaps : Heatmaps or Likelihoods
        With more than four drifts, the best one of each quarter of the circle is shown.
    candidates : Candidates or Posterior
        Found in these heatmaps.
    particles : Particles, optional
        The start; evenly chosen candidate cells when left out.
    truth_m : array_like (2,), optional
        Where the scan was truly taken, map frame.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> from palms import FloorPlan, rasterize
    >>> from palms.heatmap import find_candidates, match
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> drifts_rad = [0.0, np.pi / 2, np.pi, -np.pi / 2]
    >>> heatmaps = match(Scan(room - (2.0, 1.0)), rasterize(FloorPlan(room)), drifts_rad)
    >>> figure = pipeline_figure(heatmaps, find_candidates(heatmaps), truth_m=[2.0, 1.0])
    >>> [axes.get_title(loc="left") for axes in figure.axes][:3]
    ['1  Scan', '2  Floor plan', '3  Template, drift 0°']
    """
    if not len(heatmaps):
        raise InputError("heatmaps", expected="at least one drift", got="none")
    truth = None if truth_m is None else np.asarray(truth_m, dtype=np.float64)
    low, high = heatmaps.raster.plan.bounds_m
    aspect = float(np.clip((high[0] - low[0]) / max(high[1] - low[1], 1e-6), 0.6, 2.0))
    figure = new_figure(14.0, 3.3 + 2.9 / aspect)
    halves = figure.add_gridspec(1, 2, width_ratios=(1.8, 1.0))
    rows = GridSpecFromSubplotSpec(2, 12, subplot_spec=halves[0])
    shown, scores = _four_maps(heatmaps)
    best = max(range(len(shown)), key=lambda i: float(scores[i].max()))
    _scan_panel(figure.add_subplot(rows[0, :4]), heatmaps.scan)
    _plan_panel(figure.add_subplot(rows[0, 4:8]), heatmaps, truth)
    _template_panel(figure, figure.add_subplot(rows[0, 8:]), heatmaps, shown[best])
    panels = [figure.add_subplot(rows[1, 3 * i : 3 * i + 3]) for i in range(len(shown))]
    _heatmap_panels(figure, panels, heatmaps, (shown, scores))
    _particles_panel(figure.add_subplot(halves[1]), candidates, (particles, truth, heatmaps))
    for axes in figure.axes:
        axes.set_anchor("S" if axes in panels else "N")
    return figure


def draw_scan(axes: Axes, walls_m: FloatArray, colour: str = SCAN, width: float = 2.6) -> None:
    """Draw the walls (N, 2, 2) of a scan, in the frame of the axes."""
    axes.add_collection(
        LineCollection(
            list(walls_m), colors=colour, linewidths=width, capstyle="round", zorder=5, gid="scan"
        ),
        autolim=False,
    )


def _scan_panel(axes: Axes, scan: Scan) -> None:
    """Draw what the scanner saw around the observation point, with circles of range."""
    walls = scan.relative_m
    reach = _reach_m(scan)
    frame_map(axes, (-reach, -reach), (reach, reach))
    for radius in _RINGS_M:
        axes.add_patch(
            Circle(
                (0, 0), radius, fill=False, edgecolor=MUTED, linewidth=0.6, linestyle=(0, (2, 3))
            )
        )
        if radius == min(_RINGS_M):
            continue  # no room for words
        at = radius * np.sqrt(0.5)
        axes.text(at, -at, f"{radius:g} m", fontsize=7, color=MUTED, ha="center", va="center",
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6})  # fmt: skip
    draw_scan(axes, walls)
    axes.plot([0], [0], marker="o", markersize=5, color=INK, zorder=6)
    axes.set_title("1  Scan")


def _reach_m(scan: Scan) -> float:
    return 1.04 * max(float(np.linalg.norm(scan.relative_m, axis=-1).max()), _RINGS_M[-1])


def _plan_panel(axes: Axes, heatmaps: ScoreMaps, truth: FloatArray | None) -> None:
    plan = heatmaps.raster.plan
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.5)
    if truth is not None:
        truth_mark(axes, *truth)
    axes.set_title("2  Floor plan")


def _template_panel(figure: Figure, axes: Axes, heatmaps: ScoreMaps, k: int) -> None:
    """RW - alpha * CES at the scale of the scan: walls wanted, and walls not wanted."""
    template, cell = heatmaps.template(k), heatmaps.grid.cell_size_m
    reach = _reach_m(heatmaps.scan)
    frame_map(axes, (-reach, -reach), (reach, reach))
    limits = axes.get_xlim(), axes.get_ylim()
    bound = float(np.abs(template.values).max()) or 1.0
    left, bottom = (-(a + 0.5) * cell for a in template.anchor[::-1])
    rows, columns = template.values.shape
    image = axes.imshow(
        template.values, origin="lower", cmap="PuOr", vmin=-bound, vmax=bound,
        extent=(left, left + columns * cell, bottom, bottom + rows * cell),
        interpolation="nearest",
    )  # fmt: skip
    axes.contourf(
        (np.arange(columns) + 0.5) * cell + left, (np.arange(rows) + 0.5) * cell + bottom,
        template.values, levels=[-2 * bound, -_HATCHED * bound], colors="none", hatches=["//////"],
    )  # fmt: skip
    axes.set(xlim=limits[0], ylim=limits[1])
    axes.plot([0], [0], marker="o", markersize=5, color=INK)
    bar = figure.colorbar(image, ax=axes, shrink=0.7, aspect=14, pad=0.01, anchor=(0.0, 0.75))
    bar.set_ticks([-bound, 0.0, bound])
    bar.set_ticklabels([f"{-bound:.2g} empty".replace("-", "−"), "0", f"{bound:.2g} wall"])
    bar.ax.tick_params(labelsize=7.5, length=2)
    bar.outline.set_visible(False)
    axes.set_title(f"3  Template, drift {degrees(template.drift_rad)}")


def _four_maps(heatmaps: ScoreMaps) -> tuple[list[int], list[npt.NDArray[np.float32]]]:
    """Return index and scores of the best drift of each style, in the order of the styles."""
    index = np.arange(len(heatmaps))
    style = groups_of(index, heatmaps.drifts_rad, by_label=len(heatmaps) <= len(GROUPS))
    best: dict[int, tuple[int, npt.NDArray[np.float32]]] = {}
    for k in index:
        scores, group = heatmaps.scores(int(k)), int(style[k])
        if group not in best or scores.max() > best[group][1].max():
            best[group] = int(k), scores
    chosen = [best[group] for group in sorted(best)]
    return [k for k, _ in chosen], [scores for _, scores in chosen]


def _heatmap_panels(
    figure: Figure,
    panels: Sequence[Axes],
    heatmaps: ScoreMaps,
    shown: tuple[list[int], list[npt.NDArray[np.float32]]],
) -> None:
    """Heatmaps on one scale, each framed in the colour of its drift."""
    drifts, every = heatmaps.drifts_rad, shown[1]
    styles = groups_of(np.array(shown[0]), drifts[shown[0]], by_label=len(drifts) <= len(GROUPS))
    top = max(float(scores.max()) for scores in every)
    low = 0.0 if top > 0 else min(float(scores.min()) for scores in every)
    for i, (axes, scores) in enumerate(zip(panels, every, strict=True)):
        image = _heatmap_panel(axes, heatmaps, scores, (low, top if top > low else low + 1))
        _frame(axes, GROUPS[styles[i]])
        number = "4  Heatmaps\n" if i == 0 else "\n"
        axes.set_title(f"{number}drift {degrees(float(drifts[shown[0][i]]))}")
    bar = figure.colorbar(
        image, ax=list(panels), location="bottom", shrink=0.5, aspect=40, pad=0.03, extend="min"
    )
    bar.set_label("score", fontsize=8)
    bar.ax.tick_params(labelsize=7.5, length=2)
    bar.outline.set_visible(False)


def _heatmap_panel(
    axes: Axes, heatmaps: ScoreMaps, scores: npt.NDArray[np.float32], limits: tuple[float, float]
) -> AxesImage:
    """One map, its best cell circled."""
    low, high = heatmaps.raster.plan.bounds_m
    frame_map(axes, low, high)
    for scale_bar in [*axes.lines, *axes.texts]:
        scale_bar.set(color="white", path_effects=[])
    left, right, bottom, top = heatmaps.grid.extent_m()
    image = axes.imshow(
        _shrunk(scores), origin="lower", extent=(left, right, bottom, top), cmap="inferno",
        vmin=limits[0], vmax=limits[1], interpolation="nearest", zorder=1, aspect="auto",
    )  # fmt: skip
    (x0, x1), (y0, y1) = _map_limits(low, high)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), facecolor=image.get_cmap()(0.0))
    axes.set_aspect("equal")
    draw_plan(axes, heatmaps.raster.plan, 0.22, colour="#8d8d8d")
    cell = np.unravel_index(int(scores.argmax()), scores.shape)
    x, y = heatmaps.grid.position_of(cell)
    axes.plot([x], [y], marker="o", markersize=9, markerfacecolor="none", markeredgecolor="white",
              markeredgewidth=1.2, zorder=6, gid="best")  # fmt: skip
    return image


def _map_limits(low: FloatArray, high: FloatArray) -> tuple[tuple[float, float], ...]:
    size = float(max(high - low))
    return (
        (float(low[0]) - 0.03 * size, float(high[0]) + 0.03 * size),
        (float(low[1]) - 0.115 * size, float(high[1]) + 0.03 * size),
    )


def _frame(axes: Axes, style: GroupStyle) -> None:
    """Frame axes in a group's colour, with its marker in the upper right corner."""
    axes.spines[:].set(visible=True, color=style.colour, linewidth=3.0)
    figure = axes.get_figure(root=True)
    assert figure is not None
    above = ScaledTranslation(-5 / 72, 9 / 72, figure.dpi_scale_trans)
    axes.plot(
        [1.0], [1.0], marker=style.marker, markersize=7, color=style.colour,
        transform=axes.transAxes + above, clip_on=False, gid="group",
    )  # fmt: skip


def _shrunk(scores: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Fewer cells, each the best of those it stands for, so that no peak is lost."""
    block = -(-max(scores.shape) // _PIXELS)
    if block == 1:
        return scores
    pad = [(0, -n % block) for n in scores.shape]
    padded = np.pad(scores, pad, constant_values=float(scores.min()))
    rows, columns = (n // block for n in padded.shape)
    best: npt.NDArray[np.float32] = padded.reshape(rows, block, columns, block).max(axis=(1, 3))
    return best


def named_guesses(candidates: Candidates | Posterior) -> str:
    """Return what a method keeps of a scan, in words."""
    return "candidate cells" if isinstance(candidates, Candidates) else "poses"


def _particles_panel(
    axes: Axes,
    candidates: Candidates | Posterior,
    start: tuple[Particles | None, FloatArray | None, ScoreMaps],
) -> None:
    particles, truth, heatmaps = start
    plan = heatmaps.raster.plan
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.6, colour="#9a9a9a")
    by_label = len(candidates.drifts_rad) <= len(GROUPS)
    if particles is None:
        chosen = by_weight(np.exp(candidates.log_weight), _PARTICLES)
        position, label = candidates.position_m[chosen], candidates.label[chosen]
        drift, word = candidates.drift_rad[chosen], named_guesses(candidates)
    else:
        chosen = by_weight(particles.weight, _PARTICLES)
        position, label = particles.position_m[chosen], particles.label[chosen]
        drift, word = particles.drift_rad[chosen], "particles"
    group = groups_of(label, drift, by_label)
    draw_particles(axes, position, group, 3.0)
    entries = group_entries(np.unique(group))
    for k, entry in zip(np.unique(group), entries, strict=True):
        mine = drift[group == k]
        share = f"{100 * len(mine) / len(group):.0f} %"
        named = degrees(float(mine[0])) if by_label else f"around {degrees(k * np.pi / 2)}"
        entry.set_label(f"drift {named}: {share}")
    if truth is not None:
        truth_mark(axes, *truth)
        entries.append(truth_entry())
    axes.set_title(f"5  {len(group):,} {word}")
    axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2)
