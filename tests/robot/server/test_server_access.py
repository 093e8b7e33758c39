"""Who may come in, and with how much."""

import gc
import itertools
import json
import os
import socket
import time
import weakref
from contextlib import ExitStack, closing
from dataclasses import replace

import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.registries import DETECTORS
from hypernav.core.errors import ConfigError, RunFolderError
from hypernav.core.goal import Goal
from hypernav.robot.server import guard, serving
from hypernav.robot.server.guard import Access
from hypernav.robot.server.limits import Pace, ServerLimits
from hypernav.robot.server.searches.agents import READ_LABELS, AgentPlan
from hypernav.robot.server.searches.journal import Journal
from hypernav.robot.server.searches.search import Search
from hypernav.robot.server.serving import check_access, listening, read_token
from hypernav.robot.wire.frames import MOST_BODY_BYTES
from hypernav.robot.wire.requests import OpenSearch
from hypernav.robot.wire.values import repeated_key
from servers.robots import (
    TOKEN,
    RobotLink,
    ScriptedAgent,
    body_of,
    real_plan,
    robot_server,
)


@pytest.mark.parametrize(
    "header",
    [None, "", "Bearer", "Bearer ", f"Basic {TOKEN}", f"Bearer {TOKEN}x", f"Bearer {TOKEN[:-1]}"],
)
def test_every_request_needs_the_token(tmp_path, header, caplog):
    with robot_server(tmp_path, token=TOKEN) as link:
        assert link.call("GET", "/v1/health").status == 200
        stranger = RobotLink(link.port)
        headers = {} if header is None else {"authorization": header}
        for path in ("/v1/health", "/v1/searches", "/v1/openapi.json", "/v1/nothing"):
            answer = stranger.call("GET", path, headers=headers)
            assert answer.status == 401
            assert answer.headers["www-authenticate"] == "Bearer"
            assert TOKEN not in answer.content.decode()
        assert stranger.call("POST", "/v1/searches", {"goal": "bed"}, headers=headers).status == 401
    assert TOKEN not in caplog.text


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": "evil.example"}, 403),
        ({"host": "evil.example:8765"}, 403),
        ({"host": "["}, 403),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "null"}, 403),
        ({"host": "localhost:1", "origin": "http://localhost:1"}, 200),
        ({"host": "127.0.0.1:1"}, 200),
        ({"host": "[::1]:1"}, 200),
    ],
)
def test_pages_of_other_sites_are_kept_out(link, headers, status):
    assert link.call("GET", "/v1/health", headers=headers).status == status


def test_bodies_are_limited_before_they_are_read(link):
    search = link.open()
    for size in (MOST_BODY_BYTES + 1, 10**15):
        headers = {"content-length": str(size)}
        assert link.call("POST", f"{search}/observations", b"x", headers=headers).status == 413
    assert link.call("POST", "/v1/searches", b"[" * 70_000).status == 413


def test_a_body_without_a_length_is_limited_as_well(link):
    search = link.open()
    with socket.create_connection(("127.0.0.1", link.port)) as connection:
        request = f"POST {search}/close HTTP/1.1\r\nhost: localhost\r\n"
        connection.sendall(request.encode() + b"transfer-encoding: chunked\r\n\r\n")
        chunk = b"1000\r\n" + b" " * 0x1000 + b"\r\n"
        try:
            for _ in range(100):
                connection.sendall(chunk)
        except OSError:
            pass  # it has hung up
        try:
            said = connection.recv(1000)
        except OSError:
            said = b""
    assert said == b"" or b" 413 " in said
    assert link.call("GET", search).json["state"] == "waiting"


def test_a_body_that_never_comes_is_not_waited_for(tmp_path):
    with robot_server(tmp_path, limits=ServerLimits(body_s=0.1)) as link:
        headers = {"content-length": "100"}
        assert link.call("POST", "/v1/searches", b"{", headers=headers).status == 408


def test_too_many_requests_are_told_to_wait(tmp_path):
    with robot_server(tmp_path, limits=ServerLimits(requests_per_s=0.001, burst=3)) as link:
        statuses = [link.call("GET", "/v1/health").status for _ in range(5)]
        assert statuses == [200, 200, 200, 429, 429]
        assert link.call("GET", "/v1/health").headers["retry-after"] == "1"
        assert link.call("POST", f"/v1/searches/{'0' * 32}/stop", {}).status == 404  # not limited
        assert link.call("POST", "/elsewhere/stop", {}).status == 429


