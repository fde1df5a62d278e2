"""What the pages on the server say of routes, limits and options."""

import dataclasses
import re

from palms.server.application import Setup, make_application
from palms.server.limits import Limits
from tests.docs.pages import DOCS, table_rows
from tests.server.conftest import new_store

REST = DOCS / "reference" / "rest.md"


def in_code(cell):
    return re.findall(r"`([^`]*)`", cell)


def who_may(method, path, operation):
    if "push" in path:
        return "session's key"
    if path in ("/api/v1/tracks", "/api/v1/scans"):
        return "visitor"
    if method == "get" and path.startswith("/api/v1/buildings/"):
        return "visitor"
    if path.endswith(("/track", "/frames")):
        return "operator, or a link"
    guarded = "401" in operation["responses"] or path in ("/metrics", "/api/v1/backup")
    return "operator" if guarded else "anybody"


def test_each_route_has_its_row_and_says_who_may(tmp_path):
    app = make_application(Setup(new_store(tmp_path / "data")))
    rows = {(row[0], *in_code(row[1])): row[2] for row in table_rows(REST) if len(row) == 4}
    found = {}
    for path, methods in app.openapi()["paths"].items():
        for method, operation in methods.items():
            found[method.upper(), path] = who_may(method, path, operation)
    assert {key: rows[key] for key in rows if key[0] in ("GET", "POST", "DELETE")} == found
    app.state.store.close()


def test_each_limit_has_its_row():
    rows = [[*in_code(row[0]), *in_code(row[1])] for row in table_rows(REST) if len(row) == 3]
    limits = Limits()
    expected = [[f.name, str(getattr(limits, f.name))] for f in dataclasses.fields(limits)]
    assert [row for row in rows if len(row) == 2] == expected


def test_limits_that_other_pages_name_exist():
    names = {field.name for field in dataclasses.fields(Limits)}
    for page in ("explanation/privacy.md", "explanation/threat-model.md", "how-to/serve.md"):
        text = (DOCS / page).read_text()
        for name in re.findall(r"--limit (\w+)=", text):
            assert name in names
    privacy = (DOCS / "explanation" / "privacy.md").read_text()
    for name, words in (
        ("keep_s", "an hour"),
        ("recording_days", "30 days"),
        ("recordings", "500"),
    ):
        assert f"`{name}`" in privacy
        assert words in privacy
    assert (Limits().keep_s, Limits().recording_days, Limits().recordings) == (3600, 30, 500)
