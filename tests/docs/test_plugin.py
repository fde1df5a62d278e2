"""The plug-in of the how-to, installed as a package, reads its files."""

import re
import subprocess
import sys
import tomllib
import zipfile

import pytest

from tests.docs.pages import DOCS, blocks, shell_environment

PAGE = DOCS / "how-to" / "add-a-format.md"


@pytest.fixture
def installed(tmp_path):
    """Where the how-to's package is installed, as pip does it from a wheel."""
    code = {block.kind: block.text for block in blocks(PAGE)}
    project = tomllib.loads(code["text"])["project"]
    name = f"palms_boxes-{project['version']}"
    (group,) = project["entry-points"]
    entries = "".join(f"{k} = {v}\n" for k, v in project["entry-points"][group].items())
    files = {
        "palms_boxes.py": code["python"],
        f"{name}.dist-info/METADATA": "Metadata-Version: 2.1\n"
        f"Name: {project['name']}\nVersion: {project['version']}\n",
        f"{name}.dist-info/WHEEL": "Wheel-Version: 1.0\nGenerator: test\n"
        "Root-Is-Purelib: true\nTag: py3-none-any\n",
        f"{name}.dist-info/entry_points.txt": f"[{group}]\n{entries}",
    }
    files[f"{name}.dist-info/RECORD"] = "".join(f"{each},,\n" for each in files)
    wheel = tmp_path / f"{name}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for each, text in files.items():
            archive.writestr(each, text)
    target = tmp_path / "site"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps"]
    subprocess.run([*pip, "--target", target, wheel], check=True, capture_output=True)
    return target


def run(arguments, folder, site):
    environment = shell_environment(folder) | {"PYTHONPATH": str(site)}
    command = [sys.executable, "-m", "palms", *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_the_installed_plugin_is_listed_and_reads(installed, tmp_path):
    listed = run(["formats"], tmp_path, installed).stdout
    assert re.search(r"floor plan\s+boxes\s+\.boxes\s+read\s+nothing\s+a room a line", listed)
    (tmp_path / "flat.txt").write_text("BOXES\nKitchen 0 0 4000 3000\nHall 4000 0 9000 3000\n")
    told = run(["plan", "info", "flat.txt", "--option", "scale=0.001"], tmp_path, installed)
    assert told.returncode == 0, told.stderr
    assert "9.0 x 3.0 m" in told.stdout
    (tmp_path / "bad.boxes").write_text("BOXES\nKitchen 0 0\n")
    failed = run(["plan", "info", "bad.boxes"], tmp_path, installed)
    assert failed.returncode == 1
    assert "bad.boxes line 2: expected name x0 y0 x1 y1" in failed.stderr


def test_a_broken_plugin_is_named_and_skipped(installed, tmp_path):
    (installed / "palms_boxes.py").write_text("import no_such_library\n")
    (tmp_path / "flat.csv").write_text("0,0,8,0\n8,0,8,5\n")
    told = run(["plan", "info", "flat.csv"], tmp_path, installed)
    assert told.returncode == 0
    assert "8.0 x 5.0 m" in told.stdout
    assert "plug-in boxes" in told.stderr
    assert "no_such_library" in told.stderr


def test_the_plugin_is_thirty_lines():
    (code,) = (block.text for block in blocks(PAGE) if block.kind == "python")
    assert len([line for line in code.splitlines() if line.strip()]) <= 30
