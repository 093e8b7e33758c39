"""What of uvicorn's own the bounds of connections build upon; a release without it fails here."""

import asyncio

import h11
import pytest
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

from hypernav.robot.server.serving import TimedHeads

WHY = "uvicorn {version} has changed H11Protocol.{name}, on which hypernav's TimedHeads builds"


def changed(name: str) -> str:
    return WHY.format(version=uvicorn.__version__, name=name)


async def nobody(scope: object, receive: object, send: object) -> None:
    return None


async def connection() -> TimedHeads:
    config = uvicorn.Config(nobody, http=TimedHeads, ws="none", log_config=None)
    return TimedHeads(config, ServerState(), {})


@pytest.mark.parametrize(
    "name", ["connection_made", "data_received", "on_response_complete", "connection_lost"]
)
def test_what_is_extended_is_there(name):
    assert callable(getattr(H11Protocol, name, None)), changed(name)


@pytest.mark.parametrize("name", ["client", "conn", "connections", "loop", "transport"])
def test_what_is_read_is_there(name):
    made = asyncio.run(connection())
    assert hasattr(made, name), changed(name)
    assert made.conn.their_state is h11.IDLE, changed("conn")


def test_a_response_that_is_over_is_told():
    """The cycle of a request gets the method as it is called when the response is complete."""
    code = H11Protocol.handle_events.__code__
    assert "on_response_complete" in code.co_names, changed("on_response_complete")
