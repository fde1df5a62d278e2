"""Scans from the PALMS data set's ARKit depth: folders depths, poses and intrinsics."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from palms.errors import FormatError, InputError
from palms.extraction import DepthFrame, ExtractionSettings, free_ranges
from palms.extraction.depth import step_of
from palms.geometry import FloatArray
from palms.io.depth_images import (
    MAX_FRAMES,
    DepthOptions,
    depth_scan,
    evenly,
    pixel_size,
    report_left_out,
)
from palms.io.files import read_json
from palms.io.plane_geometry import read_matrices
from palms.io.planes import PLANES_FILE, read_sidecar
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array, locating
from palms.scan import Scan

__all__ = ["FORMAT", "read_coverage", "read_depth_folder", "read_frames"]

GROUND = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # (-z, -x) and y up
_COVERAGE_FRAMES = 60  # ours: a turn in steps of 6 degrees, read in about a second
_FRAME_BYTES = 20_000_000  # ours: ten times the largest depth image we know as JSON


def read_depth_folder(
    path: StrPath,
    *,
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read a folder of depth images: their walls, and the space that their rays prove empty.

    Parameters
    ----------
    path : path
        The folder with ``depths``, ``poses`` and ``intrinsics``, and perhaps ``scan.json``
        that says when and where the scan was taken.
    position : (x, y) or str, optional
        The observation point on the ground; when left out that of ``scan.json``, else the
        origin, or a place of the camera when that is far off.
    floor : float, optional
        Height of the floor; found when left out.
    settings : ExtractionSettings, optional
        What counts as a wall.

    Raises
    ------
    InputError
        When an image cannot be read, or they show no wall.
    """
    stated = read_sidecar(Path(path) / PLANES_FILE)
    here = stated.pop("position_m", None) if position is None else position
    scan = depth_scan(read_frames(path), path, DepthOptions(here, floor, settings))
    return replace(scan, **{key: stated[key] for key in ("time_s", "session") if key in stated})


def read_coverage(path: StrPath, position_m: FloatArray) -> FloatArray:
    """Read what the depth images of a folder prove empty, seen from one point.

    Parameters
    ----------
    path : path
        The folder with ``depths``, ``poses`` and ``intrinsics``.
    position_m : ndarray (2,)
        On the ground.

    Returns
    -------
    ndarray (360,)
        Metres that are free, by bearing; NaN where nobody looked.

    Raises
    ------
    InputError
        When an image cannot be read.
    """
    frames = read_frames(path, _COVERAGE_FRAMES)
    with locating(path):
        return free_ranges(frames, position_m, step=step_of(frames))


def read_frames(path: StrPath, most: int = MAX_FRAMES) -> list[DepthFrame]:
    """Read the depth images of a folder, at most so many, spread evenly.

    Images without pose or intrinsics are left out with a warning.
    """
    folder = Path(path)
    found = _files(folder / "depths", "depth_")
    poses = _files(folder / "poses", "cameraPose_")
    lenses = _files(folder / "intrinsics", "cameraIntrinsics_")
    names = [name for name in found if name in poses and name in lenses]
    if not names:
        raise InputError(
            str(path), expected="depths/depth_<id>.json with its pose and intrinsics",
            got=f"{len(found)} depths, {len(poses)} poses, {len(lenses)} intrinsics, none matching",
            fix="name the folder that holds depths, poses and intrinsics",
        )  # fmt: skip
    report_left_out(len(found), len(names), "no pose or no intrinsics", path)
    chosen = [names[i] for i in evenly(len(names), most)]
    places = [str(poses[name]) for name in chosen]
    matrices = read_matrices([_data(poses[name], "a pose") for name in chosen], places)
    frames = []
    for name, pose in zip(chosen, matrices, strict=True):
        depth = _depth(found[name])
        lens = check_array(_data(lenses[name], "intrinsics"), str(lenses[name]), (3, 3))
        with locating(lenses[name]):
            focal, centre = pixel_size(lens, depth.shape)
        with locating(found[name]):
            frames.append(DepthFrame(depth, focal, centre, _on_ground(pose)))
    return frames


def _files(folder: Path, prefix: str) -> dict[str, Path]:
    """Files ``<prefix><id>.json`` by their id, in the order of numbers."""
    if not folder.is_dir():
        return {}
    files = {
        file.name.removeprefix(prefix).removesuffix(".json"): file
        for file in folder.iterdir() if file.name.startswith(prefix) and file.suffix == ".json"
    }  # fmt: skip
    return dict(sorted(files.items(), key=lambda item: (len(item[0]), item[0])))


def _data(path: Path, expected: str) -> object:
    if os.path.getsize(path) > _FRAME_BYTES:
        raise InputError(
            str(path), expected=f"at most {_FRAME_BYTES / 1e6:g} MB", got="more",
            fix="check that it is one image",
        )  # fmt: skip
    content = read_json(path, expected)
    return content.get("data", content) if isinstance(content, dict) else content


def _depth(path: Path) -> FloatArray:
    """Depth image (h, w) in metres; null and 0 are unknown."""
    rows = _data(path, "a depth image in rows of metres")
    if not isinstance(rows, list) or not all(isinstance(row, list) for row in rows):
        raise FormatError(str(path), expected="a depth image in rows", got=brief(rows))
    filled = [[0.0 if value is None else value for value in row] for row in rows]
    depth = check_array(filled, str(path), (None, None))
    if min(depth.shape) < 2 or (depth < 0).any():
        raise FormatError(
            str(path), expected="a depth image in metres", got=f"shape {depth.shape}, or below 0"
        )
    return depth


def _on_ground(pose: FloatArray) -> FloatArray:
    turned = np.eye(4)
    turned[:3] = GROUND @ pose[:3]
    return turned


def _recognizes(path: Path) -> bool:
    return path.is_dir() and (path / "depths").is_dir() and (path / "poses").is_dir()


FORMAT = Format(
    name="depth-folder",
    description="the PALMS data set's depth images: a folder with depths, poses, intrinsics",
    suffixes=(),
    recognizes=_recognizes,
    read=read_depth_folder,
)
