"""Photograph the map page: ``python tools/make_map_pictures.py``.

A server starts with an empty folder, and a browser draws a walk on it; the pictures go into
``docs/figures``, or where ``--out FOLDER`` says. Needs what tests/browser needs: node, chromium
and ``npm ci --prefix tests/browser``.
"""

from __future__ import annotations

import argparse
import io
import json
import shutil
import subprocess
import tempfile
from pathlib import Path

from PIL import Image

from palms.io.files import write_bytes
from palms.server.application import Setup
from palms.server.limits import Limits
from palms.server.running import in_background

ROOT = Path(__file__).resolve().parents[1]
SCRIPT = ROOT / "tests" / "browser" / "pictures.mjs"
COLOURS = 256  # a palette keeps a picture small


def photograph(url: str, folder: Path) -> list[Path]:
    """Have the browser take the pictures; returns their paths."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        raise SystemExit("chromium is missing: apt-get install chromium")
    command = ["node", str(SCRIPT), url, chromium, str(folder)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return [Path(line) for line in json.loads(done.stdout)]


def smaller(picture: bytes) -> bytes:
    """Return a picture with a palette, as PNG."""
    out = io.BytesIO()
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    palette = image.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    palette.save(out, "PNG", optimize=True)
    return out.getvalue()


def main() -> None:
    """Take all pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "figures")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as folder:
        setup = Setup(Path(folder) / "data", limits=Limits(requests_per_s=1000.0))
        with in_background(setup) as url:
            for taken in photograph(url, Path(folder)):
                write_bytes(out / taken.name, smaller(taken.read_bytes()))
                print(out / taken.name)


if __name__ == "__main__":
    main()
