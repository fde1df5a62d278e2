"""Every example runs and says something."""

import subprocess

import pytest

from tests.docs.pages import ROOT, name_of, python


@pytest.mark.parametrize("script", sorted((ROOT / "examples").glob("*.py")), ids=name_of)
def test_example_runs(script, tmp_path):
    done = subprocess.run(
        [python(), "-W", "error", str(script)], cwd=tmp_path, capture_output=True, text=True,
        timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
    assert not done.stderr
