"""Webhooks and e-mail: told once what happened, signed, again and again until it is taken, and never to the inside."""

import base64
import hashlib
import hmac
import json
import re
import socket
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any
from uuid import UUID

import httpx
import pytest
from sqlalchemy import func, select, update

from backend.models import Notice, NoticeState, Person, Right, Run
from backend.models.lifecycle import end_run
from backend.models.states import RunState
from backend.platform import outward
from backend.platform.outward import NotAllowed, Unreachable, check_address, post
from backend.platform.settings import Settings
from deploy.local.postgres import Postgres
from deploy.local.valkey import Valkey
from tests.house import Json, house_settings
from tests.lab import ADDRESS, Lab, lab_settings, open_lab
from tests.receiver import MailServer, Receiver, running_mail_server, running_receiver
from tests.services import ROOT, database
from worker.context import Context
from worker.notices import PAUSES_S, claim, record, tell_round
from worker.sending import Outcome

HERE = ("127.0.0.0/8",)
DOCUMENTED = ROOT / "docs" / "how-to" / "notifications.md"


@pytest.fixture(scope="module")
def open_door(
    postgres_server: Postgres,
    migrated_template: str,
    valkey_server: Valkey,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Lab]:
    """A service that may send to this machine."""
    with database(postgres_server, template=migrated_template) as url:
        settings = house_settings(url, valkey_server.url(5), tmp_path_factory.mktemp("door"))
        with open_lab(lab_settings(settings, outward_networks=HERE)) as opened:
            yield opened


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with running_receiver() as running:
        yield running


@pytest.fixture
def mailbox() -> Iterator[MailServer]:
    with running_mail_server() as running:
        yield running


@pytest.fixture
def group(open_door: Lab) -> UUID:
    with open_door.house.context.sessions.begin() as session:
        session.query(Notice).delete()
    return open_door.group("Foams")


@pytest.fixture
def ada(open_door: Lab, group: UUID) -> UUID:
    return open_door.person("Ada", {group: Right.MANAGE})


@pytest.fixture
def browser(open_door: Lab, ada: UUID) -> httpx.Client:
    return open_door.browser(ada)


def made(browser: httpx.Client, group: UUID, receiver: Receiver, **about: object) -> Json:
    answer = browser.post(f"groups/{group}/webhooks", json={"address": receiver.address, **about})
    assert answer.status_code == 201, answer.text
    body: Json = answer.json()
    return body


def ended(lab: Lab, group: UUID, how: str, person: UUID | None = None) -> UUID:
    """A run that ends just now."""
    _, run_id = lab.finished(group)
    with lab.house.context.sessions.begin() as session:
        run = session.get_one(Run, run_id)
        run.state, run.person_id = RunState.RUNNING, person
        session.flush()
        problem = {"detail": "Frame 3 cannot be read.", "hint": "Replace it.", "code": "frames.corrupt"}
        end_run(session, run, how, problem=problem if how == "fail" else None)
    return run_id


def told(context: Context) -> int:
    """Send what is due; how many that were."""
    with ThreadPoolExecutor(4) as pool:
        return tell_round(context, pool)


def make_due(lab: Lab) -> None:
    """Let the pause after a failure pass."""
    with lab.house.context.sessions.begin() as session:
        session.execute(update(Notice).values(due_at=func.now(), held_until=None))


def log_of(browser: httpx.Client, group: UUID, webhook: Json) -> list[Json]:
    answer = browser.get(f"groups/{group}/webhooks/{webhook['id']}/notices")
    assert answer.status_code == 200, answer.text
    items: list[Json] = answer.json()["items"]
    return items


def documented_check() -> Callable[[str, dict[str, str], bytes], bool]:
    """What the documentation tells receivers to do."""
    (code,) = re.findall(r"```python\n(.*?)```", DOCUMENTED.read_text(encoding="utf-8"), re.S)
    names: dict[str, Any] = {}
    exec(code, names)  # noqa: S102 - our own page
    found: Callable[[str, dict[str, str], bytes], bool] = names["is_genuine"]
    return found