LONG = "because " * 100


STOPS = (
    (b"", {}, ""),
    (b"{}", {}, ""),
    (b'{"reason": "button 3"}', {}, "button 3"),
    (b'{"reason": "a", "reason": "b", "more": 1}', {}, "b"),
    (b"button 3", {"content-type": "text/plain"}, "button 3"),
    (json.dumps({"reason": LONG}).encode(), {}, LONG[:200]),
    (b'{"reason": null}', {}, ""),
    (b"[1, 2]", {}, ""),
    (b"[" * 60_000, {}, "[" * 200),
    (b"\xff\xfe\x00", {"content-type": "image/png"}, "\ufffd\ufffd\x00"),
    (b"x" * 100_000, {}, "x" * 200),
    (b"{", {"content-length": "20"}, "{"),
    (b"", {"content-length": str(10**15)}, ""),
    (b"", {"x": "y" * 30_000}, ""),
)
"""Bodies and headers of a STOP, and the reason that people read."""


def test_whatever_is_sent_to_stop_stops(link):
    paths = itertools.cycle(["SEARCH/stop", "/v1/stop", "/v1/stop/", "//v1//stop", "SEARCH/stop//"])
    for (body, headers, reason), path in zip(STOPS, paths, strict=False):
        search = link.open("quick")
        answer = link.call("POST", path.replace("SEARCH", search), body, headers=headers)
        status = link.call("GET", search).json
        said = (answer.status, status["ending"], status["detail"])
        assert said == (200, "stopped", reason), (path, body[:50], headers)


def exchanged(port: int, sent: bytes) -> bytes:
    """All that the server says before it closes the connection."""
    with closing(socket.create_connection(("127.0.0.1", port), timeout=20.0)) as connection:
        connection.sendall(sent)
        received = b""
        while more := connection.recv(65_536):
            received += more
    return received


HEALTH = b"GET /v1/health HTTP/1.1\r\nhost: localhost\r\n"


def test_half_a_request_head_ends_the_connection(link, monkeypatch):
    monkeypatch.setattr(serving, "_HEAD_S", 0.2)
    assert exchanged(link.port, HEALTH) == b""
    received = exchanged(link.port, HEALTH + b"\r\n" + HEALTH)
    assert received.startswith(b"HTTP/1.1 200")
    assert received.count(b"HTTP/1.1") == 1


def test_large_request_heads_are_refused(link):
    assert link.call("GET", "/v1/health", headers={"x": "y" * 10_000}).status == 200
    assert link.call("GET", "/v1/health", headers={"x": "y" * 60_000}).status == 431
    assert (
        link.call("GET", "/v1/health", headers={f"x{n}": "y" * 900 for n in range(20)}).status
        == 431
    )
    assert exchanged(link.port, HEALTH + b"x: " + 80_000 * b"y").startswith(b"HTTP/1.1 400")


def test_a_body_of_two_lengths_is_refused(link):
    head = b"POST /v1/robots/a/goal HTTP/1.1\r\nhost: localhost\r\ncontent-length: 2\r\n"
    body = b"transfer-encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n"
    received = exchanged(link.port, head + body + HEALTH + b"\r\n")
    assert received.startswith(b"HTTP/1.1 400")
    assert received.count(b"HTTP/1.1") == 1


def test_a_stop_whose_body_never_comes_stops_and_ends_the_connection(link):
    search = link.open("quick")
    head = f"POST {search}/stop HTTP/1.1\r\nhost: localhost\r\ncontent-length: 20\r\n\r\n"
    began_s = time.monotonic()
    assert exchanged(link.port, head.encode()).startswith(b"HTTP/1.1 200")
    assert time.monotonic() - began_s < 5.0
    assert link.call("GET", search).json["ending"] == "stopped"


def test_connections_that_wait_do_not_keep_stop_out(link, monkeypatch):
    monkeypatch.setattr(serving, "_MOST_CONNECTIONS", 4)
    monkeypatch.setattr(serving, "_HEAD_S", 60.0)
    with ExitStack() as opened:
        address = ("127.0.0.1", link.port)
        waiting = [
            opened.enter_context(closing(socket.create_connection(address, timeout=20.0)))
            for _ in range(10)
        ]
        assert link.call("POST", "/v1/stop", {}).status == 200
        assert waiting[0].recv(1) == b""


