"""Draw the documentation's figures from our own runs: ``python tools/make_figures.py``.

They go into ``docs/figures``; ``--out FOLDER`` writes elsewhere. The same bytes every time.
"""

from __future__ import annotations

import argparse
import functools
import io
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

import palms
from palms.heatmap import Heatmaps
from palms.io import Case, open_dataset
from palms.io.files import write_bytes
from palms.particles import start_from
from palms.plot import (
    Recorder,
    Story,
    empty_space_figure,
    image_bytes,
    pipeline_figure,
    stages_figure,
)
from palms.randomness import as_key
from palms.sample import sample_folder

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "figures"
SEED = 0
METHODS = {
    "uniform": "uniform:\neverywhere, any drift",
    "uniform-ori": "uniform-ori:\neverywhere, four drifts",
    "paper": "paper:\nwhere the scan fits",
}
COLOURS = 256  # of a picture without shades: a palette keeps it small


@functools.cache
def sample() -> Case:
    """Return the case of the sample data set."""
    return open_dataset(sample_folder()).cases[0]


@functools.cache
def story(method: str) -> Story:
    """Track the sample's walk by a method."""
    case, settings, recorder = sample(), palms.Settings.for_method(method), Recorder()
    raster, scan, walk = palms.rasterize(case.plan()), case.scan(), case.walk()
    odometry = walk.odometry()
    return Story(
        raster, odometry, palms.track(raster, scan, odometry, settings, SEED, recorder), recorder,
        scan, palms.locate(raster, scan, settings), walk.reference_m, walk.start_m, settings,
    )  # fmt: skip


def heatmaps() -> Heatmaps:
    """Return the heatmaps of the sample's scan."""
    found = story("paper").heatmaps
    assert found is not None  # it has a scan
    return found


def pipeline() -> Figure:
    """Draw the paper's Fig. 1."""
    told = story("paper")
    assert told.candidates is not None
    particles = start_from(told.candidates, 2000, as_key(SEED).child(0), own_frame=False)
    return pipeline_figure(heatmaps(), told.candidates, particles, told.scan_place_m)


def empty_space() -> Figure:
    """Draw the paper's Fig. 2."""
    return empty_space_figure(heatmaps(), story("paper").scan_place_m)


def stages() -> Figure:
    """Draw the paper's Fig. 3."""
    return stages_figure({title: story(method) for method, title in METHODS.items()})


def readme() -> Figure:
    """Draw the moments of the default method alone."""
    return stages_figure({"": story("palms")}, moments=("start", "t2", "end"))


def write_small(path: Path, figure: Figure, dpi: float, has_shades: bool) -> None:
    """Write a figure as a small PNG."""
    picture = Image.open(io.BytesIO(image_bytes(figure, "png", dpi))).convert("RGB")
    if not has_shades:
        picture = picture.quantize(COLOURS, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG", optimize=True)
    write_bytes(path, buffer.getvalue())


FIGURES = {  # how to draw it, pixels per inch, whether it has shades of colour
    "pipeline": (pipeline, 90.0, True),
    "empty-space": (empty_space, 100.0, False),
    "stages": (stages, 110.0, False),
    "readme": (readme, 100.0, False),
}


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help=f"some of {', '.join(FIGURES)}")
    parser.add_argument("--out", type=Path, default=FOLDER, help="where to (default: docs/figures)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, (draw, dpi, has_shades) in FIGURES.items():
        if not arguments.only or name in arguments.only:
            path = arguments.out / f"{name}.png"
            write_small(path, draw(), dpi, has_shades)
            print(f"{path.stat().st_size:8d}  {path.name}")


if __name__ == "__main__":
    main()
