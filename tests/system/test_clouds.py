"""Real clouds of phones' LiDAR, where the public data is at hand (PALMS_DATA or ../shared/data)."""

import os
import warnings
from pathlib import Path

import numpy as np
import pytest

from palms.errors import PalmsWarning
from palms.geometry import directions, lengths
from palms.io import read_scan

ROOT = Path(__file__).resolve().parents[2]
CLOUDS = Path(os.environ.get("PALMS_DATA") or ROOT / ".." / "shared" / "data") / "lidar_clouds"

pytestmark = pytest.mark.skipif(
    not CLOUDS.is_dir(), reason=f"the clouds are not in {CLOUDS} (set PALMS_DATA)"
)


def walls_of(name):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PalmsWarning)
        return read_scan(CLOUDS / f"{name}.npz").walls_m


@pytest.mark.parametrize("name", ["pix4d_database_430_db", "pix4d_database_470_db"])
def test_the_walls_of_a_room_run_two_ways(name):
    walls = walls_of(name)
    length = lengths(walls)
    assert 18 < length.sum() < 28
    assert (length > 3).sum() >= 3
    main = directions(walls)[length.argmax()]
    off = np.abs(np.mod(directions(walls) - main + np.pi / 4, np.pi / 2) - np.pi / 4)
    assert length[off < np.deg2rad(4)].sum() > 0.85 * length.sum()


@pytest.mark.parametrize("name", ["pix4d_user_560_user", "user_808-60"])
def test_ceilings_and_pipes_are_hardly_walls(name):
    assert len(walls_of(name)) <= 3