def test_the_end_of_a_run_is_told_once_and_signed(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    run = ended(open_door, group, "complete")
    ended(open_door, open_door.group("Others"), "complete")
    assert (told(open_door.house.context), told(open_door.house.context)) == (1, 0)
    [(headers, body)] = receiver.came
    said = json.loads(body)
    assert said["type"] == "run.completed"
    assert said["data"]["run"] == {"id": str(run), "number": 1, "state": "completed", "problem": None}
    assert said["data"]["address"] == f"{ADDRESS}runs/{run}"
    key = base64.b64decode(webhook["secret"].removeprefix("whsec_"))
    content = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    expected = base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    assert headers["webhook-signature"] == f"v1,{expected}"
    assert documented_check()(webhook["secret"], headers, body)
    assert not documented_check()(webhook["secret"], headers, body + b" ")
    [line] = log_of(browser, group, webhook)
    assert (line["id"], line["state"], line["next_try_at"]) == (headers["webhook-id"], "delivered", None)
    assert [(attempt["status"], attempt["problem"]) for attempt in line["tries"]] == [(204, None)]


def test_the_secret_is_shown_once_and_another_one_signs_from_then_on(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    address = f"groups/{group}/webhooks"
    assert "secret" not in browser.get(address).json()["items"][0]
    assert webhook["secret"] not in browser.get(address).text
    other = browser.post(f"{address}/{webhook['id']}/secret").json()["secret"]
    assert other != webhook["secret"]
    browser.post(f"{address}/{webhook['id']}/test").raise_for_status()
    told(open_door.house.context)
    headers, body = receiver.came[-1]
    key = base64.b64decode(other.removeprefix("whsec_"))
    content = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    assert headers["webhook-signature"].endswith(
        base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    )


def test_a_webhook_is_told_what_it_asks_for_and_nothing_while_it_is_paused(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver, events=["run.failed"])
    ended(open_door, group, "complete")
    ended(open_door, group, "fail")
    assert told(open_door.house.context) == 1
    assert json.loads(receiver.came[0][1])["data"]["run"]["problem"]["code"] == "frames.corrupt"
    address = f"groups/{group}/webhooks/{webhook['id']}"
    browser.patch(address, json={"is_active": False}).raise_for_status()
    ended(open_door, group, "fail")
    assert browser.post(f"{address}/test").json()["code"] == "conflict.webhook_paused"
    assert told(open_door.house.context) == 0


def test_what_is_not_taken_is_sent_again_under_the_same_id_until_it_is(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    receiver.statuses = [500, 404, 200]
    ended(open_door, group, "complete")
    assert told(open_door.house.context) == 1
    assert told(open_door.house.context) == 0, "not before the pause is over"
    for _ in range(3):
        make_due(open_door)
        told(open_door.house.context)
    assert len(receiver.ids) == 3
    assert len(set(receiver.ids)) == 1
    [line] = log_of(browser, group, webhook)
    assert [attempt["status"] for attempt in line["tries"]] == [500, 404, 200]
    assert line["state"] == "delivered"


def test_a_receiver_that_is_away_for_good_is_given_up_with_every_try_in_the_log(
    open_door: Lab, browser: httpx.Client, group: UUID
) -> None:
    with running_receiver() as gone:
        webhook = made(browser, group, gone)
    ended(open_door, group, "complete")
    for _ in range(len(PAUSES_S) + 3):
        told(open_door.house.context)
        make_due(open_door)
    [line] = log_of(browser, group, webhook)
    assert line["state"] == "failed"
    assert len(line["tries"]) == len(PAUSES_S) + 1
    assert "refused" in line["tries"][0]["problem"]


def test_whoever_says_that_it_is_gone_for_good_is_believed(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    receiver.statuses = [410]
    ended(open_door, group, "complete")
    told(open_door.house.context)
    assert log_of(browser, group, webhook)[0]["state"] == "failed"


def test_two_that_send_at_once_never_send_the_same(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    for _ in range(6):
        made(browser, group, receiver)
    ended(open_door, group, "complete")
    threads = [threading.Thread(target=told, args=(open_door.house.context,)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    told(open_door.house.context)
    assert len(receiver.ids) == len(set(receiver.ids)) == 6


def test_whoever_dies_while_sending_loses_nothing_and_a_late_word_changes_nothing(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    ended(open_door, group, "complete")
    context = open_door.house.context
    with context.sessions.begin() as session:
        [dead] = claim(session)
    assert told(context) == 0, "it is held"
    make_due(open_door)  # its time is over
    assert told(context) == 1
    with context.sessions.begin() as session:
        late = Outcome(status=500, problem="late", is_delivered=False, is_final=True)
        record(session, dead, {"at": "2026-01-01T00:00:00Z", "seconds": 1.0, **late})
    [line] = log_of(browser, group, webhook)
    assert (line["state"], len(line["tries"])) == ("delivered", 1)
    assert receiver.ids == [str(dead.id)]


def test_a_slow_receiver_holds_up_no_other(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    with running_receiver() as slow:
        made(browser, group, slow)
        for _ in range(20):
            ended(open_door, group, "complete")
        made(browser, group, receiver)
        ended(open_door, group, "complete")
        assert told(open_door.house.context) == 2
        assert (len(slow.ids), len(receiver.ids)) == (1, 1)


def test_resent_is_what_was_told_under_an_id_of_its_own(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    ended(open_door, group, "complete")
    told(open_door.house.context)
    first = receiver.ids[0]
    address = f"groups/{group}/webhooks/{webhook['id']}/notices/{first}/resend"
    again = browser.post(address)
    assert again.status_code == 202
    assert again.json()["resend_of"] == first
    told(open_door.house.context)
    assert len(set(receiver.ids)) == 2
    assert json.loads(receiver.came[0][1])["data"] == json.loads(receiver.came[1][1])["data"]


def test_a_webhook_and_its_log_are_for_who_manages_its_group(
    open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver
) -> None:
    webhook = made(browser, group, receiver)
    own = open_door.group("Own")
    eve = open_door.browser(open_door.person("Eve", {own: Right.MANAGE}))
    for address in (f"groups/{group}", f"groups/{own}"):
        refused = eve.get(f"{address}/webhooks/{webhook['id']}/notices")
        assert refused.status_code == 404
    assert eve.post(f"groups/{own}/webhooks/{webhook['id']}/secret").json()["code"] == "not_found.webhook"


def test_too_many_webhooks_are_refused(open_door: Lab, browser: httpx.Client, group: UUID, receiver: Receiver) -> None:
    for _ in range(20):
        made(browser, group, receiver)
    answer = browser.post(f"groups/{group}/webhooks", json={"address": receiver.address})
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict.webhooks")


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


def mailing(lab: Lab, mailbox: MailServer) -> Context:
    about = {"smtp_host": "127.0.0.1", "smtp_port": mailbox.port, "smtp_security": "none"}
    settings = Settings.model_validate(
        lab.settings.model_dump() | about | {"mail_from": "Dropflow <lab@dropflow.test>"}
    )
    return replace(lab.house.context, settings=settings)


def test_who_started_a_run_gets_an_e_mail_when_it_ends(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    run = ended(open_door, group, "complete", ada)
    ended(open_door, group, "cancel", ada)
    context = mailing(open_door, mailbox)
    assert (told(context), told(context)) == (1, 0)
    [message] = mailbox.came
    assert message["Subject"] == "Run 1 of five discs: completed"
    assert message["To"] == f"Ada <{open_door.email(ada)}>"
    assert f"{ADDRESS}runs/{run}" in message.get_content()
    ended(open_door, group, "fail", ada)
    told(context)
    assert "Frame 3 cannot be read." in mailbox.came[1].get_content()


def test_no_e_mail_for_who_does_not_want_it_may_not_see_it_or_is_let_in_no_more(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    open_door.browser(ada).patch("account", json={"is_mailed": False}).raise_for_status()
    left, gone = open_door.person("Left"), open_door.person("Gone", {group: Right.EDIT})
    with open_door.house.context.sessions.begin() as session:
        session.get_one(Person, gone).disabled_at = func.now()
    for person in (ada, left, gone):
        ended(open_door, group, "complete", person)
    assert told(mailing(open_door, mailbox)) == 0


def test_a_mail_server_that_is_busy_is_asked_again_and_one_that_knows_nobody_is_not(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    context = mailing(open_door, mailbox)
    mailbox.answer = "451 Come back later"
    ended(open_door, group, "complete", ada)
    told(context)
    mailbox.answer = "250 OK"
    make_due(open_door)
    told(context)
    assert len(mailbox.came) == 1
    mailbox.answer = "550 No such user"
    ended(open_door, group, "complete", ada)
    told(context)
    with context.sessions() as session:
        states = session.scalars(select(Notice.state).order_by(Notice.created_at)).all()
    assert states == [NoticeState.DELIVERED, NoticeState.FAILED]


def test_without_a_mail_server_nothing_is_kept_for_one(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    ended(open_door, group, "complete", ada)
    told(open_door.house.context)
    assert told(mailing(open_door, mailbox)) == 0


def test_header_injection_the_name_of_a_film_adds_no_line_to_an_e_mail(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    run_id = ended(open_door, group, "complete", ada)
    with open_door.house.context.sessions.begin() as session:
        notice = session.scalars(select(Notice).where(Notice.run_id == run_id)).one()
        film = {"id": "1", "name": "a\r\nBcc: everybody@evil.example\r\n\r\nhello"}
        notice.about = notice.about | {"experiment": film}
    told(mailing(open_door, mailbox))
    [message] = mailbox.came
    assert message["Bcc"] is None
    assert message["Subject"] == "Run 1 of a Bcc: everybody@evil.example hello: completed"
