"""Make the pictures of the phone's page in docs/figures: ``python -m tools.make_phone_screens``.

Needs what the browser tests need: node, chromium, and ``npm ci --prefix tests/browser``.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from tests.browser.conftest import HERE, chromium, missing, running, serving  # noqa: E402

FIGURES = ROOT / "docs" / "figures"
SHOWN = {
    "phone-light.png": ("start-light", "turn-light", "walk-light", "map-light"),
    "phone-dark.png": ("start-dark", "turn-dark", "walk-dark", "map-dark"),
}
HEIGHT, GAP, ROUND = 720, 24, 26  # pixels
EDGE = (128, 136, 150)
COLOURS = 128


def framed(path: Path) -> Image.Image:
    """Return a screen with round corners and a thin edge."""
    screen = Image.open(path).convert("RGBA")
    size = round(screen.width * HEIGHT / screen.height), HEIGHT
    screen = screen.resize(size, Image.Resampling.LANCZOS)
    corners = Image.new("L", size, 0)
    box = (0, 0, size[0] - 1, size[1] - 1)
    ImageDraw.Draw(corners).rounded_rectangle(box, ROUND, fill=255)
    screen.putalpha(corners)
    ImageDraw.Draw(screen).rounded_rectangle(box, ROUND, outline=EDGE, width=2)
    return screen


def row(paths: list[Path]) -> Image.Image:
    """Return screens side by side on nothing."""
    screens = [framed(path) for path in paths]
    width = sum(screen.width + GAP for screen in screens) - GAP
    canvas = Image.new("RGBA", (width, HEIGHT), (255, 255, 255, 0))
    left = 0
    for screen in screens:
        canvas.paste(screen, (left, 0))
        left += screen.width + GAP
    return canvas.quantize(COLOURS, method=Image.Quantize.FASTOCTREE)


def main() -> None:
    """Run the page and write the pictures."""
    if (reason := missing()) is not None:
        sys.exit(reason)
    with tempfile.TemporaryDirectory() as folder, running("node", "browser.mjs", chromium()) as b:
        with serving(Path(folder) / "data") as (url, _):
            found = {"PALMS_URL": url, "PALMS_BROWSER": b.stdout.readline().strip()}
            script = Path(__file__).with_name("phone_screens.mjs")
            environment = os.environ | found | {"PALMS_PICTURES": folder}
            subprocess.run(["node", "--test", script], cwd=HERE, env=environment, check=True)
        for name, screens in SHOWN.items():
            row([Path(folder) / f"{screen}.png" for screen in screens]).save(
                FIGURES / name, optimize=True
            )
            print(f"docs/figures/{name}")


if __name__ == "__main__":
    main()
