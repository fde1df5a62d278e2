"""Tracks in the TUM format, which trajectory tools such as evo read."""

from __future__ import annotations

import math

from palms.io.files import write_text
from palms.io.values import StrPath
from palms.localizer import Track

__all__ = ["write_tum"]

HEADER = "# timestamp tx ty tz qx qy qz qw: s, m, map frame; z is 0\n"


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
    >>> from palms import Estimate, Stage
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
        x, y = (float(v) for v in estimate.position_m)
        half = (estimate.heading_rad or 0.0) / 2
        qz, qw = math.sin(half), math.cos(half)
        lines.append(f"{estimate.time_s:.6f} {x:.4f} {y:.4f} 0 0 0 {qz:.8f} {qw:.8f}\n")
    write_text(path, HEADER + "".join(lines))
