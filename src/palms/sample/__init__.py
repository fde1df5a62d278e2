"""The sample data set that the package ships: one floor, one scan, one walk."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

__all__ = ["sample_folder"]


def sample_folder() -> Path:
    """Return the folder of the sample data set, in the layout of any other data set.

    Returns
    -------
    Path
        It holds ``maps/sample.csv`` and ``trajectories/sample/walk-1``; and in ``phone`` a picture
        of the plan, the scan as RoomPlan captures it, and the walk as a log of camera poses.

    Examples
    --------
    >>> (sample_folder() / "maps" / "sample.csv").is_file()
    True
    """
    return Path(str(files(__name__) / "data"))
