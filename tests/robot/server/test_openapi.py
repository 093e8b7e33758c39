"""The OpenAPI document and the server agree, whatever is asked."""

import json
import re

import pytest

from hypernav.robot.server.limits import ServerLimits
from servers.robots import RobotLink, body_of, robot_server

FREELY = ServerLimits(requests_per_s=1e6, burst=1_000_000, searches=20)
_PATHS = {
    "/v1/health": {"get"},
    "/v1/robots": {"get"},
    "/v1/robots/{name}/goal": {"post"},
    "/v1/robots/{name}/wait": {"post"},
    "/v1/stop": {"post"},
    "/v1/things": {"get"},
    "/v1/things/of/{name}": {"get"},
    "/v1/things/{floor}/{number}/image": {"get"},
    "/v1/searches": {"get", "post"},
    "/v1/searches/{name}": {"get"},
    "/v1/searches/{name}/observations": {"post"},
    "/v1/searches/{name}/replies/{sequence}": {"get"},
    "/v1/searches/{name}/stop": {"post"},
    "/v1/searches/{name}/close": {"post"},
    "/v1/searches/{name}/pause": {"post"},
    "/v1/searches/{name}/no-entry": {"get", "post"},
    "/v1/searches/{name}/no-entry/{number}": {"delete"},
    "/v1/searches/{name}/go-to": {"get", "put", "delete"},
    "/v1/searches/{name}/resume": {"post"},
    "/v1/searches/{name}/floors": {"get"},
    "/v1/searches/{name}/floors/words": {"get"},
    "/v1/searches/{name}/stairs": {"get"},
    "/v1/searches/{name}/trace": {"get"},
    "/v1/searches/{name}/image": {"get"},
    **{f"/v1/searches/{{name}}/map.{kind}": {"get"} for kind in ("png", "json", "yaml", "pgm")},
}


_REFUSALS = [*map(str, [400, 401, 403, 404, 405, 408, 409, 413, 422, 429, 431, 500, 503, 507])]


def test_the_document_names_every_path(link):
    document = link.call("GET", "/v1/openapi.json").json
    assert {path: set(methods) for path, methods in document["paths"].items()} == _PATHS
    schemas = document["components"]["schemas"]
    assert {"OpenSearch", "Reply", "Status", "ErrorBody", "ObservationHeader"} <= schemas.keys()
    named = set(re.findall(r"#/components/schemas/(\w+)", json.dumps(document)))
    assert named <= schemas.keys()
    assert {"LabelsPart", "PlanarPose"} <= named
    for methods in document["paths"].values():
        for operation in methods.values():
            assert operation["description"] or operation["summary"]
            for status in _REFUSALS:
                refused = operation["responses"][status]["content"]["application/json"]["schema"]
                assert refused["$ref"].endswith("ErrorBody")


def invented(link: RobotLink, each: int) -> list[int]:
    """Statuses of requests that schemathesis makes up after the document, valid ones and not."""
    import schemathesis
    from hypothesis import HealthCheck, Phase, given, settings
    from schemathesis.checks import not_a_server_error
    from schemathesis.core.result import Ok
    from schemathesis.specs.openapi import checks

    expected = (
        not_a_server_error,
        checks.status_code_conformance,
        checks.content_type_conformance,
        checks.response_schema_conformance,
    )
    search = link.open("unicorn")
    link.observe(search, body_of(0))
    statuses: list[int] = []

    def ask(case: schemathesis.Case) -> None:
        if len(statuses) % 2 and "name" in case.path_parameters:
            case.path_parameters["name"] = search.rpartition("/")[2]
        if isinstance(case.query.get("wait_s"), float | int):
            case.query["wait_s"] = min(case.query["wait_s"], 0.01)
        response = case.call()
        statuses.append(response.status_code)
        case.validate_response(response, checks=list(expected))

    rules = settings(
        max_examples=each,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
    )
    schema = schemathesis.openapi.from_url(f"http://127.0.0.1:{link.port}/v1/openapi.json")
    for result in schema.get_all_operations():
        assert isinstance(result, Ok)
        operation = result.ok()
        for mode in schemathesis.GenerationMode:
            takes_nothing = not operation.path_parameters and not operation.query
            if takes_nothing and not operation.body and mode.value == "negative":
                continue  # nothing can be wrong
            strategy = operation.as_strategy(generation_mode=mode)
            rules(given(case=strategy)(ask))()
    return statuses


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Do not use the `random` module inside strategies")
def test_five_thousand_invented_requests(tmp_path):
    with robot_server(tmp_path, limits=FREELY) as link:
        statuses = invented(link, 210)
        assert link.call("GET", "/v1/health").status == 200
    assert len(statuses) >= 5000
    assert max(statuses) < 500
    assert {200, 201, 404, 409, 422} <= set(statuses)
