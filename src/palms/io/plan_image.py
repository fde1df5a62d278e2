"""Floor plans from pictures: dark strokes become walls, gaps in them stay gaps.

The picture needs a scale: metres per pixel, or two points and the distance between them. The
lower left corner of the picture is (0, 0).
"""

from __future__ import annotations

import io
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.io.files import head, read_bytes, sniff
from palms.io.plan_parts import PlanParts
from palms.io.plan_scale import Points, metres_per_unit
from palms.io.registry import Format
from palms.io.values import StrPath, brief

__all__ = ["FORMAT", "dark_of", "load_grey", "plan_of_mask", "read_plan_image", "walls_only"]

MAX_PIXELS = 60_000_000  # ours: a sheet of A0 at 190 dots per inch
WORK_PIXELS = 12_000_000  # ours: larger pictures are reduced; keeps memory under a gigabyte
_MAGIC = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"BM", b"II*\x00", b"MM\x00*", b"P5", b"P2")
_TEXT_SHARE = 0.02  # ours: letters are smaller than this share of the picture's longer side
_TEXT_PX = 12.0  # ours: and no text is smaller
_THICK_PX = 3.0  # ours: from there on walls are told from thin strokes
_SUFFIXES = (".png", ".jpg", ".jpeg", ".gif", ".bmp", ".tif", ".tiff", ".webp")

Grey = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]


def load_grey(content: bytes, what: str, work_pixels: int = WORK_PIXELS) -> tuple[Grey, int]:
    """Return a picture as (R, C) from 0, black, to 1, white, and by what it was reduced.

    Raises
    ------
    FormatError
        When it is no picture, damaged, or has too many pixels.
    """
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            picture: Any = Image.open(io.BytesIO(content))
            if picture.width * picture.height > MAX_PIXELS:
                raise FormatError(
                    what, expected=f"at most {MAX_PIXELS:,} pixels",
                    got=f"{picture.width} x {picture.height}", fix="make it smaller",
                )  # fmt: skip
            factor = max(1, math.ceil(math.sqrt(picture.width * picture.height / work_pixels)))
            return _grey(picture, factor), factor
    except FormatError:
        raise
    except MemoryError:
        raise
    except Exception as error:  # damaged pictures raise anything
        raise FormatError(
            what, expected="a whole picture", got=brief(str(error), 60), fix="save it again as PNG"
        ) from None


def _grey(picture: Any, factor: int) -> Grey:  # noqa: ANN401
    from PIL import Image

    if picture.mode.startswith(("I", "F")):
        values = np.asarray(picture, dtype=np.float32)
        return np.asarray(values / max(float(values.max()), 1.0), np.float32)[::factor, ::factor]
    if picture.mode in ("RGBA", "LA", "PA", "P"):
        over = picture.convert("RGBA")
        paper = Image.new("RGBA", over.size, "white")
        picture = Image.alpha_composite(paper, over)
    plain = picture.convert("L")
    if factor > 1:
        plain = plain.reduce(factor)
    return np.asarray(plain, dtype=np.float32) / np.float32(255)


def dark_of(grey: Grey, threshold: float | None = None, invert: bool = False) -> Mask:
    """Return which cells are dark: darker than a threshold, or than Otsu's when left out.

    Examples
    --------
    >>> dark_of(np.array([[0.1, 0.8, 0.9]], np.float32)).tolist()
    [[True, False, False]]
    """
    if invert:
        grey = 1 - grey
    level = _otsu(grey) if threshold is None else threshold
    return np.asarray(grey < level)


def _otsu(grey: Grey) -> float:
    """Return the threshold that separates two groups of grey best."""
    counts, edges = np.histogram(grey, 256, (0.0, 1.0))
    middle = (edges[1:] + edges[:-1]) / 2
    below = np.cumsum(counts)[:-1]
    above = counts.sum() - below
    held = np.cumsum(counts * middle)
    mean_below = held[:-1] / np.maximum(below, 1)
    mean_above = (held[-1] - held[:-1]) / np.maximum(above, 1)
    spread = below * above * (mean_below - mean_above) ** 2
    best = np.flatnonzero(spread >= spread.max() * (1 - 1e-9))
    return float(edges[1:-1][best].mean())