def test_a_forgotten_content_type_is_named(link):
    answer = link.call("POST", "/v1/searches", b'{"goal": "bed"}')
    assert answer.status == 422
    assert "content-type: application/json" in answer.json["message"]


def test_an_ended_search_holds_no_agent(tmp_path):
    agents = weakref.WeakSet()

    class Noted(ScriptedAgent):
        def reset(self, goal: Goal) -> None:
            agents.add(self)
            super().reset(goal)

    with pytest.MonkeyPatch.context() as patch, robot_server(tmp_path) as link:
        patch.setattr("servers.robots.ScriptedAgent", Noted)
        search = link.open("quick")
        assert len(agents) == 1
        link.call("POST", f"{search}/close")
        end = time.monotonic() + 20.0
        while agents and time.monotonic() < end:
            gc.collect()
        assert not agents


def test_an_ended_search_is_on_the_disk_and_not_in_memory(tmp_path):
    before = [one for one in gc.get_objects() if type(one) is Search]
    with robot_server(tmp_path) as link:
        search = link.open("quick")
        link.observe(search, body_of(0))
        link.answer(search, 0)
        paths = [f"{search}/{name}" for name in ("image", "map.png", "map.json")]
        shown = [link.call("GET", path).content for path in paths]
        extent = link.call("GET", search).json["map"]
        link.call("POST", f"{search}/close")
        (kept,) = [o for o in gc.get_objects() if type(o) is Search and o not in before]
        assert (kept._now.grid, kept._now.colour) == (None, None)
        assert [link.call("GET", path).content for path in paths] == shown
        assert link.call("GET", search).json["map"] == extent
    with robot_server(tmp_path) as link:  # started again
        assert [link.call("GET", path).content for path in paths] == shown
        assert link.call("GET", search).json["map"] == extent


def test_searches_are_limited(tmp_path):
    with robot_server(tmp_path, limits=ServerLimits(searches=2)) as link:
        first, _ = link.open(), link.open()
        refused = link.call("POST", "/v1/searches", {"goal": "bed"})
        assert refused.status == 429
        assert first.rpartition("/")[2] in refused.json["message"]
        link.call("POST", f"{first}/close")
        link.open()


@pytest.fixture
def clock(monkeypatch) -> list[float]:
    """The time of `Search`, which only passes if a test says so."""
    now_s = [100.0]
    monkeypatch.setattr("hypernav.robot.server.searches.search.monotonic", lambda: now_s[0])
    return now_s


def test_the_search_of_a_silent_robot_ends(tmp_path, clock, monkeypatch):
    monkeypatch.setattr(serving, "_LOOK_S", 0.05)
    with robot_server(tmp_path, limits=ServerLimits(searches=2, idle_s=600.0)) as link:
        silent, heard = link.open("quick"), link.open("quick")
        clock[0] += 599.0
        link.observe(heard, body_of(0))
        link.answer(heard, 0)
        status = link.call("GET", silent).json
        assert (status["silent_s"], status["ending"]) == (599.0, None)
        assert link.call("POST", "/v1/searches", {"goal": "bed"}).status == 429
        clock[0] += 2.0
        version, end_s = status["version"], time.monotonic() + 20.0
        status = link.call("GET", f"{silent}?after={version}&wait_s=20").json
        assert time.monotonic() < end_s
        assert (status["ending"], status["silent_s"]) == ("robot failed", None)
        assert status["detail"] == "its robot was silent for 10 min"
        assert "was silent" in link.observe(silent, body_of(0)).json["reason"]
        assert link.call("GET", heard).json["ending"] is None
        link.open("quick")  # its slot is free


def test_a_robot_is_told_when_it_opens_that_others_wait_too_long(tmp_path, monkeypatch):
    with robot_server(tmp_path) as link:
        monkeypatch.setattr(Pace, "median_s", lambda _: 0.49)
        first = link.open("quick")
        monkeypatch.setattr(Pace, "median_s", lambda _: 0.51)
        refused = link.call("POST", "/v1/searches", {"goal": "bed"})
        assert (refused.status, refused.json["error"]) == (429, "busy")
        assert "510 ms" in refused.json["message"]
        link.call("POST", f"{first}/close")
        link.open("quick")  # nobody waits any more


