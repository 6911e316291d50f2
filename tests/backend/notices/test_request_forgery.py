"""What the service sends goes out into the world, and never to the inside."""

import socket
import threading
from dataclasses import replace
from typing import Any
from uuid import UUID

import httpx
import pytest

from backend.models import Right
from backend.platform import outward
from backend.platform.outward import NotAllowed, Unreachable, check_address, post
from tests.lab import Lab
from tests.notices import log_of, made, told
from tests.receiver import Receiver, running_receiver

INSIDE = [
    "http://127.0.0.1/",
    "http://localhost:5432/",
    "http://a.localhost/",
    "http://[::1]/",
    "http://[::ffff:127.0.0.1]/",
    "http://[64:ff9b::7f00:1]/",
    "http://[2002:7f00:1::]/",
    "http://[fe80::1%25eth0]/",
    "http://10.0.0.1/",
    "http://172.16.3.4/",
    "http://192.168.1.1/",
    "http://169.254.169.254/latest/meta-data/",
    "http://100.64.0.1/",
    "http://0.0.0.0/",
    "http://224.0.0.1/",
    "http://user:password@example.org/",
    "ftp://example.org/",
    "file:///etc/passwd",
    "gopher://example.org/",
    "http:///hook",
    "http://example.org:0/",
    "http://example.org:99999/",
    "http://exa mple.org/",
    "//example.org/",
]


@pytest.mark.parametrize("address", INSIDE)
def test_request_forgery_an_address_inside_is_refused(lab: Lab, address: str) -> None:
    group = lab.group("Foams")
    browser = lab.browser(lab.person("Ada", {group: Right.MANAGE}))
    answer = browser.post(f"groups/{group}/webhooks", json={"address": address})
    assert (answer.status_code, answer.json()["code"]) == (422, "webhook.address")
    assert answer.json()["errors"][0]["field"] == "address"


DISGUISED = ["2130706433", "0x7f.1", "127.1", "0177.0.0.1", socket.gethostname()]


@pytest.mark.parametrize("host", DISGUISED)
def test_request_forgery_a_name_that_stands_for_an_address_inside_gets_nothing(receiver: Receiver, host: str) -> None:
    with pytest.raises((NotAllowed, Unreachable), match=r"inside this network|not known"):
        post(f"http://{host}:{receiver.port}/", b"", {})
    assert receiver.came == []


def test_request_forgery_a_name_that_changes_its_mind_is_looked_up_once(
    receiver: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, looked_up = socket.getaddrinfo, []

    def changing(host: str, port: int, *how: Any, **else_: Any) -> Any:
        """A name server of whoever means harm: first an address that is allowed, then another one within."""
        if host != "changing.example":
            return real(host, port, *how, **else_)
        looked_up.append(host)
        address = "127.0.0.1" if len(looked_up) == 1 else "127.0.0.2"
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, port))]

    monkeypatch.setattr(outward.socket, "getaddrinfo", changing)
    allowed = (outward.ip_network("127.0.0.1/32"),)
    status = post(f"http://changing.example:{receiver.port}/", b"{}", {}, allowed=allowed)
    assert (status, looked_up) == (204, ["changing.example"])
    assert receiver.came[0][0]["host"] == f"changing.example:{receiver.port}"


def test_request_forgery_of_several_addresses_one_inside_is_enough_to_refuse(
    receiver: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    def both(_: str, port: int, **__: object) -> list[object]:
        addresses = ("8.8.8.8", "127.0.0.1")
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, port)) for address in addresses]

    monkeypatch.setattr(outward.socket, "getaddrinfo", both)
    with pytest.raises(NotAllowed):
        post(f"http://both.example:{receiver.port}/", b"", {})
    assert receiver.came == []


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_request_forgery_a_redirect_is_not_followed(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver, status: int
) -> None:
    with running_receiver() as inside:
        webhook = made(browser, group, receiver)
        receiver.statuses, receiver.headers = [status], {"location": inside.address}
        browser.post(f"groups/{group}/webhooks/{webhook['id']}/test").raise_for_status()
        told(open_door.house.context)
        assert inside.came == []
    [line] = log_of(browser, group, webhook)
    assert (line["state"], line["tries"][0]["status"]) == ("waiting", status)


def test_request_forgery_what_was_allowed_before_is_refused_when_it_is_sent(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    browser.post(f"groups/{group}/webhooks/{webhook['id']}/test").raise_for_status()
    context = open_door.house.context
    told(replace(context, settings=context.settings.model_copy(update={"outward_networks": ()})))
    assert receiver.came == []
    assert "inside this network" in log_of(browser, group, webhook)[0]["tries"][0]["problem"]


def test_request_forgery_an_answer_that_drips_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outward, "LONGEST_S", 0.5)
    stop = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def drip() -> None:
            connection, _ = listening.accept()
            with connection:
                connection.sendall(b"HTTP/1.1 200 OK\r\n")
                while not stop.wait(0.1):
                    try:
                        connection.sendall(b"X-Drip: 1\r\n")
                    except OSError:
                        return

        thread = threading.Thread(target=drip)
        thread.start()
        address = f"http://127.0.0.1:{listening.getsockname()[1]}/"
        with pytest.raises(Unreachable, match="no answer"):
            post(address, b"", {}, allowed=(outward.ip_network("127.0.0.0/8"),))
        stop.set()
        thread.join()


def test_an_address_of_the_world_is_taken() -> None:
    for address in ("https://example.org/hook?key=1", "http://8.8.8.8:8080/", "https://[2001:4860:4860::8888]/"):
        check_address(address, ())
