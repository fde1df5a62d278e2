"""Pictures for viewers: particles and heatmaps as binary frames."""

from __future__ import annotations

import io
from collections.abc import Iterator

import numpy as np

from palms.heatmap import ScoreMaps, match, scan_drifts
from palms.observation import likelihoods
from palms.particles import Particles
from palms.raster import PlanRaster
from palms.scan import Scan
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
SPAN_NATS = 14.0  # ours: what lies farther below the best is black


def particles_frame(particles: Particles, seq: int, t_s: float, most: int) -> bytes:
    """Return at most so many particles as a frame, each as probable as its weight.

    Systematically drawn, from the middle of each stratum: nothing random that a viewer could
    change a session by.
    """
    n = min(most, len(particles))
    total = np.cumsum(particles.weight)
    picked = np.searchsorted(total, (np.arange(n) + 0.5) / n * total[-1])
    picked = np.minimum(picked, len(particles) - 1)
    label = (particles.label[picked] % 256).astype(np.uint8)
    return pack_particles(ParticlesFrame(seq, t_s, particles.position_m[picked], label))


def heatmap_frames(raster: PlanRaster, scan: Scan, settings: Settings, seq: int) -> list[bytes]:
    """Return the best maps of a scan as frames, the best first."""
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
    return [pack_heatmap(frame) for frame in _frames(maps, best, span, seq)]


def _frames(
    maps: ScoreMaps, best: list[int], span: tuple[float, float], seq: int
) -> Iterator[HeatmapFrame]:
    grid = maps.grid
    k = max(1, -(-max(grid.shape) // WIDEST_PX))
    for index, each in enumerate(best):
        scores = maps.scores(each)
        rows, columns = (-(-n // k) for n in scores.shape)
        padded = np.full((rows * k, columns * k), scores.min(), np.float32)
        padded[: scores.shape[0], : scores.shape[1]] = scores
        shown = padded.reshape(rows, k, columns, k).max(axis=(1, 3))
        grey = np.clip((shown - span[0]) / (span[1] - span[0]), 0, 1) * 255
        x, y = (float(v) for v in grid.origin_m)
        yield HeatmapFrame(
            seq, index, len(best), float(maps.drifts_rad[each]), (x, y),
            k * grid.cell_size_m, span, _png(np.round(grey[::-1]).astype(np.uint8)),
            each, len(maps),
        )  # fmt: skip


def _png(grey: np.ndarray[tuple[int, int], np.dtype[np.uint8]]) -> bytes:
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(grey, "L").save(out, "PNG", compress_level=3)
    return out.getvalue()
