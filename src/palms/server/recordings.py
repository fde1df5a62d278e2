"""Recordings: sessions that their walkers had recorded, as JSON, as tracks, as data sets."""

from __future__ import annotations

import io
import json
import struct
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import InputError
from palms.io import Event, write_case, write_events, write_plan
from palms.io.events import EVENTS_FILE
from palms.io.walk import RecordedWalk
from palms.odometry import Move, Odometry
from palms.raster import rasterize
from palms.server import messages
from palms.server.follower import Floor, Follower
from palms.server.naming import Namer
from palms.server.pictures import heatmap_frames, particles_frame
from palms.server.plans import plan_of
from palms.server.store import SessionRow

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
        "level": row.level,
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


def recording_track(row: SessionRow, inputs: Inputs, plan_text: str) -> dict[str, Any]:
    """Follow a recording again; return its estimates and events."""
    follower = _follower(row, plan_text)
    estimates, events = [], []
    for _, _, text in inputs:
        message = messages.parse_input(text)
        outcome = follower.apply(message)
        estimates.append(outcome.estimate.model_dump())
        events += [{"kind": kind, "seq": message.seq, "t_s": t_s} for kind, t_s in outcome.events]
    return {
        "schema": "palms-replay/1", "recording": row.id, "building": row.building,
        "level": row.level, "plan": json.loads(plan_text), "estimates": estimates,
        "events": events,
    }  # fmt: skip


def recording_frames(row: SessionRow, inputs: Inputs, plan_text: str) -> bytes:
    """Follow a recording again; return its particles and heatmaps.

    Returns
    -------
    bytes
        Binary frames as viewers get them, each after its length, a little-endian uint32. Of
        long recordings not every input has its particles.
    """
    follower = _follower(row, plan_text)
    every = -(-len(inputs) // MOST_FRAMES)
    frames = []
    for index, (_, _, text) in enumerate(inputs):
        message = messages.parse_input(text)
        outcome = follower.apply(message)
        belief, seq = follower.localizer.belief, message.seq
        if outcome.scan is not None:
            frames += heatmap_frames(follower.floor.raster, outcome.scan, follower.settings, seq)
        if belief is not None and (index % every == 0 or outcome.scan is not None):
            t_s = outcome.estimate.t_s
            frames.append(particles_frame(belief.particles, seq, t_s, MOST_PARTICLES))
    return b"".join(part for frame in frames for part in (_LENGTH.pack(len(frame)), frame))


def _follower(row: SessionRow, plan_text: str) -> Follower:
    plan = plan_of(plan_text)
    return Follower(Floor(rasterize(plan), Namer(plan), row.level), row.terms)


def dataset_zip(row: SessionRow, inputs: Inputs, plan_text: str) -> bytes:
    """Return a recording as a zipped data set folder.

    Raises
    ------
    InputError
        When it has no scan, or fewer than two moves.
    """
    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        write_dataset(Path(folder), row, inputs, plan_text)
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(Path(folder).rglob("*")):
                if path.is_file():
                    archive.write(path, path.relative_to(folder))
    return out.getvalue()


def write_dataset(folder: Path, row: SessionRow, inputs: Inputs, plan_text: str) -> Path:
    """Write a recording as a data set; return the folder of its walk.

    The walk starts where its first scan was taken. Hints become events.
    """
    plan = replace(plan_of(plan_text), name=row.building)
    moves, scans, events = _told(row, inputs, plan_text)
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
    write_plan(folder, plan)
    walk = write_case(
        folder, plan.name, f"live-{session}", RecordedWalk.of(odometry),
        [replace(scan, session=session) for scan in scans],
    )  # fmt: skip
    if events:
        write_events(events, walk / EVENTS_FILE)
    return walk


def _told(
    row: SessionRow, inputs: Inputs, plan_text: str
) -> tuple[list[Move], list[Any], list[Event]]:
    """Return the moves, scans and hints of a recording, in the frame of its first scan."""
    follower = _follower(row, plan_text)
    moves: list[Move] = []
    follower.watch = moves.append
    scans: list[Any] = []
    events: list[Event] = []
    start_m = np.zeros(2)
    for _, _, text in inputs:
        message = messages.parse_input(text)
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
        elif isinstance(message, messages.Hint):
            time_s = follower.intake.time_s
            events.append(
                Event(time_s, "hint", room=message.room, position_m=message.place_m,
                      radius_m=None if message.place_m is None else message.radius_m)
            )  # fmt: skip
    return moves, scans, events
