import importlib.util

import pytest

from hypernav.io.bounded_http import environment_proxy, is_loopback, without_password

PROXY = "http://proxy.example:3128"


@pytest.fixture(autouse=True)
def proxied(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("all_proxy", "no_proxy", "http_proxy", "https_proxy"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)
    monkeypatch.setenv("http_proxy", PROXY)


@pytest.mark.parametrize(
    "host",
    [
        *("localhost", "LOCALHOST", "localhost.", "vlm.localhost"),
        *("127.0.0.1", "127.1.2.3", "[::1]", "[::ffff:127.0.0.1]"),
    ],
)
def test_a_loopback_address_is_never_asked_through_a_proxy(host: str):
    assert environment_proxy(f"http://{host}:8000/v1") is None
    assert is_loopback(host.strip("[]"))


@pytest.mark.parametrize("host", ["10.1.2.3", "lab", "localhost.example", "[fd00::2]"])
def test_any_other_host_is(host: str):
    assert environment_proxy(f"http://{host}:8000/v1") == PROXY


@pytest.mark.parametrize(
    ("no_proxy", "host", "is_excepted"),
    [
        ("10.0.0.0/8", "10.1.2.3", True),
        ("10.0.0.0/8", "11.1.2.3", False),
        ("example.com, 192.168.0.0/16 ", "192.168.7.7", True),
        ("10.1.2.3", "10.1.2.3", True),
        ("fd00::/8", "[fd00::2]", True),
        ("10.0.0.0/8", "ten.example", False),
        (".example", "lab.example", True),
        ("not a network/99", "10.1.2.3", False),
        ("*", "10.1.2.3", True),
    ],
)
def test_exceptions_are_names_and_networks(
    no_proxy: str, host: str, is_excepted: bool, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("no_proxy", no_proxy)
    assert (environment_proxy(f"http://{host}:8000/v1") is None) == is_excepted


def test_a_socks_proxy_needs_its_package(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("http_proxy", "socks5://me:secret@proxy.example:1080")
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"pip install 'httpx\[socks\]'.*no_proxy=lab") as caught:
        environment_proxy("http://lab:8000/v1")
    assert "secret" not in str(caught.value)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    assert environment_proxy("http://lab:8000/v1") == "socks5://me:secret@proxy.example:1080"


def test_a_proxy_of_another_kind_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("http_proxy", "ftp://proxy.example:21")
    with pytest.raises(ValueError, match=r"unknown kind \(ftp://\)"):
        environment_proxy("http://lab:8000/v1")


@pytest.mark.parametrize("proxy", ["http://proxy.example:abc", "http://[::1"])
def test_a_malformed_proxy_is_named_as_the_environments(
    proxy: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("http_proxy", proxy)
    with pytest.raises(ValueError, match="environment names a proxy whose URL is malformed"):
        environment_proxy("http://lab:8000/v1")


def test_a_password_does_not_show():
    assert without_password("http://me:secret@proxy:3128") == PROXY.replace(".example", "")
