"""One step of the paper's filter: move, walls, weights, resample."""

from benchmarks import naive
from benchmarks.harness import Case
from benchmarks.populations import KEY, MOVE, settled, spread
from benchmarks.world import raster
from palms.particles import advance
from palms.settings import MotionSettings

BUDGET_NS = 60.0  # a particle, in large populations


def cases() -> list[Case]:
    plan, motion, move = raster(), MotionSettings(), (MOVE.dx_m, MOVE.dy_m)
    return [
        Case(
            f"step of {len(particles):,} particles, {name}",
            lambda p=particles: advance(p, MOVE, plan, motion, KEY), goal,
            lambda p=particles: naive.step(p.position_m, p.drift_rad, move, plan.walls.segments),
            "naive numba, all walls",
        )
        for name, goal, particles in (
            ("spread", 0.1, spread(2000)),
            ("settled", 0.1, settled(2000)),
            ("spread", BUDGET_NS * 0.2, spread(200_000)),
        )
    ]  # fmt: skip
