"""Floor plans as ROS maps: a YAML file that names a picture of occupied and free cells."""

from __future__ import annotations

import math
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray, rotate
from palms.grid import Grid
from palms.io.files import head, read_bytes, read_text, sniff, write_bytes, write_text
from palms.io.plan_csv import plan_name
from palms.io.plan_image import load_grey
from palms.io.plan_parts import PlanParts, check_scale
from palms.io.registry import Format
from palms.io.values import StrPath, brief, parse_number

__all__ = ["FORMAT", "RosMap", "parse_map", "read_plan_ros", "write_plan_ros"]

RESOLUTION_M = 0.05  # what map_server's own maps have
_EXPECTED = "a ROS map: YAML with image, resolution and origin"
_MAX_PIXELS = 12_000_000  # ours
_SPECK_M = 0.3  # ours: smaller patches are chairs and noise
_OCCUPIED, _FREE, _UNKNOWN = 0, 254, 205  # as map_saver writes them


class RosMap(NamedTuple):
    """What the YAML file says."""

    image: str
    resolution_m: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    mode: str


def parse_map(text: str, what: str) -> RosMap:
    r"""Return what the YAML of a map says: flat keys, numbers, and lists in one of both forms.

    Examples
    --------
    >>> parse_map("image: a.pgm\nresolution: 0.1\norigin: [-1, -2, 0]\nnegate: 0\n", "a.yaml")[:2]
    ('a.pgm', 0.1)
    """
    values = _flat_yaml(text)
    missing = [key for key in ("image", "resolution", "origin") if not values.get(key)]
    if missing:
        raise FormatError(what, expected=_EXPECTED, got=f"no {', no '.join(missing)}")
    numbers = {
        key: parse_number(values.get(key, default))
        for key, default in (("resolution", ""), ("occupied_thresh", "0.65"), ("negate", "0"))
    }
    pose = [parse_number(each) for each in values["origin"].strip("[]").split(",")]
    bad = [key for key, value in numbers.items() if value is None or not math.isfinite(value)]
    if bad or len(pose) not in (2, 3) or any(v is None or not math.isfinite(v) for v in pose):
        raise FormatError(
            what, expected="numbers for resolution, origin [x, y, yaw] and occupied_thresh",
            got=", ".join(brief(values.get(key, "")) for key in (bad or ["origin"])),
        )  # fmt: skip
    x, y, yaw = (*(float(v or 0.0) for v in pose), 0.0)[:3]
    resolution = check_scale(numbers["resolution"], f"{what}, resolution") or 1.0
    threshold = numbers["occupied_thresh"] or 0.0
    negate = bool(numbers["negate"])
    return RosMap(
        values["image"], resolution, (x, y, yaw), negate, threshold, values.get("mode", "trinary")
    )


def _flat_yaml(text: str) -> dict[str, str]:
    """Values by key; list items on lines of their own come together in brackets."""
    values: dict[str, str] = {}
    last = ""
    for raw in text.splitlines():
        line = raw.split(" #")[0].strip()
        if not line or line.startswith(("#", "---", "%")):
            continue
        if line.startswith("- ") and last:
            values[last] = ",".join(filter(None, (values[last], line[2:].strip())))
            continue
        key, colon, value = line.partition(":")
        if colon:
            last = key.strip()
            values[last] = value.strip().strip("\"'")
    return values


