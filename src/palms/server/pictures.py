"""Pictures for viewers: particles and heatmaps as binary frames."""

from __future__ import annotations

import io
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from palms.building import Atlas
from palms.geometry import FloatArray
from palms.grid import Grid
from palms.heatmap import ScoreMaps, match, scan_drifts
from palms.observation import likelihoods
from palms.particles import Particles
from palms.scan import Scan
from palms.server.floor import Floor
from palms.server.messages.frames import (
    HeatmapFrame,
    ParticlesFrame,
    pack_heatmap,
    pack_particles,
)
from palms.settings import Settings

__all__ = ["heatmap_frames", "particles_frame"]

N_MAPS = 4  # ours: as many drifts as a building of right angles has
WIDEST_PX = 800  # ours: a screen shows no more
MARGIN_M = 2.0  # ours: around the walls of a level
SPAN_NATS = 14.0  # ours: what lies farther below the best is black


def particles_frame(
    particles: Particles, when: tuple[int, float], most: int, atlas: Atlas | None = None
) -> bytes:
    """Return at most so many particles as a frame, each as probable as its weight.

    Systematically drawn, from the middle of each stratum: nothing random that a viewer could
    change a session by.

    Parameters
    ----------
    particles : Particles
    when : (int, float)
        Sequence number of the input that they come after, and its time.
    most : int
    atlas : Atlas, optional
        Of a building of several levels, whose places they have.
    """
    n = min(most, len(particles))
    total = np.cumsum(particles.weight)
    picked = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
    picked = np.minimum(picked, len(particles) - 1)
    label = (particles.label[picked] % 256).astype(np.uint8)
    place = particles.position_m[picked]
    if atlas is None:
        return pack_particles(ParticlesFrame(*when, place, label))
    level = atlas.level_of(place).astype(np.uint8)
    frame = ParticlesFrame(*when, atlas.folded(place), label, level, len(atlas.names))
    return pack_particles(frame)


def heatmap_frames(floor: Floor, scan: Scan, settings: Settings, seq: int) -> list[bytes]:
    """Return the best maps of a scan as frames, the best first; of each level one."""
    raster = floor.raster
    maps: ScoreMaps
    if settings.start.source == "posterior":
        maps = likelihoods(scan, raster, settings.observation)
        low = SPAN_NATS / settings.observation.strength
    else:
        maps = match(scan, raster, scan_drifts(scan, raster, settings), settings.template)
        low = None
    best = sorted(range(len(maps)), key=lambda k: -float(maps.scores(k).max()))[:N_MAPS]
    top = float(maps.scores(best[0]).max())
    bottom = 0.0 if low is None else top - low
    span = (bottom, max(top, bottom + 1e-6))
    frames: list[bytes] = []
    for number, each in enumerate(best):
        frame = HeatmapFrame(
            seq, number, len(best), float(maps.drifts_rad[each]), (0.0, 0.0), 0.0, span, b"",
            label=each, n_labels=len(maps),
        )  # fmt: skip
        scores = maps.scores(each)
        frames += [pack_heatmap(one) for one in _of_levels(frame, scores, maps.grid, floor)]
    return frames


def _of_levels(
    frame: HeatmapFrame, scores: npt.NDArray[np.float32], grid: Grid, floor: Floor
) -> Iterator[HeatmapFrame]:
    """Cut the map of an atlas into those of its levels, each in the map's own frame."""
    if floor.building is None:
        yield _drawn(frame, scores, grid.origin_m, grid.cell_size_m)
        return
    atlas = floor.building.atlas
    low = np.min([plan.bounds_m[0] for plan in floor.building.levels], axis=0)
    high = np.max([plan.bounds_m[1] for plan in floor.building.levels], axis=0)
    for level, shift in enumerate(atlas.shift_m):
        begin = np.clip(grid.cell_of(low + shift - MARGIN_M), 0, grid.shape)
        end = np.clip(grid.cell_of(high + shift + MARGIN_M) + 1, 0, grid.shape)
        corner = grid.origin_m + begin[::-1] * grid.cell_size_m - shift
        sheet = scores[begin[0] : end[0], begin[1] : end[1]]
        of_level = frame._replace(level=level, n_levels=len(atlas.names))
        yield _drawn(of_level, sheet, corner, grid.cell_size_m)


def _drawn(
    frame: HeatmapFrame, scores: npt.NDArray[np.float32], origin_m: FloatArray, cell_size_m: float
) -> HeatmapFrame:
    k, span = max(1, -(-max(scores.shape) // WIDEST_PX)), frame.range_nats
    rows, columns = (-(-n // k) for n in scores.shape)
    padded = np.full((rows * k, columns * k), scores.min(), np.float32)
    padded[: scores.shape[0], : scores.shape[1]] = scores
    shown = padded.reshape(rows, k, columns, k).max(axis=(1, 3))
    grey = np.clip((shown - span[0]) / (span[1] - span[0]), 0, 1) * 255
    x, y = (float(v) for v in origin_m)
    png = _png(np.round(grey[::-1]).astype(np.uint8))
    return frame._replace(origin_m=(x, y), cell_size_m=k * cell_size_m, png=png)


def _png(grey: np.ndarray[tuple[int, int], np.dtype[np.uint8]]) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(grey, "L").save(out, "PNG", compress_level=3)
    return out.getvalue()
