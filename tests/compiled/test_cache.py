"""The compiled loops' caches, where the package's own folder cannot be written to."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import palms

_RUN = """
import numpy as np
from palms._compiled import select
assert select.nth_largest(np.arange(5, dtype=np.float32), 2) == 3
print(select.__file__, len(select.nth_largest.stats.cache_hits))
"""


def test_caches_go_elsewhere_where_the_package_cannot_be_written_to(tmp_path):
    package = tmp_path / "site" / "palms"
    (package / "_compiled").mkdir(parents=True)
    source = Path(palms.__file__).parent
    for name in ("__init__.py", "_compiled/__init__.py", "_compiled/select.py"):
        shutil.copy(source / name, package / name)
    (package / "_compiled" / "__pycache__").write_text("no folder can be made here")
    home = tmp_path / "home"
    environment = {
        **os.environ, "PYTHONPATH": str(tmp_path / "site"), "HOME": str(home),
        "XDG_CACHE_HOME": str(home), "PYTHONDONTWRITEBYTECODE": "1",
    }  # fmt: skip
    environment.pop("NUMBA_CACHE_DIR", None)
    hits = []
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", _RUN], env=environment, check=True, capture_output=True,
            text=True,
        )  # fmt: skip
        where, found = done.stdout.split()
        assert Path(where).is_relative_to(tmp_path)
        hits.append(int(found))
    assert hits == [0, 1]
