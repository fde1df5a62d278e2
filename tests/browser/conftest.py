"""A real ``palms serve`` and a real Chromium; flows are scripts of node that drive them."""

from __future__ import annotations

import contextlib
import functools
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PATIENCE_S = 600  # of one flow on a busy machine
WITHOUT_PACKAGES = "packages are missing: npm ci --prefix tests/browser"
IS_REQUIRED = os.environ.get("PALMS_BROWSER_TESTS") == "required"


def missing() -> str | None:
    """What keeps browser tests from running, and how to get it; None when all is there."""
    if without_node() is not None:
        return without_node()
    if chromium() is None:
        return "chromium is missing: apt-get install chromium"
    if not (HERE / "node_modules" / "playwright-core").exists():
        return WITHOUT_PACKAGES
    return None


@functools.cache
def without_node() -> str | None:
    """What keeps scripts of node from running."""
    if shutil.which("node") is None:
        return "node is missing: apt-get install nodejs npm"
    version = subprocess.check_output(["node", "--version"], text=True).strip()
    is_new = tuple(int(part) for part in version[1:].split(".")[:2]) >= (20, 19)
    return None if is_new else f"node is {version}: 20.19 or newer is needed"


def chromium() -> str | None:
    return shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture(scope="session")
def _tools() -> None:
    """Skip where a tool is missing, or fail where none may be."""
    found = missing()
    if found is not None and IS_REQUIRED:
        pytest.fail(f"PALMS_BROWSER_TESTS=required, but {found}")
    if found is not None:
        pytest.skip(found)


@contextlib.contextmanager
def running(*command: object) -> Iterator[subprocess.Popen[str]]:
    """A process with pipes, ended in the end; its standard input is closed first."""
    process = subprocess.Popen(
        [str(part) for part in command], cwd=HERE, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.stdin.close()
        process.terminate()
        process.wait()
        process.stdout.close()


@pytest.fixture(scope="session")
def browser(_tools: None) -> Iterator[str]:
    """Where the one Chromium of this run listens."""
    with running("node", "browser.mjs", chromium()) as process:
        yield process.stdout.readline().strip()


@contextlib.contextmanager
def serving(folder: Path, *options: object) -> Iterator[tuple[str, str]]:
    """A server with an empty data folder; its address, and all that it said."""
    command = [sys.executable, "-m", "palms", "serve", "--port", 0, "--data", folder, *options]
    with running(*command) as process:
        said = process.stdout.readline()
        found = re.search(r"https?://[\w.:]+", said)
        assert found, said
        yield found.group(), said


@pytest.fixture(scope="session")
def served(_tools: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of the server that flows share."""
    limits = ("--limit", "requests_per_s=1000", "--limit", "request_burst=10000")
    with serving(tmp_path_factory.mktemp("browser") / "data", *limits) as (url, _):
        yield url


@pytest.fixture(scope="session")
def flow(browser: str) -> Callable[..., None]:
    """Run a flow by its path; its report is what fails the test."""

    def run(name: str, url: str, **environment: str) -> None:
        done = subprocess.run(
            ["node", "--test", "--test-reporter=spec", f"{name}.mjs"],
            cwd=HERE, capture_output=True, text=True, timeout=PATIENCE_S, check=False,
            env=os.environ | {"PALMS_URL": url, "PALMS_BROWSER": browser} | environment,
        )  # fmt: skip
        assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"

    return run
