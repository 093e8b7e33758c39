"""Addresses of servers, as people write them."""

import os
from contextlib import closing
from dataclasses import replace

import pytest

from hypernav.core.errors import LinkLostError, RequestRefusedError, RobotLinkError
from hypernav.robot.client.links import HttpServer, ServerAddress
from servers.faulty import FaultyServer


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("http://127.0.0.1:8765", "http://127.0.0.1:8765"),
        ("http://robot.local", "http://robot.local:80"),
        ("https://example.org/nav/", "https://example.org:443/nav"),
    ],
)
def test_addresses_are_read(url, shown):
    assert str(ServerAddress.of(url)) == shown


@pytest.mark.parametrize(
    "url", ["127.0.0.1:8765", "ftp://a", "http://", "http://a:b", "http://a:99999"]
)
def test_what_is_no_address_is_refused(url):
    with pytest.raises(RobotLinkError, match="address of the server"):
        ServerAddress.of(url)


def test_a_token_is_sent_and_never_shown(tmp_path):
    (tmp_path / "token").write_text("secret\n")
    address = ServerAddress.of("http://a:1", tmp_path / "token")
    assert address.headers == {"Authorization": "Bearer secret"}
    assert "secret" not in str(address) + repr(address)


def test_a_token_is_read_from_a_regular_file_only(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, tmp_path / "missing"):
        with pytest.raises(RobotLinkError, match="cannot read the token"):
            ServerAddress.of("http://a:1", path)


@pytest.mark.parametrize("status", [200, 502])
def test_an_answer_that_repeats_the_token_is_quoted_without_it(status):
    def act(talk):
        talk.reply(f"Authorization: Bearer {talk.headers['authorization'][7:]}".encode(), status)

    with FaultyServer(act, other=act) as server:
        address = replace(ServerAddress.of(server.url.removesuffix("/v1")), token="secret-token")
        with (
            closing(HttpServer(address)) as asked,
            pytest.raises((LinkLostError, RequestRefusedError), match=r"Bearer \*\*\*") as caught,
        ):
            asked.status("a")
    assert "secret" not in str(caught.value)