@pytest.mark.parametrize("detector", ["ground-truth", "noisy:good", "systematic:good"])
def test_a_robot_without_labels_is_refused_when_it_opens(tmp_path, detector):
    def plan(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), specs=ComponentSpecs(detector=detector))

    with robot_server(tmp_path, plan) as link:
        refused = link.call("POST", "/v1/searches", {"goal": "bed"})
        assert refused.status == 422
        assert "start the server with --vlm or another --detector" in refused.json["message"]
        assert link.call("GET", "/v1/searches").json == []
        link.open("bed")
    assert all(DETECTORS.knows(name) for name in READ_LABELS - {"truth"})


def test_a_robot_says_why_it_ends(link):
    search = link.open("quick")
    why = {"reason": "the battery is empty", "failed": True}
    assert link.call("POST", f"{search}/close", why).json["ending"] == "robot failed"
    assert link.call("GET", search).json["detail"] == "the battery is empty"
    assert link.observe(search, body_of(0)).json["reason"] == "the battery is empty"


@pytest.mark.parametrize("path", ["/", "/page/main.js"])
def test_the_page_has_a_head(link, path):
    answer = link.call("HEAD", path)
    assert (answer.status, answer.content) == (200, b"")


def test_bodies_that_drip_give_way_to_others(tmp_path):
    limits = ServerLimits(requests_at_once=4)
    with robot_server(tmp_path, limits=limits) as link, ExitStack() as opened:
        search = link.open("quick", deadline_s=20.0)
        head = b"POST /v1/searches HTTP/1.1\r\nhost: localhost\r\ncontent-length: 50\r\n\r\n{"
        address = ("127.0.0.1", link.port)
        for _ in range(12):
            dripping = socket.create_connection(address, timeout=20.0)
            opened.enter_context(closing(dripping))
            dripping.sendall(head)
        for sequence in range(3):
            assert link.observe(search, body_of(sequence)).status == 200


def test_those_who_wait_for_news_do_not_block_observations(tmp_path):
    limits = ServerLimits(requests_at_once=4)
    with robot_server(tmp_path, limits=limits) as link, ExitStack() as opened:
        search = link.open("quick", deadline_s=20.0)
        version = link.call("GET", search).json["version"]
        waiting = f"GET {search}?after={version}&wait_s=20 HTTP/1.1\r\nhost: localhost\r\n\r\n"
        address = ("127.0.0.1", link.port)
        for _ in range(12):
            connection = socket.create_connection(address, timeout=20.0)
            opened.enter_context(closing(connection))
            connection.sendall(waiting.encode())
        time.sleep(0.2)
        assert link.observe(search, body_of(0)).status == 200


def test_a_robot_that_waits_for_an_answer_is_not_forgotten(tmp_path, script):
    script.gate.clear()
    with robot_server(tmp_path, limits=ServerLimits(searches=1, idle_s=0.0)) as link:
        waiting = link.open(deadline_s=0.1)
        assert link.observe(waiting, body_of(0)).json["hold"]
        assert link.call("POST", "/v1/searches", {"goal": "bed"}).status == 429
        assert link.call("GET", waiting).json["ending"] is None
        script.gate.set()


def test_an_end_that_cannot_be_written_is_no_fault_of_who_needs_the_slot(
    tmp_path, monkeypatch, caplog
):
    def full(*_: object) -> None:
        raise RunFolderError("the disk is full")

    with robot_server(tmp_path, limits=ServerLimits(searches=1, idle_s=0.0)) as link:
        silent = link.open("quick")
        monkeypatch.setattr(Journal, "write_end", full)
        link.open("quick")
        assert link.call("GET", silent).json["ending"] == "robot failed"
    assert "the disk is full" in caplog.text


@pytest.mark.parametrize(
    ("request_body", "words"),
    [
        (b"", "body"),
        (b"{", "body"),
        (b"[" * 60_000, "body"),
        (b'{"goal": "sofa", "goal": "bed"}', "the key 'goal' twice"),
        ({}, "goal"),
        ({"goal": ""}, "goal"),
        ({"goal": "\u0007"}, "control character"),
        ({"goal": "bed", "speed": 3}, "speed"),
        ({"goal": "bed", "agent": "os:system"}, "agent"),
        ({"goal": "bed", "agent": "no-such-agent"}, "no-such-agent"),
        ({"goal": "bed", "embodiment": {"body": {"radius_m": -1}}}, "radius_m"),
        ({"goal": "bed", "embodiment": {"camera": {"width": 8000, "height": 600}}}, "pixels"),
        ({"goal": "bed", "embodiment": {"body": {"height_m": 0.1}}}, "height_m"),
        ({"goal": "bed", "intrinsics": {"fx": 0, "fy": 1, "cx": 0, "cy": 0}}, "fx"),
        ({"goal": "bed", "intrinsics": {"fx": 2, "fy": 2, "cx": 300, "cy": 0}}, "hfov_deg"),
    ],
)
def test_a_search_that_cannot_be_says_why(link, request_body, words):
    answer = link.call(
        "POST", "/v1/searches", request_body, headers={"content-type": "application/json"}
    )
    assert answer.status in (400, 422), answer.content
    assert words in answer.json["message"]
    assert link.call("GET", "/v1/searches").json == []


