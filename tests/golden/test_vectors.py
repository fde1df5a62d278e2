"""The compiled loops still give what they gave when the vectors were written."""

import importlib.util
import json
from pathlib import Path

import pytest

HERE = Path(__file__).parent
STORED = json.loads((HERE / "vectors.json").read_text())


def current():
    path = HERE.parents[1] / "tools" / "make_vectors.py"
    spec = importlib.util.spec_from_file_location("make_vectors", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return json.loads(json.dumps(module.vectors()))


def flat(value, path=""):
    if isinstance(value, dict):
        return {k: v for key, item in value.items() for k, v in flat(item, f"{path}/{key}").items()}
    if isinstance(value, list):
        return {k: v for i, item in enumerate(value) for k, v in flat(item, f"{path}/{i}").items()}
    return {path: value}


@pytest.mark.parametrize("loop", sorted(STORED))
def test_the_loops_give_what_they_gave(loop):
    assert current()[loop]["in"] == STORED[loop]["in"]
    assert flat(current()[loop]["out"]) == pytest.approx(
        flat(STORED[loop]["out"]), rel=1e-12, abs=1e-15
    )
