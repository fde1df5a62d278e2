"""Scans from the folders of the app Stray Scanner: depth images and the camera's way."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.extraction import DepthFrame, ExtractionSettings
from palms.geometry import FloatArray
from palms.io.depth_images import (
    DepthOptions,
    depth_scan,
    evenly,
    pixel_size,
    report_left_out,
)
from palms.io.files import read_text
from palms.io.plane_geometry import read_matrices, read_pose
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array, locating, parse_number
from palms.scan import Scan

__all__ = ["FORMAT", "read_stray_scanner"]

GROUND = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # (x, -z) and y up
_LOOKS_AHEAD = np.diag([1.0, -1.0, -1.0])  # its camera has y down and z ahead
_MAX_PIXELS = 4_000_000  # ours: eighty times a phone's depth image
_SURE = 1  # ours: confidence 0 is left out


def read_stray_scanner(
    path: StrPath,
    *,
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read a folder of Stray Scanner: walls, and the space that depth rays prove empty.

    Parameters
    ----------
    path : path
        The folder with ``depth``, ``odometry.csv`` and ``camera_matrix.csv``.
    position : (x, y) or str, optional
        The observation point on the ground, (x, -z) of the session.
    floor, settings
        As in `palms.io.depth_folder.read_depth_folder`.

    Raises
    ------
    InputError
        When something cannot be read, or the images show no wall.
    """
    return depth_scan(_frames(Path(path)), path, DepthOptions(position, floor, settings))


def _frames(folder: Path) -> list[DepthFrame]:
    lens = _lens(folder / "camera_matrix.csv")
    poses = _poses(folder / "odometry.csv")
    images = {
        file.stem: file for file in (folder / "depth").iterdir() if file.suffix in (".png", ".npy")
    } if (folder / "depth").is_dir() else {}  # fmt: skip
    names = sorted(name for name in images if name in poses)
    if not names:
        raise InputError(
            str(folder), expected="depth images with a row each in odometry.csv",
            got=f"{len(images)} images, {len(poses)} rows, none matching",
        )  # fmt: skip
    report_left_out(len(images), len(names), "no row in odometry.csv", folder)
    frames = []
    for name in (names[i] for i in evenly(len(names))):
        depth = _depth(images[name], folder / "confidence" / f"{name}.png")
        with locating(folder / "camera_matrix.csv"):
            focal, centre = pixel_size(lens, depth.shape)
        frames.append(DepthFrame(depth, focal, centre, poses[name]))
    return frames


def _lens(path: Path) -> FloatArray:
    rows = list(csv.reader(read_text(path, "a 3x3 matrix").splitlines()))
    return check_array(
        [[parse_number(cell) for cell in row] for row in rows if row], str(path), (3, 3)
    )


def _poses(path: Path) -> dict[str, FloatArray]:
    """Camera to ground (4, 4) by the number of the frame; columns are found by the header."""
    rows = list(csv.reader(read_text(path, "odometry").splitlines(), skipinitialspace=True))
    header = [cell.strip() for cell in rows[0]]
    needed = ["frame", "x", "y", "z", "qx", "qy", "qz", "qw"]
    if not set(needed) <= set(header):
        raise FormatError(
            f"{path} line 1", expected=f"columns {', '.join(needed)}", got=brief(", ".join(header))
        )
    at = [header.index(name) for name in needed]
    names, written, lines = [], [], []
    for number, row in enumerate(rows[1:], start=2):
        if not row:
            continue
        what = f"{path} line {number}"
        cells = [row[i] if i < len(row) else "" for i in at]
        numbers = [parse_number(cell) for cell in cells[1:]]
        if None in numbers:
            raise FormatError(what, expected="numbers", got=brief(",".join(row)))
        pose = {"position": numbers[:3], "orientation": numbers[3:]}
        written.append(read_pose(pose, what))
        names.append(cells[0].strip())
        lines.append(what)
    matrices = read_matrices(written, lines) if written else np.empty((0, 4, 4))
    grounded = np.tile(np.eye(4), (len(names), 1, 1))
    grounded[:, :3, :3] = GROUND @ matrices[:, :3, :3] @ _LOOKS_AHEAD
    grounded[:, :3, 3] = matrices[:, :3, 3] @ GROUND.T
    return dict(zip(names, grounded, strict=True))


def _depth(path: Path, confidence: Path) -> FloatArray:
    """Depth (h, w) in metres; 0 where it is unknown or not to be trusted."""
    metres = (_npy(path) if path.suffix == ".npy" else _pixels(path)) / 1000
    if confidence.is_file():
        level = _pixels(confidence)
        if level.shape != metres.shape:
            raise FormatError(
                str(confidence), expected=f"shape {metres.shape}", got=f"shape {level.shape}"
            )
        metres = np.where(level >= _SURE, metres, 0.0)
    return metres


def _npy(path: Path) -> npt.NDArray[np.float64]:
    """Depth of older recordings: an array of millimetres."""
    try:
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError, SyntaxError) as error:
        raise FormatError(str(path), expected="an array", got=brief(str(error), 60)) from None
    if array.ndim != 2 or array.size > _MAX_PIXELS or array.dtype.kind not in "fiu":
        raise FormatError(
            str(path), expected="a depth image", got=f"{array.dtype} of shape {array.shape}"
        )
    return np.nan_to_num(np.asarray(array, dtype=np.float64), posinf=0.0, neginf=0.0)


def _pixels(path: Path) -> npt.NDArray[np.float64]:
    """Grey values (h, w) of a PNG."""
    from PIL import Image

    try:
        with Image.open(path, formats=["PNG"]) as image:
            if image.width * image.height > _MAX_PIXELS or len(image.getbands()) != 1:
                raise FormatError(
                    str(path), expected=f"one channel, at most {_MAX_PIXELS} pixels",
                    got=f"{image.width} x {image.height}, {image.mode}",
                )  # fmt: skip
            return np.array(image, dtype=np.float64)
    except FormatError:
        raise
    except Exception as error:  # pillow raises many kinds for damaged images
        raise FormatError(
            str(path), expected="a PNG image of depth", got=brief(str(error), 60)
        ) from None


def _recognizes(path: Path) -> bool:
    return path.is_dir() and all(
        (path / name).exists() for name in ("depth", "odometry.csv", "camera_matrix.csv")
    )


FORMAT = Format(
    name="stray-scanner",
    description="a folder of the app Stray Scanner: depth, odometry.csv, camera_matrix.csv",
    suffixes=(),
    recognizes=_recognizes,
    read=read_stray_scanner,
)
