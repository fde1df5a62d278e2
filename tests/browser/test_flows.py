"""Each flow of ``flows/`` against a server that they share; ``guarded/`` where it has a token."""

import pytest

from tests.browser.conftest import HERE, serving

FLOWS = sorted(path.stem for path in (HERE / "flows").glob("*.mjs"))
GUARDED = sorted(path.stem for path in (HERE / "guarded").glob("*.mjs"))
TOKEN = "a token of the tests, long enough"


@pytest.mark.parametrize("name", FLOWS)
def test_flow(flow, served, name):
    flow(f"flows/{name}", served)


@pytest.mark.parametrize("name", GUARDED)
def test_a_server_with_a_token(flow, browser, tmp_path, name):
    (tmp_path / "token").write_text(TOKEN)
    with serving(tmp_path / "data", "--token-file", tmp_path / "token") as (url, _):
        flow(f"guarded/{name}", url, PALMS_TOKEN=TOKEN)
