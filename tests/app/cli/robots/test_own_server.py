"""The server that a command of a robot starts for itself."""

import urllib.request

import pytest

from hypernav.app.cli.robots.own_server import server_at
from hypernav.core.errors import RobotLinkError


def test_an_address_that_is_given_is_taken_as_it_is():
    with server_at("http://robot.invalid:1") as url:
        assert url == "http://robot.invalid:1"


@pytest.mark.slow
def test_without_one_a_server_answers_until_the_end():
    with server_at(None) as url, urllib.request.urlopen(f"{url}/v1/openapi.json") as answer:
        assert answer.status == 200
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(f"{url}/v1/openapi.json")


def test_a_server_that_cannot_start_says_why():
    options = ["--detector", "yolox:nowhere.onnx"]
    with (
        pytest.raises(RobotLinkError, match=r"hypernav serve did not start: .*nowhere\.onnx"),
        server_at(None, options),
    ):
        pass
