"""REST under fire: whatever comes, the answer is one that OpenAPI names, and never a 5xx."""

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings

from palms.server.application import Setup
from palms.server.limits import Limits
from palms.server.running import in_background
from tests.server.conftest import http, new_store


@pytest.fixture(scope="module")
def fuzzed(tmp_path_factory):
    folder = new_store(tmp_path_factory.mktemp("fuzz") / "data")
    limits = Limits(requests_per_s=1e6, request_burst=10**6, plan_cells=200_000)
    with in_background(Setup(folder, limits=limits, inline_uploads=True)) as url:
        yield url


def test_nothing_that_is_sent_breaks_the_server(fuzzed):
    schema = schemathesis.openapi.from_url(f"{fuzzed}/api/v1/openapi.json")
    operations = [result.ok() for result in schema.get_all_operations()]
    assert len(operations) > 15
    for operation in operations:
        fire(operation)


def fire(operation):
    @given(case=operation.as_strategy())
    @settings(
        max_examples=12, deadline=None, derandomize=True, phases=[Phase.generate],
        suppress_health_check=list(HealthCheck), database=None,
    )  # fmt: skip
    def run(case):
        response = case.call()
        assert response.status_code < 500, (case.method, case.path, response.text)
        if response.status_code >= 400 and response.status_code not in (404, 405):
            assert "error" in response.json(), (case.method, case.path, response.text)

    run()


def test_the_server_still_works_after_that(fuzzed):
    assert http.get(f"{fuzzed}/health").status_code == 200
    assert "palms_defects_total 0" in http.get(f"{fuzzed}/metrics").text
