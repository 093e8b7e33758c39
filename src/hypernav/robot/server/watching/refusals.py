"""HTTP responses for the errors of this package, each with its status."""

import logging
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.exceptions import HTTPException

from hypernav.core.errors import HyPerNavError, RequestRefusedError, RunFolderError
from hypernav.robot.server.guard import refusal
from hypernav.robot.wire.replies import ErrorBody

_LOG = logging.getLogger(__name__)

REFUSALS: dict[int | str, dict[str, Any]] = {
    status: {"model": ErrorBody, "description": words}
    for status, words in {
        400: "The request cannot be read.",
        401: "The token is missing or wrong.",
        403: "This page or host may not use this server.",
        404: "There is no such search, or nothing to show yet.",
        408: "The body did not arrive in time.",
        409: "Another observation is expected, see expected; or a key is that of another goal.",
        413: "The body is too large.",
        422: "A value is wrong; the message says which.",
        429: "Too many requests or searches.",
        507: "The disk of the server is full.",
    }.items()
}
"""The statuses of refusals, for the OpenAPI document."""


def add_refusals(app: FastAPI) -> None:
    """Let an application answer errors with refusals."""
    app.add_exception_handler(RequestRefusedError, _refused)
    app.add_exception_handler(RunFolderError, _storage)
    app.add_exception_handler(HyPerNavError, _invalid)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _internal)


async def _refused(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestRefusedError)
    return refusal(error.error, str(error), error.status, error.expected)


async def _storage(_: Request, error: Exception) -> Response:
    _LOG.error("%s", error)
    return refusal(
        "storage",
        "the server cannot write its state; its log says more. A stop holds until the server ends; "
        "send it again when there is room",
        507,
    )


async def _invalid(_: Request, error: Exception) -> Response:
    return refusal("invalid", str(error), 422)


async def _malformed(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    kind = request.headers.get("content-type", "none")
    if first["loc"] == ("body",) and "json" not in kind:
        expected = f"expected the header content-type: application/json, got {kind[:80]!a}"
        return refusal("invalid", expected, 422)
    where = ".".join(str(part) for part in first["loc"])
    return refusal("invalid", f"{where[:100]}: {str(first['msg'])[:300]}", 422)


async def _http(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    words = {404: "unknown", 405: "method"}.get(error.status_code, "invalid")
    response = refusal(words, str(error.detail), error.status_code)
    response.headers.update(error.headers or {})
    return response


async def _internal(_: Request, error: Exception) -> Response:
    return refusal("internal", "an error of the server; its log says more", 500)
