"""Requests to addresses that people wrote down: never to the inside of the house, never anywhere else than looked at.

The name is looked up once; every address that it stands for must be allowed, and the connection goes to one of these,
so that a name which changes its mind between look and call gains nothing. Redirects are answers, not orders, variables
for proxies are not looked at, and of the answer nothing is read but its status. All of it has to be over by a deadline.
"""

import socket
import time
from collections.abc import Iterable, Mapping, Sequence
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network
from typing import Any
from urllib.parse import urlsplit

import httpcore
import httpx

from backend.platform.reasons import reason_of

LONGEST_S = 10.0
Network = IPv4Network | IPv6Network
# What looks like an address of the world and leads to one within: 6to4, Teredo, and IPv4 behind an IPv6 gateway.
_WRAPPERS = tuple(ip_network(block) for block in ("2002::/16", "2001::/32", "64:ff9b::/96", "64:ff9b:1::/48"))


class NotAllowed(Exception):
    """Nothing is sent there."""


class Unreachable(Exception):
    """It could not be sent, this time."""


def check_address(address: str, allowed: Iterable[Network]) -> None:
    """Refuse what could never be sent to, as far as the address itself tells. Raises `NotAllowed`."""
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        raise NotAllowed("is not an address such as https://example.org/hook") from None
    if parts.scheme not in ("http", "https") or not host or port == 0 or not address.isascii():
        raise NotAllowed("must be an address such as https://example.org/hook")
    if parts.username is not None or parts.password is not None:
        raise NotAllowed("must not hold a user or a password")
    if any(character.isspace() or not character.isprintable() for character in address):
        raise NotAllowed("must not hold spaces")
    if host == "localhost" or host.endswith(".localhost"):
        host = "127.0.0.1"
    try:
        found = ip_address(host.partition("%")[0])
    except ValueError:
        return  # a name: what it stands for is looked at whenever something is sent
    _demand(found, tuple(allowed))


def post(address: str, body: bytes, headers: Mapping[str, str], *, allowed: Sequence[Network] = ()) -> int:
    """Send `body`, and answer the status of the answer. Raises `NotAllowed` and `Unreachable`."""
    check_address(address, allowed)
    timeout = dict.fromkeys(("connect", "read", "write", "pool"), LONGEST_S)
    backend = _Looking(tuple(allowed), time.monotonic() + LONGEST_S)
    try:
        with (
            httpcore.ConnectionPool(ssl_context=httpx.create_ssl_context(), network_backend=backend) as pool,
            pool.stream(
                "POST", address, headers=[*headers.items()], content=body, extensions={"timeout": timeout}
            ) as answer,
        ):
            return answer.status
    except httpcore.TimeoutException:
        raise Unreachable(f"no answer within {LONGEST_S:.0f} seconds") from None
    except (httpcore.NetworkError, httpcore.ProtocolError, OSError) as problem:
        raise Unreachable(reason_of(problem)) from None


def _demand(found: IPv4Address | IPv6Address, allowed: Sequence[Network]) -> None:
    if isinstance(found, IPv6Address) and found.ipv4_mapped is not None:
        found = found.ipv4_mapped
    if any(found in network for network in allowed):
        return
    is_wrapped = any(found in block for block in _WRAPPERS)
    if not found.is_global or found.is_multicast or is_wrapped:
        raise NotAllowed("leads to an address inside this network, to which nothing is sent")


class _Looking(httpcore.NetworkBackend):
    """Connects only to addresses that were looked at."""

    def __init__(self, allowed: Sequence[Network], deadline_s: float) -> None:
        self._allowed = allowed
        self._deadline_s = deadline_s
        self._plain = httpcore.SyncBackend()

    def connect_tcp(
        self,
        host: str,
        port: int,
        timeout: float | None = None,  # noqa: ARG002 - ours is the deadline
        local_address: str | None = None,
        socket_options: Iterable[Any] | None = None,
    ) -> httpcore.NetworkStream:
        problem: Exception = Unreachable("the name is not known")
        for address in self._addresses(host, port):
            try:
                stream = self._plain.connect_tcp(
                    address, port, _left_s(self._deadline_s), local_address, socket_options
                )
            except httpcore.NetworkError as met:
                problem = met
                continue
            return _Bounded(stream, self._deadline_s)
        raise problem

    def _addresses(self, host: str, port: int) -> list[str]:
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        except (OSError, UnicodeError) as problem:
            raise Unreachable(f"the name {host} is not known: {problem}") from None
        addresses = list(dict.fromkeys(str(place[4][0]) for place in found))
        for address in addresses:
            _demand(ip_address(address.partition("%")[0]), self._allowed)
        return addresses


class _Bounded(httpcore.NetworkStream):
    """A connection that ends by the deadline, however slowly the other side drips."""

    def __init__(self, stream: httpcore.NetworkStream, deadline_s: float) -> None:
        self._stream = stream
        self._deadline_s = deadline_s

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:  # noqa: ARG002
        return self._stream.read(max_bytes, _left_s(self._deadline_s))

    def write(self, buffer: bytes, timeout: float | None = None) -> None:  # noqa: ARG002
        self._stream.write(buffer, _left_s(self._deadline_s))

    def close(self) -> None:
        self._stream.close()

    def start_tls(
        self,
        ssl_context: Any,
        server_hostname: str | None = None,
        timeout: float | None = None,  # noqa: ARG002
    ) -> httpcore.NetworkStream:
        secured = self._stream.start_tls(ssl_context, server_hostname, _left_s(self._deadline_s))
        return _Bounded(secured, self._deadline_s)

    def get_extra_info(self, info: str) -> Any:
        return self._stream.get_extra_info(info)


def _left_s(deadline_s: float) -> float:
    left_s = deadline_s - time.monotonic()
    if left_s <= 0:
        raise httpcore.ReadTimeout
    return left_s
