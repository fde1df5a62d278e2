import base64
import re
from html.parser import HTMLParser

import pytest

from palms import OutputError
from palms.plot import Details, make_album, report_html, write_album, write_report
from palms.plot.report import installed_versions

VOID = {"meta", "img", "br", "link", "hr"}


@pytest.fixture(scope="module")
def album(story):
    return make_album(story)


@pytest.fixture(scope="module")
def page(story, album):
    details = Details("A <walk>", (), "palms track a & b", {"palms": "0.1"}, {"Weather": "<fine>"})
    return report_html(story, details, album)


class Reader(HTMLParser):
    """Collects tags, and whether they are nested well."""

    def __init__(self):
        super().__init__()
        self.seen, self.open, self.wrong = [], [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


@pytest.fixture(scope="module")
def read(page):
    reader = Reader()
    reader.feed(page)
    return reader


def test_the_page_is_well_formed(read):
    assert read.wrong == []
    assert read.open == []
    assert [tag for tag, _ in read.seen].count("h1") == 1


def test_nothing_comes_from_elsewhere(page, read):
    without_images = re.sub(r"base64,[A-Za-z0-9+/=]+", "", page)
    assert "http" not in without_images
    assert "//" not in without_images
    assert not {"script", "link", "iframe"} & {tag for tag, _ in read.seen}
    for _, attributes in read.seen:
        assert "href" not in attributes
        assert attributes.get("src", "data:").startswith("data:")


def test_every_image_is_one_and_is_told_in_words(read, album):
    images = [attributes for tag, attributes in read.seen if tag == "img"]
    assert len(images) == len(album) == 7
    for image, picture in zip(images, album, strict=True):
        assert len(image["alt"]) > 40
        kind, content = image["src"].removeprefix("data:").split(";base64,")
        assert kind == picture.mime
        assert base64.b64decode(content, validate=True) == picture.content


def test_numbers_settings_command_and_versions_are_there(page, story):
    assert f"{story.track.localized_at_s:.1f} s" in page
    assert "palms track a &amp; b" in page
    assert "A &lt;walk&gt;" in page
    assert "&lt;fine&gt;" in page
    assert "candidates.quantile" in page
    assert "Localized" in page
    assert "$" not in re.sub(r"base64,[A-Za-z0-9+/=]+", "", page)


def test_it_is_readable_in_the_dark(page):
    assert "prefers-color-scheme: dark" in page
    assert "color-scheme: light dark" in page
    assert 'lang="en"' in page


def test_a_walk_that_never_was_localized(blind):
    page = report_html(blind)
    assert "Not localized" in page
    assert page.count('<td class="short">never</td>') == 2
    assert re.search(r"x\u00a0[\d.]+\u00a0m,\u00a0y\u00a0[\d.]+\u00a0m", page)  # not broken up
    assert "off by" in page


def test_words_agree_with_the_story(album, story):
    words = {picture.name: picture.words for picture in album}
    assert f"solid from {story.track.localized_at_s:.1f} s" in words["track.png"]
    assert "0.0 m of the plan's walls" in words["empty-space.png"]
    assert words["plan.png"].startswith("Floor plan annex, 20 by 9 m")
    assert "500 particles" in words["walk.gif"]


def test_files_are_written(tmp_path, story, album):
    assert [path.name for path in write_album(tmp_path, album)] == [p.name for p in album]
    write_report(tmp_path / "report.html", story, Details(), album)
    assert (tmp_path / "report.html").read_text("utf-8").startswith("<!DOCTYPE html>")
    with pytest.raises(OutputError):
        write_report(tmp_path / "no" / "report.html", story, Details(), album)


def test_the_same_story_gives_the_same_page(story, page, album):
    details = Details("A <walk>", (), "palms track a & b", {"palms": "0.1"}, {"Weather": "<fine>"})
    assert report_html(story, details) == page


def test_versions():
    assert set(installed_versions()) >= {"Python", "numpy", "matplotlib"}


def test_a_summary_comes_first(story, album):
    page = report_html(story, Details(summary=("In <Lab 7>.", "Sure.")), album)
    assert page.index("<p>In &lt;Lab 7&gt;.</p>\n<p>Sure.</p>") < page.index("<table>")
    assert "Localized" not in page[: page.index("<table>")].split("</style>")[1]


def test_the_places_at_the_end_are_listed(page, story, blind):
    assert "Places that were possible at the end" in page
    best = story.track.estimates[-1].hypotheses[0]
    assert f"{100 * best.share:.1f} %" in page
    assert "Places that were possible" in report_html(blind)
