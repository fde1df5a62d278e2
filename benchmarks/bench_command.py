"""Commands as a user starts them, caches warm: whole processes."""

import subprocess
import sys

from benchmarks.harness import Case


def run(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "palms", *words], check=True, capture_output=True)


def cases() -> list[Case]:
    from palms.sample import sample_folder

    folder = sample_folder()
    walk = next((folder / "trajectories").glob("*/*/*.json"))
    session = next(walk.parent.glob("Session_*"))
    plan = next((folder / "maps").glob("*.csv"))
    return [
        Case("palms --help", lambda: run("--help"), 300.0),
        Case("palms track on the sample", lambda: run("track", str(plan), str(session), str(walk))),
    ]