def read_plan_image(  # noqa: PLR0913
    path: StrPath,
    *,
    scale: float | None = None,
    points: Points | None = None,
    distance: float | None = None,
    threshold: float | None = None,
    invert: bool = False,
    min_stroke: float | None = None,
    text_size: float | None = None,
    min_wall: float = 0.4,
) -> FloorPlan:
    """Read a floor plan from a picture: PNG, JPEG, GIF, BMP, TIFF or WebP.

    Parameters
    ----------
    path : path
    scale : float
        Metres per pixel. Or else:
    points, distance
        Two points x1, y1, x2, y2 in pixels from the upper left corner, and the metres between.
    threshold : float, optional
        From 0, black, to 1, white: darker is wall. Found by Otsu's method when left out.
    invert : bool
        Whether walls are light on dark.
    min_stroke : float, optional
        Thinner strokes, in pixels, are no walls. When left out, half of what most dark pixels
        have, if that is at least 3; else none are removed.
    text_size : float, optional
        Patches that fit into a square of so many pixels are letters or furniture; a fiftieth of
        the longer side when left out.
    min_wall : float
        Shorter walls, in metres, are left out.

    Raises
    ------
    InputError
        When it is no picture, has no scale, or no wall is found.
    """
    content = read_bytes(path)
    _check_magic(content, path)
    kind = sniff(content[:1000])
    kind = kind if kind.endswith("image") else "a picture"
    scale = metres_per_unit(scale, points, distance, f"{path}, {kind}", "pixel")
    if threshold is not None and not 0 < threshold < 1:
        raise InputError("option threshold", expected="between 0 and 1", got=f"{threshold:g}")
    grey, factor = load_grey(content, str(path))
    dark = walls_only(dark_of(grey, threshold, invert), factor, min_stroke, text_size)
    return plan_of_mask(dark, scale * factor, min_wall, path)


def _check_magic(content: bytes, path: StrPath) -> None:
    if not content:
        raise FormatError(str(path), expected="a picture", got="an empty file")
    if not _is_picture(content):
        raise FormatError(
            str(path), expected="a picture", got=sniff(content[:1000]),
            fix="check that it is the right file",
        )  # fmt: skip


def walls_only(dark: Mask, factor: int, min_stroke: float | None, text_size: float | None) -> Mask:
    """Take thin strokes and letters away."""
    from palms.io.vectorize import remove_specks, remove_thin, typical_thickness

    typical = typical_thickness(dark)
    automatic = typical / 2 if typical >= _THICK_PX else 0.0
    dark = remove_thin(dark, automatic if min_stroke is None else min_stroke / factor)
    letters = max(_TEXT_PX, _TEXT_SHARE * max(dark.shape))
    return remove_specks(dark, letters if text_size is None else text_size / factor)


def plan_of_mask(dark: Mask, cell_m: float, min_wall_m: float, path: StrPath) -> FloorPlan:
    """Return the plan of a mask of walls, row 0 on top; (0, 0) is its lower left corner.

    Raises
    ------
    FormatError
        When there is no wall in it, or its size is none of a building.
    """
    from palms.io.plan_csv import plan_name
    from palms.io.vectorize import walls_of

    walls = walls_of(dark, max(min_wall_m / cell_m, 3.0))
    if not len(walls):
        raise FormatError(
            str(path), expected="dark walls on a light ground", got="no straight dark stroke",
            fix="set the options threshold, min_stroke, text_size, min_wall or invert",
        )  # fmt: skip
    parts = PlanParts()
    parts.add((walls * [1, -1] + [0, dark.shape[0]]) * cell_m, SegmentClass.WALL)
    return parts.build(path, plan_name(path))


def _is_picture(start: bytes) -> bool:
    return start.startswith(_MAGIC) or (start[:4] == b"RIFF" and start[8:12] == b"WEBP")


def _recognizes(path: Path) -> bool:
    return _is_picture(head(path, 16))


FORMAT = Format(
    name="image",
    description="picture of a posted plan: dark walls; needs its scale",
    suffixes=_SUFFIXES,
    recognizes=_recognizes,
    read=read_plan_image,
)
