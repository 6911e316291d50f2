"""Webhooks: told once what happened, signed, and again and again until it is taken."""

import base64
import hashlib
import hmac
import json
import re
import threading
from collections.abc import Callable
from typing import Any
from uuid import UUID

import httpx

from backend.models import Right
from tests.lab import ADDRESS, Lab
from tests.notices import ended, log_of, made, make_due, told
from tests.receiver import Receiver, running_receiver
from tests.services import ROOT
from worker.notices import PAUSES_S, claim, record
from worker.sending import Outcome

DOCUMENTED = ROOT / "docs" / "how-to" / "notifications.md"


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
