"""Every block of Python and every console session of README and documentation, run in order."""

import contextlib
import io
import json

import pytest

from tests.docs.pages import (
    PAGES,
    ROOT,
    blocks,
    commands,
    name_of,
    run,
    same,
    shell_environment,
)

RUNNING = [page for page in PAGES if {"python", "console"} & {b.kind for b in blocks(page)}]


@pytest.fixture
def environment(tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    return shell_environment(home)


def run_python(text, names, where):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(text, where, "exec"), names)
    return out.getvalue()


@pytest.mark.parametrize("page", RUNNING, ids=name_of)
def test_code_runs_and_prints_what_the_page_shows(page, tmp_path, monkeypatch, environment):
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    names, printed = {"__name__": "page"}, ""
    for block in blocks(page):
        if block.kind == "python":
            printed = run_python(block.text, names, name_of(page))
        elif block.kind == "console":
            for command, shown in commands(block.text):
                output, folder = run(command, folder, environment)
                assert not shown or same(shown, output), f"$ {command}\n{output}"
        elif block.kind == "text" and printed:
            assert same(block.text, printed), printed
            printed = ""


def test_the_readme_shows_all_three_levels():
    code = "\n".join(b.text for b in blocks(ROOT / "README.md") if b.kind == "python")
    for word in ("palms.track", "find_candidates", "start_from", "advance", "settle", "summarize",
                 "Localizer"):  # fmt: skip
        assert word in code


def test_json_blocks_are_json():
    for page in PAGES:
        for block in blocks(page):
            if block.kind == "json":
                json.loads(block.text)
