"""Tracks in the TUM format, which trajectory tools such as evo read: ``t tx ty tz qx qy qz qw``.

Walks that we write say in a comment what the format has no place for: whether their frame is
the scan's, and what made them.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from palms.errors import PalmsWarning
from palms.io.files import sniff, write_text
from palms.io.options import choice_option, number_option
from palms.io.packed import text_head
from palms.io.pose_log import EVERY_S, GROUNDS, Ground, PoseLog, ground_walk
from palms.io.pose_table import Table, read_table
from palms.io.poses import pose_log
from palms.io.registry import Format
from palms.io.values import StrPath, parse_number
from palms.io.walk import RecordedWalk, WalkSource

if TYPE_CHECKING:
    from palms.localizer import Track

__all__ = ["FORMAT", "read_tum", "write_tum", "write_walk_tum"]

_COLUMNS = "timestamp tx ty tz qx qy qz qw"
HEADER = f"# {_COLUMNS}: s, m, map frame; z is 0\n"
_EXPECTED = f"a TUM trajectory: rows of {_COLUMNS}"
_UP: Final = {"z": "x,y", "y": "x,-z", "-y": "x,z"}
_FLAT = 0.5  # ours: who walks moves on the ground at least twice as far as up and down
_OURS = "palms walk"


def read_tum(
    path: StrPath,
    *,
    up: Literal["auto", "z", "y", "-y"] = "auto",
    frame: Literal["auto", "scan", "own"] = "auto",
    every_s: float | str = EVERY_S,
) -> RecordedWalk:
    r"""Read a TUM trajectory as a walk; it begins at the first pose.

    Parameters
    ----------
    path : path
        The file; may be packed by gzip.
    up : {"auto", "z", "y", "-y"}
        Which axis stands upright. z makes (x, y) the ground, y makes it (x, -z) as with
        ARKit and ARCore, -y (x, z) as with cameras whose y points down. auto: the one of z
        and y along which the walk moves least. (With a scan of the PALMS data set, whose
        ground is (-z, -x), read the file as the format "poses" instead.)
    frame : {"auto", "scan", "own"}
        Whether it is of the scan's session; auto: as the file says, the scan's when it says
        nothing.
    every_s : float
        Poses nearer in time are left out, except in files that PALMS wrote; 0 keeps them all.

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When its content is no trajectory; the message names the line.

    Warns
    -----
    PalmsWarning
        When it cannot be told which axis is up.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.tum", "0 0 0 1 0 0 0 1\n1 1 0 1 0 0 0 1\n2 1 1 1 0 0 0 1\n")
    ...     read_tum(f"{folder}/a.tum").odometry().position_m.tolist()
    [[1.0, 0.0], [1.0, 1.0]]
    """
    axis = choice_option(up, "up", ("auto", *_UP))
    whose = choice_option(frame, "frame", ("auto", "scan", "own"))
    every = number_option(every_s, "every_s", 0.0, 60.0)
    table = read_table(path, _EXPECTED)
    told = _told(table)
    log = pose_log(table, path, None, 0.0 if told else every)
    if whose == "auto":
        whose = told.get("frame", "scan")
    ground = GROUNDS[_UP[axis]] if axis != "auto" else _level_ground(log, path)
    ahead = "x" if told else "auto"
    walk = ground_walk(log, ground, "own" if whose == "own" else "scan", ahead, path)
    odometry = walk.odometry()
    if told.get("facing") == "no":
        odometry = replace(odometry, facing_rad=None)
    if told.get("source") == "inertial":
        odometry = replace(odometry, source="inertial")
    return RecordedWalk.of(odometry, path=Path(path))


def _told(table: Table) -> dict[str, str]:
    """Return what a file that we wrote says in its comments."""
    ours = next((line for line in table.comments if line.startswith(_OURS)), "")
    return dict(part.split("=", 1) for part in ours.split() if "=" in part)


def _level_ground(log: PoseLog, path: StrPath) -> Ground:
    spread = log.position_m.std(axis=0)
    upright = "z" if spread[2] <= spread[1] else "y"
    if min(spread[1:]) > _FLAT * max(spread[1:]):
        warnings.warn(
            f"{path}: {upright} is taken as upright, but the walk moves by {spread[1]:.2g} m along "
            f"y and {spread[2]:.2g} m along z; say which with the option up",
            PalmsWarning,
            stacklevel=3,
        )
    return GROUNDS[_UP[upright]]


def write_walk_tum(walk: RecordedWalk, path: StrPath, source: WalkSource | None = None) -> None:
    """Write a walk as a TUM trajectory, z up, in the frame of its odometry.

    The first row is the start. The rotation is about z by where the phone looked, else by the
    direction of travel.

    Parameters
    ----------
    walk : RecordedWalk
    path : path
        The file; replaced when it exists. Its folder must exist.
    source : {"arkit", "ronin"}, optional
        Which odometry, when it has two; the first when left out.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from palms import Odometry
    >>> walk = RecordedWalk.of(Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_walk_tum(walk, f"{folder}/walk.tum")
    ...     again = read_tum(f"{folder}/walk.tum").odometry()
    >>> again.time_s.tolist(), again.position_m.tolist()
    ([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]])
    """
    odometry = walk.odometry(source or walk.sources[0])
    looked = odometry.facing_rad
    x, y = odometry.displacements_m.T
    angles = np.arctan2(y, x) if looked is None else looked
    known = "no" if looked is None else "yes"
    lines = [
        f"# {_COLUMNS}: s, m, z is 0\n",
        f"# {_OURS} frame={odometry.frame} source={odometry.source} facing={known}\n",
        *([_line(0.0, odometry.start_m.tolist(), angles[0])] if odometry.time_s[0] > 0 else []),
    ]
    rows = zip(odometry.time_s.tolist(), odometry.position_m.tolist(), angles, strict=True)
    write_text(path, "".join([*lines, *(_line(*row) for row in rows)]))


def _line(time_s: float, position_m: list[float], angle_rad: float) -> str:
    (x, y), half = position_m, angle_rad / 2
    return f"{time_s:.6f} {x:.4f} {y:.4f} 0 0 0 {math.sin(half):.8f} {math.cos(half):.8f}\n"


def write_tum(track: Track, path: StrPath) -> None:
    """Write a track as a TUM trajectory: ``t x y 0 qx qy qz qw`` a line.

    Steps without an answer are left out. The rotation is about z by the heading, the direction
    of travel in the map; where nothing was walked yet there is none, and the rotation is that
    of heading 0.

    Parameters
    ----------
    track : Track
    path : path
        The file; replaced when it exists. Its folder must exist.

    Raises
    ------
    OutputError
        When it cannot be written; what was there before is still there.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from palms import Estimate, Stage, Track
    >>> from palms.io import read_text
    >>> answer = Estimate(1.0, Stage.LOCALIZED, np.array([2.0, 3.5]), np.pi / 2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_tum(Track(0, (Estimate(0.5), answer)), f"{folder}/track.tum")
    ...     print(read_text(f"{folder}/track.tum"), end="")
    # timestamp tx ty tz qx qy qz qw: s, m, map frame; z is 0
    1.000000 2.0000 3.5000 0 0 0 0.70710678 0.70710678
    """
    lines = []
    for estimate in track:
        if estimate.position_m is None:
            continue
        lines.append(
            _line(estimate.time_s, estimate.position_m.tolist(), estimate.heading_rad or 0.0)
        )
    write_text(path, HEADER + "".join(lines))


def _recognizes(path: Path) -> bool:
    """Whether the first row holds eight numbers between blanks."""
    start = text_head(path)
    if path.is_dir() or sniff(start) != "text":
        return False
    lines = start.decode("utf-8-sig", "replace").splitlines()
    rows = [line.split() for line in lines if line.strip() and not line.lstrip().startswith("#")]
    return bool(rows) and len(rows[0]) == 8 and all(parse_number(c) is not None for c in rows[0])


FORMAT = Format(
    name="tum",
    description="TUM trajectories: rows of t tx ty tz qx qy qz qw",
    suffixes=(".tum", ".txt"),
    recognizes=_recognizes,
    read=read_tum,
    write=write_walk_tum,
)
