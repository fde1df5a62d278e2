"""Recordings: sessions that their walkers had recorded, as JSON, as tracks, as data sets."""

from __future__ import annotations

import io
import json
import re
import struct
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palms.building import named_stairs
from palms.errors import InputError
from palms.floorplan import FloorPlan, Room
from palms.hints import Hint
from palms.io import Event, write_case, write_events, write_plan
from palms.io.events import EVENTS_FILE
from palms.io.walk import RecordedWalk
from palms.odometry import Move, Odometry
from palms.server import messages
from palms.server.floor import ALL, Floor
from palms.server.follower import START_SURE, Follower
from palms.server.pictures import heatmap_frames, particles_frame
from palms.server.plans import building_of
from palms.server.store import Levels, SessionRow

__all__ = ["dataset_zip", "recording_document", "recording_frames", "recording_track"]

Inputs = list[tuple[int, float, str]]
SCHEMA = "palms-recording/1"
MOST_PARTICLES = 1000  # ours: of a frame
MOST_FRAMES = 2000  # ours: of a recording; together at most 10 MB
_LENGTH = struct.Struct("<I")


def recording_document(row: SessionRow, inputs: Inputs) -> dict[str, Any]:
    """Return a recording as JSON: its inputs as the phone sent them."""
    return {
        "schema": SCHEMA,
        "recording": row.id,
        "building": row.building,
        "level": row.level or None,
        "start_level": row.terms.start_level,
        "method": row.terms.method,
        "particles": row.terms.particles,
        "seed": row.terms.seed,
        "source": row.terms.source,
        "frame": row.terms.frame,
        "created_s": row.created_s,
        "ended_s": row.ended_s,
        "inputs": [
            {"received_s": received_s, "message": json.loads(text)}
            for _, received_s, text in inputs
        ],
    }


def recording_track(row: SessionRow, inputs: Inputs, levels: Levels) -> dict[str, Any]:
    """Follow a recording again; return its estimates and events.

    Parameters
    ----------
    row : SessionRow
    inputs : list of (int, float, str)
    levels : tuple of (str, str)
        Names and plans of the levels that it walked on.
    """
    follower = _follower(row, levels)
    estimates, events = [], []
    for _, _, text in inputs:
        message = messages.parse_input(text)
        outcome = follower.apply(message)
        estimates.append(outcome.estimate.model_dump())
        events += [{"kind": kind, "seq": message.seq, "t_s": t_s} for kind, t_s in outcome.events]
    return {
        "schema": "palms-replay/1", "recording": row.id, "building": row.building,
        "level": row.level or None, "plan": json.loads(levels[0][1]),
        "plans": [json.loads(text) | {"level": name} for name, text in levels],
        "estimates": estimates, "events": events,
    }  # fmt: skip


