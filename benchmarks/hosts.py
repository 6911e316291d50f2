"""Hosts for benchmarks: network namespaces of this machine, joined by a bridge that lies in the server's own.

Nothing is opened to any other machine. Nothing of it is left afterwards, ended by a signal or not; what one that was
killed has left, the next takes away. It needs Linux, root and iproute2.
"""

import ctypes
import os
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from deploy.local.signals import StopRequested, stop_on_signals

LOOPBACK = "127.0.0.1"
_NET = "10.99.0"
_NAMESPACES = Path("/run/netns")
_NEW_NETWORK = 0x40000000


@dataclass(frozen=True)
class Network:
    """Where servers listen, and what a command is preceded by to run on each host."""

    address: str
    hosts: tuple[tuple[str, ...], ...]


@contextmanager
def network(n_hosts: int) -> Iterator[Network]:
    """Move this process into a namespace for servers, with `n_hosts` others that reach it; 0: stay, with one host."""
    if not n_hosts:
        yield Network(LOOPBACK, ((),))
        return
    if os.geteuid() != 0:
        raise SystemExit("Hosts are network namespaces, which need root: leave --hosts out, or run it as root.")
    _remove_left_over()
    server = f"df-{os.getpid()}"
    names = [f"{server}-{number}" for number in range(1, n_hosts + 1)]
    here = os.open("/proc/self/ns/net", os.O_RDONLY)
    with stop_on_signals():
        try:
            _make(server, names)
            _enter(os.open(_NAMESPACES / server, os.O_RDONLY))
            yield Network(f"{_NET}.1", tuple(("ip", "netns", "exec", name) for name in names))
        except StopRequested:
            raise SystemExit("Ended by a signal.") from None
        finally:
            _enter(here)
            _remove(*names, server)


def _remove_left_over() -> None:
    """The namespaces of processes that are no more."""
    for path in _NAMESPACES.glob("df-*"):
        if not Path("/proc", path.name.split("-")[1]).exists():
            _remove(path.name)


def _remove(*names: str) -> None:
    for name in names:
        if Path(_NAMESPACES, name).exists():
            _ip("netns", "delete", name)


def _make(server: str, names: Sequence[str]) -> None:
    for name in (server, *names):
        _ip("netns", "add", name)
        _ip("-n", name, "link", "set", "lo", "up")
    _ip("-n", server, "link", "add", "bridge", "type", "bridge")
    _ip("-n", server, "addr", "add", f"{_NET}.1/24", "dev", "bridge")
    _ip("-n", server, "link", "set", "bridge", "up")
    for number, name in enumerate(names, 1):
        _ip("-n", server, "link", "add", f"to{number}", "type", "veth", "peer", "name", "net", "netns", name)
        _ip("-n", server, "link", "set", f"to{number}", "master", "bridge", "up")
        _ip("-n", name, "addr", "add", f"{_NET}.{10 + number}/24", "dev", "net")
        _ip("-n", name, "link", "set", "net", "up")


def _enter(namespace: int) -> None:
    """Move this thread, and all processes that it starts from now on."""
    if ctypes.CDLL(None, use_errno=True).setns(namespace, _NEW_NETWORK):
        raise OSError(ctypes.get_errno(), "setns")
    os.close(namespace)


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True)