@pytest.mark.parametrize("kind", ["application/json", "text/plain"])
def test_keys_are_counted_by_path_whatever_kind_of_body_is_announced(link, kind, monkeypatch):
    counted: list[bytes] = []

    def count(text: bytes) -> str | None:
        counted.append(text)
        return repeated_key(text)

    monkeypatch.setattr(guard, "repeated_key", count)
    twice, headers = b'{"goal": "sofa", "goal": "bed"}', {"content-type": kind}
    answer = link.call("POST", "/v1/searches", twice, headers=headers)
    assert (answer.status, counted) == (422, [twice])
    assert "the key 'goal' twice" in answer.json["message"]
    # That of an observation may be large, and only its header is JSON.
    answer = link.call("POST", f"{link.open()}/observations", b"[{},{}]", headers=headers)
    assert answer.status == 422
    assert b"[{},{}]" not in counted


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/v1/searches/..%2f..%2fetc", 404),
        ("/v1/searches/../../etc/passwd", 404),
        ("/v1/searches/%00", 422),
        ("/v1/searches/" + "0" * 32, 404),
        ("/v1/searches/" + "0" * 31, 422),
        ("/v1/searches/" + "A" * 32, 422),
        ("/v1/searches/" + "0" * 32 + "/map.png", 404),
        ("/v1/searches/" + "0" * 32 + "/replies/-1", 422),
        ("/etc/passwd", 404),
        ("/docs", 404),
    ],
)
def test_a_path_is_a_name_or_nothing(link, path, status):
    answer = link.call("GET", path)
    assert answer.status == status
    assert answer.json["message"]


def test_nothing_to_show_is_said(link):
    search = link.open()
    for path in ("map.png", "map.json", "map.yaml", "map.pgm", "image"):
        assert link.call("GET", f"{search}/{path}").status == 404
    assert link.call("GET", f"{search}/trace").content == b""
    assert link.call("DELETE", search).status == 405


def test_a_robot_far_from_its_map_is_refused(link):
    search = link.open()
    answer = link.observe(search, body_of(0, odom_to_map={"x": 400.0}))
    assert answer.status == 422
    assert "400.0" in answer.json["message"]


def test_a_network_needs_a_token():
    with pytest.raises(ConfigError, match="--token-file"):
        check_access(Access("0.0.0.0"))
    check_access(Access("0.0.0.0", TOKEN))
    for host in ("127.0.0.1", "::1", "localhost", "127.3.2.1"):
        check_access(Access(host))


def test_a_token_file_is_for_its_owner_only(tmp_path):
    path = tmp_path / "token"
    path.write_text(TOKEN + "\n")
    path.chmod(0o600)
    assert read_token(path) == TOKEN
    path.chmod(0o644)
    with pytest.raises(ConfigError, match="others can read it"):
        read_token(path)


@pytest.mark.parametrize("content", [b"", b"short", b"two words of a token", b"\xff" * 20])
def test_a_token_is_one_long_word(tmp_path, content):
    path = tmp_path / "token"
    path.touch(0o600)
    path.write_bytes(content)
    with pytest.raises(ConfigError, match="--token-file"):
        read_token(path)


def test_a_token_file_must_be_there(tmp_path):
    for path in (tmp_path / "none", tmp_path, tmp_path / os.devnull.lstrip("/")):
        with pytest.raises(ConfigError, match="--token-file"):
            read_token(path)


def test_a_port_in_use_is_said():
    with listening("127.0.0.1", 0) as first:
        port = first.getsockname()[1]
        with pytest.raises(ConfigError, match="choose another --port"):
            listening("127.0.0.1", port)
