"""Particles: start, move, meet walls, resample (paper III-C)."""

from palms.particles.draws import effective_sample_size, resample_systematic, reweight, thin
from palms.particles.moves import MoveInfo, advance
from palms.particles.particles import Particles
from palms.particles.starts import any_drift, start_everywhere, start_from, with_scales

__all__ = [
    "MoveInfo",
    "Particles",
    "advance",
    "any_drift",
    "effective_sample_size",
    "resample_systematic",
    "reweight",
    "start_everywhere",
    "start_from",
    "thin",
    "with_scales",
]
