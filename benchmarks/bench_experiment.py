"""The paper's experiment: 14 walks x 100 trials x (uniform, uniform-ori, paper), two cores."""

import tempfile
import time
from pathlib import Path

from benchmarks.harness import Case
from benchmarks.simulated.steps import palms
from benchmarks.simulated.studies import FLOORS

METHODS = "uniform,uniform-ori,paper"


def cases() -> list[Case]:
    return [
        Case("14 walks x 100 trials x 3 methods, two cores", minutes, 2.0, unit="min"),
    ]


def minutes() -> float:
    """Simulate the floors, then time the command."""
    dataset = FLOORS
    with tempfile.TemporaryDirectory() as folder:
        palms(dataset.words(), Path(folder))
        words = ["palms", "bench", dataset.name, "--methods", METHODS, "--trials", "100"]
        start = time.perf_counter()
        palms([*words, "--jobs", "2", "--out", "results"], Path(folder))
        return (time.perf_counter() - start) / 60