def recording_frames(row: SessionRow, inputs: Inputs, levels: Levels) -> bytes:
    """Follow a recording again; return its particles and heatmaps.

    Returns
    -------
    bytes
        Binary frames as viewers get them, each after its length, a little-endian uint32. Of
        long recordings not every input has its particles.
    """
    follower = _follower(row, levels)
    every = -(-len(inputs) // MOST_FRAMES)
    frames = []
    for index, (_, _, text) in enumerate(inputs):
        message = messages.parse_input(text)
        outcome = follower.apply(message)
        belief, seq = follower.localizer.belief, message.seq
        if outcome.scan is not None:
            frames += heatmap_frames(follower.floor, outcome.scan, follower.settings, seq)
        if belief is not None and (index % every == 0 or outcome.scan is not None):
            when, atlas = (seq, outcome.estimate.t_s), follower.localizer.atlas
            frames.append(particles_frame(belief.particles, when, MOST_PARTICLES, atlas))
    return b"".join(part for frame in frames for part in (_LENGTH.pack(len(frame)), frame))


def _follower(row: SessionRow, levels: Levels) -> Follower:
    floor = Floor.of(building_of(levels), None if row.level == ALL else row.level)
    return Follower(floor, row.terms)


def dataset_zip(row: SessionRow, inputs: Inputs, levels: Levels) -> bytes:
    """Return a recording as a zipped data set folder.

    Raises
    ------
    InputError
        When it has no scan, or fewer than two moves.
    """
    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        write_dataset(Path(folder), row, inputs, levels)
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(Path(folder).rglob("*")):
                if path.is_file():
                    archive.write(path, path.relative_to(folder))
    return out.getvalue()


def write_dataset(folder: Path, row: SessionRow, inputs: Inputs, levels: Levels) -> Path:
    """Write a recording as a data set; return the folder of its walk.

    The walk starts where its first scan was taken, and ends where its frame was new. Hints
    and changes of the level become events.
    """
    moves, scans, events = _told(row, inputs, levels)
    if not scans or len(moves) < 2:
        raise InputError(
            "recording", expected="a scan and at least two moves after it",
            got=f"{len(scans)} scans and {len(moves)} moves", fix="record a whole walk",
        )  # fmt: skip
    kind: Any = row.terms.source
    frame: Any = row.terms.frame
    places = np.cumsum([(move.dx_m, move.dy_m) for move in moves], axis=0)
    session = row.id
    odometry = Odometry(
        np.array([move.time_s for move in moves]),
        places,
        frame=frame,
        source=kind,
        session=(session,),
    )
    for plan in _drawings(levels, row.building):
        write_plan(folder, plan)
    walk = write_case(
        folder, row.building, f"live-{session}", RecordedWalk.of(odometry),
        [replace(scan, session=session) for scan in scans],
    )  # fmt: skip
    if events:
        write_events(events, walk / EVENTS_FILE)
    return walk


def _drawings(levels: Levels, name: str) -> list[FloorPlan]:
    """Return plans named as a data set has them; stairs are rooms that are called so."""
    building = building_of(levels)
    known = {each.name for plan in building.levels for each in named_stairs(plan)}
    rooms = tuple(
        Room(f"Stairs {each.name}", each.polygon_m)
        for each in building.stairs
        if each.name not in known
    )
    lowest, *others = (
        replace(plan, rooms=(*plan.rooms, *rooms), name=name) for plan in building.levels
    )
    return [lowest, *(replace(each, name=f"{name}-level-{_plain(each)}") for each in others)]


def _plain(plan: FloorPlan) -> str:
    """Return the name of a level as a file can have it; the file's content says the true one."""
    return re.sub(r"[^\w.+-]", "_", plan.level or "")


def _told(
    row: SessionRow, inputs: Inputs, levels: Levels
) -> tuple[list[Move], list[Any], list[Event]]:
    """Return the moves, scans and hints of a recording, in the frame of its first scan."""
    follower = _follower(row, levels)
    moves: list[Move] = []
    follower.watch = moves.append
    scans: list[Any] = []
    start = row.terms.start_level
    events = [] if start is None else [Event(0.0, "hint", level=start, probability=START_SURE)]
    start_m = np.zeros(2)
    for _, _, text in inputs:
        message = messages.parse_input(text)
        if scans and isinstance(message, messages.Resume) and not message.same_frame:
            break
        outcome = follower.apply(message)
        if outcome.scan is not None:
            if not scans:
                start_m = outcome.scan.position_m
                moves.clear()
            offset_s = follower.intake.offset_s or 0.0
            scan = replace(
                outcome.scan, walls_m=outcome.scan.walls_m - start_m,
                position_m=outcome.scan.position_m - start_m,
                time_s=outcome.scan.time_s - offset_s,
            )  # fmt: skip
            scans.append(scan)
        elif outcome.hint is not None:
            is_change = isinstance(message, messages.LevelChange)
            events.append(_event(outcome.hint, follower.intake.time_s, is_change))
    return moves, scans, events


def _event(hint: Hint, time_s: float, is_change: bool) -> Event:
    if is_change:
        return Event(time_s, "level", level=hint.level, probability=hint.probability)
    x_y = None if hint.place_m is None else (float(hint.place_m[0]), float(hint.place_m[1]))
    return Event(
        time_s, "hint", room=hint.room, position_m=x_y, level=hint.level,
        radius_m=None if x_y is None else hint.radius_m, probability=hint.probability,
    )  # fmt: skip