def read_plan_ros(path: StrPath, *, min_wall: float = 0.3) -> FloorPlan:
    """Read a floor plan from a map of ROS's map_server: the YAML file.

    Occupied cells become walls; x and y are those of the map's frame, the origin's yaw too.

    Parameters
    ----------
    path : path
        The YAML file; the picture that it names lies beside or below it.
    min_wall : float
        Shorter walls, in metres, are left out.

    Raises
    ------
    InputError
        When file or picture cannot be read, or no cell is occupied.
    """
    from palms.io.vectorize import remove_specks, walls_of

    found = parse_map(read_text(path, _EXPECTED), str(path))
    picture = _picture(path, found.image)
    content = read_bytes(picture)
    grey, factor = load_grey(content, str(picture), work_pixels=10**9)
    if grey.size > _MAX_PIXELS or factor > 1:
        raise FormatError(str(picture), expected=f"at most {_MAX_PIXELS:,} cells",
                          got=f"{grey.size:,}", fix="crop the map")  # fmt: skip
    p = grey if found.negate else 1 - grey
    if found.mode == "raw":
        p = np.where(grey * 255 <= 100, grey * 255 / 100, 0).astype(np.float32)
    cell = found.resolution_m
    occupied = remove_specks(p > found.occupied_thresh, _SPECK_M / cell)
    walls = walls_of(occupied, max(min_wall / cell, 3.0))
    if not len(walls):
        raise FormatError(
            str(path), expected="walls of occupied cells", got="none",
            fix="check negate and occupied_thresh",
        )  # fmt: skip
    x, y, yaw = found.origin
    local = (walls * [1, -1] + [0, grey.shape[0]]) * cell
    parts = PlanParts()
    parts.add(rotate(local, yaw) + [x, y], SegmentClass.WALL)
    return parts.build(path, plan_name(path))


def _picture(path: StrPath, name: str) -> Path:
    """Return the picture's path, which must not lead out of the map's folder."""
    inside = PurePosixPath(name.replace("\\", "/"))
    if ".." in inside.parts:
        raise FormatError(
            f"{path}, image", expected="a file beside the map", got=brief(name),
            fix="put the picture beside it",
        )  # fmt: skip
    return Path(path).parent / (inside.name if inside.is_absolute() else inside)


def write_plan_ros(plan: FloorPlan, path: StrPath) -> None:
    """Write a floor plan as a ROS map: YAML, and a PGM of the same stem beside it.

    Cells are 0.05 m: walls and glass are occupied, the rest of the inside is free, and outside is
    unknown. Doors and openings are free.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> square = [[[0, 0], [4, 0]], [[4, 0], [4, 4]], [[4, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_plan_ros(FloorPlan(square), f"{folder}/a.yaml")
    ...     read_plan_ros(f"{folder}/a.yaml").size_m.round().tolist()
    [4.0, 4.0]
    """
    from palms.raster import rasterize
    from palms.settings import RasterSettings

    raster = rasterize(plan, RasterSettings(cell_size_m=RESOLUTION_M, max_cells=_MAX_PIXELS))
    grid = raster.grid
    values = np.where(raster.inside, _FREE, _UNKNOWN).astype(np.uint8)
    cells = _cells_along(plan.blocking_m, grid)
    values[cells[:, 0], cells[:, 1]] = _OCCUPIED
    target = Path(path)
    picture = target.with_suffix(".pgm")
    rows, columns = grid.shape
    header = f"P5\n{columns} {rows}\n255\n".encode()
    write_bytes(picture, header + values[::-1].tobytes())
    x, y = (float(v) for v in grid.origin_m)
    write_text(
        target,
        f"image: {picture.name}\nmode: trinary\nresolution: {RESOLUTION_M:g}\n"
        f"origin: [{x:.4f}, {y:.4f}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n",
    )


def _cells_along(segments_m: FloatArray, grid: Grid) -> Any:  # noqa: ANN401
    """Cells (N, 2) that segments run through, sampled every quarter of a cell."""
    step = grid.cell_size_m / 4
    points = [
        a + np.linspace(0, 1, max(2, math.ceil(math.dist(a, b) / step) + 1))[:, None] * (b - a)
        for a, b in segments_m
    ]
    return np.unique(grid.cell_of(np.concatenate(points)), axis=0)


def _recognizes(path: Path) -> bool:
    start = head(path)
    if sniff(start) != "text":
        return False
    keys = _flat_yaml(start.decode("utf-8", "replace"))
    return {"image", "resolution", "origin"} <= set(keys)


FORMAT = Format(
    name="ros",
    description="map_server: YAML beside PGM or PNG",
    suffixes=(".yaml", ".yml"),
    recognizes=_recognizes,
    read=read_plan_ros,
    write=write_plan_ros,
)
