"""The pages' scripts without a browser: they parse, and their pure functions do what they say."""

import subprocess

import pytest

from palms.server.application import WEB
from tests.browser.conftest import HERE, IS_REQUIRED, WITHOUT_PACKAGES, without_node

SCRIPTS = sorted(WEB.rglob("*.js"))


@pytest.fixture(autouse=True)
def _node():
    if without_node() is not None:
        (pytest.fail if IS_REQUIRED else pytest.skip)(without_node())


def node(*arguments):
    done = subprocess.run(
        ["node", *arguments], cwd=HERE, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_pure_functions():
    node("--test", "--test-reporter=spec", *sorted(map(str, HERE.glob("units/*.test.mjs"))))


def test_types_hold():
    compiler = HERE / "node_modules" / "typescript" / "bin" / "tsc"
    if not compiler.exists():
        (pytest.fail if IS_REQUIRED else pytest.skip)(WITHOUT_PACKAGES)
    node(str(compiler), "--project", ".")


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(WEB)))
def test_each_script_parses(script, tmp_path):
    module = tmp_path / f"{script.stem}.mjs"  # for .js alone node does not look at modules
    module.write_text(script.read_text())
    node("--check", str(module))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(WEB)))
def test_scripts_are_small_and_their_lines_short(script):
    lines = script.read_text().splitlines()
    assert len(lines) < 400
    assert max(map(len, lines)) <= 100
