"""Each flow of ``flows/`` against a server that they share."""

import pytest

from tests.browser.conftest import HERE

FLOWS = sorted(path.stem for path in (HERE / "flows").glob("*.mjs"))


@pytest.mark.parametrize("name", FLOWS)
def test_flow(flow, served, name):
    flow(name, served)
