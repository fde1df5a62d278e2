"""`python -m tests.voice.refresh`: two walks of the sample building, as the voice gets them.

Run it when the filter answers otherwise, or when the voice is meant to say something else; then
read the differences of walks.json.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from palms.building import Building
from palms.evaluation.simulation import (
    CaseSettings,
    make_site,
    sample_building,
    simulate_start,
    simulate_walk,
)
from palms.floorplan import FloorPlan
from palms.io import open_dataset
from palms.odometry import Odometry
from palms.sample import sample_folder
from palms.scan import Scan
from palms.voice import Moment, Narrator, Preferences, Surroundings, Voice
from palms.voice.recorded import follow_moments, spoken

FILE = Path(__file__).parent / "walks.json"
EVERY = 2  # moments that are kept
PREFERENCES = (Preferences(), Preferences(language="de", units="steps", directions="words"))


def recorded() -> tuple[FloorPlan, Scan, Odometry]:
    """The walk of the sample."""
    case = open_dataset(sample_folder()).cases[0]
    return case.plan(), case.scan(), case.walk().odometry()


def simulated() -> tuple[FloorPlan, Scan, Odometry]:
    """Another one, through rooms, whose phone knows where it looks."""
    site = make_site(Building((sample_building(),)), seed=3)
    settings = CaseSettings(rooms=True)
    case = simulate_walk(site, simulate_start(site, 0, [], settings), 0, settings)
    return site.drawings[0], case.scans[0], case.recorded.arkit


def rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 3)
    return [rounded(each) for each in value] if isinstance(value, list | tuple) else value


def moments_of(walk: tuple[FloorPlan, Scan, Odometry]) -> list[list[Any]]:
    plan, scan, odometry = walk
    moments = follow_moments(plan, scan, odometry)
    timed = list(zip(odometry.time_s.tolist(), moments, strict=True))[::EVERY]
    return [[round(time_s, 2), *map(rounded, asdict(each).values())] for time_s, each in timed]


def told(rows: list[list[Any]], plan: FloorPlan, preferences: Preferences) -> list[str]:
    """Return what is said, a line each."""
    moments = [moment(row[1:]) for row in rows]
    narrator = Narrator(Voice(Surroundings.of(plan), preferences))
    heard = spoken(narrator, moments, [row[0] for row in rows])
    return [
        f"{each.time_s:.1f} {each.saying.kind}: {each.saying.text} [{each.saying.details}]"
        for each in heard
    ]


def moment(values: list[Any]) -> Moment:
    return Moment(*(tuple(value) if isinstance(value, list) else value for value in values))


def main() -> None:
    content = {}
    for name, make in (("recorded", recorded), ("simulated", simulated)):
        walk = make()
        rows = moments_of(walk)
        says = [told(rows, walk[0], preferences) for preferences in PREFERENCES]
        content[name] = {"moments": rows, "told": says}
    lines = json.dumps(content, ensure_ascii=False).replace("], [", "],\n[")
    FILE.write_text(lines.replace('", "', '",\n"') + "\n")


if __name__ == "__main__":
    main()
