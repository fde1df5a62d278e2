"""What numbers rest on: versions, source, machine."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

import palms

__all__ = ["machine", "source_digest", "versions"]

_APART = ("cli", "plot", "processes.py", "sample", "server")  # what changes no number
_JUDGING = (
    "experiment.py",
    "metrics.py",
    "oracle.py",
    "subject.py",
)  # what does, of palms.evaluation


def versions() -> dict[str, str]:
    """Return the versions of what the numbers rest on, and a digest of the source.

    Examples
    --------
    >>> list(versions())
    ['palms-localization', 'numpy', 'scipy', 'numba', 'source']
    """
    packages = ("palms-localization", "numpy", "scipy", "numba")
    return {**{name: version(name) for name in packages}, "source": source_digest()}


@lru_cache
def source_digest() -> str:
    """Return a digest of the source that makes the numbers: not all changes have a version.

    Examples
    --------
    >>> len(source_digest())
    16
    """
    root = Path(palms.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(root.rglob("*.py")):
        where = file.relative_to(root)
        apart = where.name not in _JUDGING if where.parts[0] == "evaluation" else False
        if where.parts[0] not in _APART and not apart:
            digest.update(where.as_posix().encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def machine() -> dict[str, str]:
    """Return what this runs on.

    Examples
    --------
    >>> sorted(machine())
    ['Machine', 'Processor', 'System']
    """
    model = platform.processor() or "unknown"
    info = Path("/proc/cpuinfo")
    if info.is_file():
        named = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = named[0].partition(":")[2].strip() if named else model
    return {
        "Machine": platform.machine(),
        "Processor": f"{model}, {os.cpu_count()} cores",
        "System": f"{platform.system()} {platform.release()}",
    }
