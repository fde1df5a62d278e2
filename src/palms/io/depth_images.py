"""What folders of depth images of any app have in common: how many are read, lens and pixels."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from palms.errors import InputError, PalmsWarning
from palms.extraction import DepthFrame, ExtractionSettings, scan_from_depth
from palms.geometry import FloatArray
from palms.io.planes import session_of
from palms.io.point_clouds import parse_metres, parse_position
from palms.io.values import StrPath, brief, locating
from palms.scan import Scan

__all__ = ["MAX_FRAMES", "DepthOptions", "depth_scan", "evenly", "pixel_size", "report_left_out"]

MAX_FRAMES = 150  # ours: of more, every so manieth is read
_IMAGES = ((1920, 1440), (1280, 960), (640, 480), (3840, 2880), (1920, 1080), (1280, 720))


class DepthOptions(NamedTuple):
    """What a user may say of depth images.

    Attributes
    ----------
    position : (x, y), str or None
        The observation point on the ground.
    floor : float, str or None
        Height of the floor.
    settings : ExtractionSettings or None
    """

    position: object = None
    floor: object = None
    settings: ExtractionSettings | None = None


def depth_scan(frames: Sequence[DepthFrame], path: StrPath, options: DepthOptions) -> Scan:
    """Make a scan of depth images: walls, and the space that depth rays prove empty.

    Parameters
    ----------
    frames : sequence of DepthFrame
    path : path
        The folder, for messages and the session's name.
    options : DepthOptions

    Raises
    ------
    InputError
        When an option is wrong, or the images show no wall.
    """
    with locating(path):
        here, floor_m = parse_position(options.position), parse_metres(options.floor, "floor")
        scan = scan_from_depth(frames, here, options.settings, floor_m=floor_m)
        return Scan(scan.walls_m, scan.position_m, scan.coverage_m, session=session_of(path))


def evenly(count: int, most: int = MAX_FRAMES) -> list[int]:
    """Return the indices of at most so many of a sequence, spread evenly.

    Examples
    --------
    >>> evenly(3), evenly(10, 4)
    ([0, 1, 2], [0, 3, 6, 9])
    """
    step = max(1, math.ceil(count / most))
    return list(range(0, count, step))


def report_left_out(images: int, used: int, lacking: str, path: StrPath) -> None:
    """Warn of depth images that lack something, such as "no pose", when there are any."""
    if used < images:
        warnings.warn(
            f"{path}: {images - used} of {images} depth images have {lacking} and are left out",
            PalmsWarning,
            stacklevel=4,
        )


def pixel_size(lens: FloatArray, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Focal lengths and principal point (2,), (2,) for a depth image.

    Parameters
    ----------
    lens : ndarray (3, 3)
        Intrinsics of the colour image, by rows or by columns, whose principal point tells
        how large that is.
    shape : (h, w)
        Of the depth image.

    Examples
    --------
    >>> lens = np.array([[1440.0, 0, 960], [0, 1440, 720], [0, 0, 1]])
    >>> focal, centre = pixel_size(lens, (192, 256))
    >>> focal.tolist(), centre.round(2).tolist()
    ([192.0, 192.0], [127.57, 95.57])
    """
    if abs(lens[2, 0]) > 1 and abs(lens[0, 2]) <= 1:
        lens = lens.T
    focal, centre = lens[[0, 1], [0, 1]], lens[:2, 2]
    height, width = shape
    if (focal <= 0).any() or (centre <= 0).any() or abs(lens[2, 2] - 1) > 0.01:
        raise InputError(
            "camera intrinsics", expected="rows [fx 0 cx], [0 fy cy], [0 0 1] in pixels",
            got=brief(lens.tolist(), 60),
        )  # fmt: skip
    sizes = np.array([(width, height), *_IMAGES], float)
    off = np.abs(np.log(2 * centre / sizes)).sum(axis=1)
    image = sizes[off.argmin()]
    if off.min() > 0.3:
        raise InputError(
            "camera intrinsics", expected="a principal point in the middle of a known image",
            got=f"{centre.tolist()}",
        )  # fmt: skip
    scale = np.array([width, height]) / image
    return np.asarray(focal * scale), np.asarray((centre + 0.5) * scale - 0.5)
