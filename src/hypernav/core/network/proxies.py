"""Proxies that the environment names: which one a server is asked through, if any."""

import importlib.util
import ipaddress
import urllib.request
from urllib.parse import SplitResult, urlsplit

_SCHEMES = {"http", "https", "socks5", "socks5h"}


def is_loopback(host: str) -> bool:
    """Whether a host is this machine, by its name or its address."""
    name = host.casefold().rstrip(".")
    if name == "localhost" or name.endswith(".localhost"):
        return True
    address = _address(name)
    return address is not None and (address.is_loopback or address.is_unspecified)


def environment_proxy(url: str) -> str | None:
    """The proxy that the environment names (``http_proxy``, ``https_proxy``, ``no_proxy``).

    This machine is never asked through a proxy. ``no_proxy`` may hold names and networks
    (``10.0.0.0/8``).

    Raises:
        ValueError: The proxy cannot be used.
    """
    parts, proxies = urlsplit(url), urllib.request.getproxies()
    host, proxy = parts.hostname or "", proxies.get(parts.scheme) or proxies.get("all")
    if not proxy or is_loopback(host) or _is_excepted(host, proxies.get("no", "")):
        return None
    if urllib.request.proxy_bypass(parts.netloc):
        return None
    proxy = proxy if "://" in proxy else f"http://{proxy}"
    found = _parts(proxy)
    if found.scheme not in _SCHEMES or not found.hostname:
        raise ValueError(
            f"the environment names a proxy of an unknown kind ({found.scheme}://); expected "
            f"http://, https:// or socks5://, or no_proxy={host} to ask the server itself"
        )
    if found.scheme.startswith("socks") and importlib.util.find_spec("socksio") is None:
        raise ValueError(
            f"the environment names a SOCKS proxy ({without_password(proxy)}), which needs a "
            f"package: pip install 'httpx[socks]', or set no_proxy={host} to ask the server itself"
        )
    return proxy


def _parts(proxy: str) -> SplitResult:
    """The parts of a proxy's URL.

    Raises:
        ValueError: It is malformed, or its port is.
    """
    try:
        parts = urlsplit(proxy)
        _ = parts.port
    except ValueError as error:
        raise ValueError(
            f"the environment names a proxy whose URL is malformed ({error}); expected something "
            "like http://proxy:3128"
        ) from None
    return parts


def without_password(proxy: str) -> str:
    """The URL of a proxy for messages, without name and password."""
    parts = urlsplit(proxy)
    return parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()


def _is_excepted(host: str, exceptions: str) -> bool:
    """Whether ``no_proxy`` holds a network with this address, which urllib doesn't look for."""
    address = _address(host)
    for entry in exceptions.split(","):
        try:
            network = ipaddress.ip_network(entry.strip().strip("[]"), strict=False)
        except ValueError:
            continue
        if address is not None and address in network:
            return True
    return False


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None
