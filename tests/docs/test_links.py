"""Links resolve, every page can be found, no page speaks of one machine."""

import re

import pytest

from tests.docs.pages import DOCS, PAGES, ROOT, blocks, name_of, prose

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
MACHINE = re.compile(r"(?<![\w.:/~<>)-])/(?!api/)[a-z]+/\w|localhost")  # any absolute path
UNFINISHED = re.compile(r"\b(TODO|FIXME|TBD|XXX)\b")


def links(page):
    return [target for target in LINK.findall(prose(page)) if "://" not in target]


def anchors(page):
    found = set()
    for heading in re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE):
        text = heading.replace("&lt;", "").replace("&gt;", "").lower()
        found.add(re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", text)).strip("-"))
    return found


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_resolve(page):
    for target in links(page):
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        assert there.exists(), target
        if anchor:
            assert anchor in anchors(there), target


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=name_of)
def test_links_of_the_site_stay_in_the_site(page):
    for target in links(page):
        assert (page.parent / target.partition("#")[0]).resolve().is_relative_to(DOCS), target


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_no_page_speaks_of_one_machine_or_is_unfinished(page):
    text = page.read_text()
    assert not MACHINE.search(text), MACHINE.search(text)
    assert not UNFINISHED.search(text), UNFINISHED.search(text)


def test_every_page_is_in_the_navigation():
    listed = re.findall(r": ([\w/-]+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)
    assert sorted(listed) == sorted(str(p.relative_to(DOCS)) for p in DOCS.rglob("*.md"))


def test_every_figure_is_shown_and_small():
    shown = {
        (page.parent / target).resolve() for page in PAGES for target in links(page)
        if target.endswith(".png")
    }  # fmt: skip
    figures = set((DOCS / "figures").glob("*.png"))
    assert figures == shown
    for figure in figures:
        assert figure.stat().st_size < 400_000, figure.name


def test_every_picture_has_words_for_those_who_do_not_see_it():
    for page in PAGES:
        for words in re.findall(r"!\[([^\]]*)\]", prose(page)):
            assert len(words) > 20, (name_of(page), words)


def test_decisions_have_context_decision_and_consequences():
    records = sorted((DOCS / "decisions").glob("0*.md"))
    assert [int(record.name[:4]) for record in records] == list(range(1, len(records) + 1))
    index = (DOCS / "decisions" / "index.md").read_text()
    for record in records:
        text = record.read_text()
        assert text.startswith(f"# {record.name[:4]} ")
        assert all(f"**{word}.**" in text for word in ("Context", "Decision", "Consequences"))
        assert record.name in index


def test_changelog_fragments_have_an_issue_and_a_kind():
    for fragment in (ROOT / "changelog.d").glob("*.md"):
        if fragment.name != "README.md":
            assert re.fullmatch(r"\d+(-\w+)?\.(added|changed|fixed|removed)\.md", fragment.name)


def test_every_example_is_listed():
    scripts = {path.name for path in (ROOT / "examples").glob("*.py")}
    listed = set(re.findall(r"^\| `(\w+\.py)`", (ROOT / "examples/README.md").read_text(), re.M))
    assert scripts == listed


def test_tables_that_benchmarks_fill_in_have_their_marks():
    text = (DOCS / "results.md").read_text()
    for name in (
        "speed", "load", "paper", "buildings", "oracle", "nuisances", "realism", "radish", "mall",
    ):  # fmt: skip
        assert text.count(f"<!-- table:{name} -->") == text.count(f"<!-- /table:{name} -->") == 1


def test_blocks_are_of_a_known_kind():
    for page in PAGES:
        assert {b.kind for b in blocks(page)} <= {"python", "text", "console", "sh", "json"}
