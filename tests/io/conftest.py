"""Good files of each format, for the tests that damage them."""

from __future__ import annotations

import importlib.metadata
import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from palms.io.registry import FLOORPLANS, _plugins

PLANE = {
    "index": 0,
    "id": "A",
    "anchorTransform": [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -2], [0, 0, 0, 1]],
    "centers": [[9, 9, 9], [0, 0, 0]],
    "extents": [[1, 1, 1], [3, 2.4, 0]],
    "updatedTimes": [0.1, 0.2],
    "planeAlignment": 1,
}


def check_message(error: BaseException, *parts: str) -> None:
    """The message is one line that says what, expected and got."""
    text = str(error)
    assert "\n" not in text
    assert "Traceback" not in text
    for part in (*parts, "expected ", "got "):
        assert part in text, f"{part!r} not in {text!r}"


@pytest.fixture
def says():
    return check_message


@pytest.fixture
def plane() -> dict:
    return json.loads(json.dumps(PLANE))


@pytest.fixture
def walk_content() -> dict:
    """Nine samples along x at 1 m; the reference is 10 m further up."""
    x = np.arange(1.0, 10.0)
    return {
        "source": "made",
        "session_id": 118531.105147166,
        "building_id": "E2",
        "starting_vector": [[0.0, 10.0], [5.0, 10.0]],
        "ARKit_raw_2D": np.column_stack([-x, 0 * x]).tolist(),
        "RoNIN_raw_2D": np.column_stack([0 * x, 1.1 * x]).tolist(),
        "ARKit_PF": [[0.0, 10.0], [8.0, 10.0], [9.0, 10.0]],
        "time_intervals": [12.5] + [0.5] * 8,
    }


@pytest.fixture
def put(tmp_path: Path):
    """Write text, bytes or JSON into a file of the test's folder."""

    def put_file(name: str, content: object) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            text = content if isinstance(content, str) else json.dumps(content)
            path.write_text(text, encoding="utf-8", newline="")
        return path

    return put_file


@pytest.fixture
def unwritable(tmp_path: Path) -> Path:
    """A folder that cannot be: its name is that of a regular file."""
    blocked = tmp_path / "blocked"
    blocked.write_text("a file")
    return blocked


@pytest.fixture
def install(monkeypatch):
    """Make entry points of other packages; forget them afterwards."""
    module = ModuleType("palms_plugin_for_tests")
    monkeypatch.setitem(sys.modules, module.__name__, module)

    def install_readers(**readers: object) -> None:
        entries = []
        for name, reader in readers.items():
            setattr(module, name, reader)
            value = f"{module.__name__}:{name}" if reader is not None else "no.such.module:x"
            entries.append(importlib.metadata.EntryPoint(name, value, FLOORPLANS))
        monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: entries)
        _plugins.cache_clear()

    yield install_readers
    _plugins.cache_clear()
