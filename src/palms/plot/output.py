"""Pictures as files: written whole or not at all, the same bytes for the same picture."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from palms.errors import OutputError
from palms.io.files import write_bytes
from palms.plot.style import styled

__all__ = ["image_bytes", "write_figure"]

_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


@styled
def image_bytes(figure: Figure, kind: str = "png", dpi: float = 150.0) -> bytes:
    """Return a figure as the bytes of a PNG, SVG or PDF file, without a date in it.

    Parameters
    ----------
    figure : Figure
    kind : {"png", "svg", "pdf"}
    dpi : float
        Pixels per inch.

    Examples
    --------
    >>> from palms.plot.style import new_figure
    >>> image_bytes(new_figure(1, 1))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, dpi=dpi, metadata=_METADATA[kind])
    return buffer.getvalue()


def write_figure(path: str | os.PathLike[str], figure: Figure, dpi: float = 150.0) -> None:
    """Write a figure as PNG, SVG or PDF, as the file's name ends.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    figure : Figure
    dpi : float
        Pixels per inch.

    Raises
    ------
    OutputError
        When it cannot be written, or its name ends otherwise.

    Examples
    --------
    >>> from palms.plot.style import new_figure
    >>> write_figure("figure.docx", new_figure(1, 1))
    Traceback (most recent call last):
    palms.errors.OutputError: figure.docx: expected a name that ends in .png, .svg or .pdf, got ...
    """
    kind = Path(path).suffix.lower().removeprefix(".")
    if kind not in _METADATA:
        raise OutputError(
            str(path),
            expected="a name that ends in .png, .svg or .pdf",
            got=f"'.{kind}'" if kind else "no ending",
        )
    write_bytes(path, image_bytes(figure, kind, dpi))
