from collections.abc import Iterator

import pytest

from servers.scripted import ScriptedServer


@pytest.fixture(scope="session")
def one_server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server:
        yield server


@pytest.fixture
def server(one_server: ScriptedServer) -> ScriptedServer:
    """A running server that works; each test may change it as it likes."""
    one_server.reset()
    return one_server
