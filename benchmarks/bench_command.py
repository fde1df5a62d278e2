"""Commands as a user starts them, caches warm: whole processes."""

import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from time import perf_counter as wall

from benchmarks.harness import Case
from palms.sample import sample_folder

HEAVY = "import numpy, scipy.fft, numba, shapely"
PEAK = (
    "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, "
    "stdout=subprocess.DEVNULL); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
)


@cache
def environment() -> dict[str, str]:
    """With Python's own cache, too, wherever that of the installation may be."""
    kept = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    return kept | {"PYTHONPYCACHEPREFIX": str(Path(tempfile.gettempdir()) / "palms-bench-pyc")}


def run(*words: str) -> str:
    command = [sys.executable, *words]
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment())
    return done.stdout


def peak_mb(*words: str) -> float:
    """Peak memory of a process with these words."""
    return int(run("-c", PEAK, sys.executable, *words)) * 1024 / 1e6


def cases() -> list[Case]:
    folder = sample_folder()
    walk = next((folder / "trajectories").glob("*/*/*.json"))
    session = next(walk.parent.glob("Session_*"))
    plan = next((folder / "maps").glob("*.csv"))
    track = ("-m", "palms", "track", str(plan), str(session), str(walk))
    return [
        Case("palms --help", lambda: run("-m", "palms", "--help"), 300.0,
             lambda: run("-c", "import numpy"), "import numpy", clock=wall),
        Case("palms track on the sample, 400 walls", lambda: run(*track), 1000.0,
             lambda: run("-c", HEAVY), "importing numpy, scipy.fft, numba, shapely",
             clock=wall),
        Case("its peak memory", lambda: peak_mb(*track), 200.0, unit="MB"),
    ]  # fmt: skip
