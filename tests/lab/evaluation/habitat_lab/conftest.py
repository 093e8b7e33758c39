from pathlib import Path

import pytest

from habitat_room import write_room


@pytest.fixture(scope="session")
def room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_room(tmp_path_factory.mktemp("habitat") / "data")
