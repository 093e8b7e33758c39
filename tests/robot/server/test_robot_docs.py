"""The commands of docs/robot.md do what the page says."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import ObservationHeader
from servers.robots import robot_server

PAGE = Path(__file__).parents[3] / "docs" / "robot.md"


def test_the_page_names_every_field_of_a_header_and_every_ending():
    text = PAGE.read_text()
    table = re.search(r"\*\*The header\*\*.*?\n\n(\|.*?)\n\n", text, re.DOTALL)
    assert table is not None
    fields = re.findall(r"`(\w+)`", "".join(row.split("|")[1] for row in table[1].splitlines()))
    assert set(fields) == ObservationHeader.model_fields.keys()
    assert all(f"`{ending.value}`" in text for ending in SearchEnding)


@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed")
def test_a_search_with_curl(tmp_path):
    block = re.search(r"```sh\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert block is not None
    Image.fromarray(np.zeros((480, 640, 3), np.uint8)).save(tmp_path / "colour.jpg")
    Image.fromarray(np.full((480, 640), 2000, np.uint16)).save(tmp_path / "depth.png")
    with robot_server(tmp_path / "state") as link:
        script = block[1].replace("127.0.0.1:8765", f"127.0.0.1:{link.port}")
        done = subprocess.run(
            ["bash", "-euc", script], cwd=tmp_path, capture_output=True, text=True, timeout=60
        )
        (status,) = link.call("GET", "/v1/searches").json
    assert done.returncode == 0, done.stderr
    assert '"hold":false,"action":1' in done.stdout
    assert '"error"' not in done.stdout
    assert (status["ending"], status["detail"]) == ("stopped", "that is enough")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
