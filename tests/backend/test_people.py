"""People sign in, join groups, use tokens; and what a group may use is kept."""

from datetime import timedelta

import httpx
import pytest

from backend.models import Right, Scope
from tests.films import EXPERIMENT
from tests.lab import Lab

PASSWORD = "correct horse battery staple"  # noqa: S105


def test_a_password_lets_its_person_in_and_no_other(lab: Lab) -> None:
    ada = lab.person("Ada", password=PASSWORD)
    browser, said = lab.nobody(), {"email": lab.email(ada).upper(), "password": PASSWORD}
    wrong = browser.post("session", json=said | {"password": "guessed"})
    unknown = browser.post("session", json=said | {"email": "nobody@dropflow.test"})
    assert wrong.status_code == unknown.status_code == 401
    assert wrong.json() == unknown.json(), "who has an account is not told"
    made = browser.post("session", json=said)
    assert made.status_code == 201
    cookie = made.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=lax" in cookie
    assert made.json()["person"]["name"] == "Ada"
    assert [group["is_personal"] for group in made.json()["groups"]] == [True]
    assert browser.delete("session").status_code == 204
    assert browser.get("session").json()["person"] is None


def test_a_signed_out_session_is_over_for_whoever_kept_its_cookie(lab: Lab) -> None:
    browser = lab.browser(lab.person("Ada"))
    kept = dict(browser.cookies)
    assert browser.delete("session").status_code == 204
    thief = lab.nobody()
    thief.cookies.update(kept)
    assert thief.get("account").status_code == 401


def test_a_new_password_signs_every_other_browser_out(lab: Lab) -> None:
    ada = lab.person("Ada", password=PASSWORD)
    here, there = lab.browser(ada), lab.browser(ada)
    wrong = here.put("account/password", json={"old": "guessed", "new": "another battery"})
    assert (wrong.status_code, wrong.json()["errors"][0]["field"]) == (422, "old")
    assert here.put("account/password", json={"old": PASSWORD, "new": "another battery"}).status_code == 204
    assert here.get("account").status_code == 200
    assert there.get("account").status_code == 401


def test_who_is_locked_out_has_no_session_and_no_token_any_more(lab: Lab) -> None:
    ada = lab.person("Ada", {lab.group("Foams"): Right.EDIT})
    browser, program = lab.browser(ada), lab.program(ada, Scope.READ)
    assert program.get("experiments").status_code == 200
    admin = lab.browser(lab.administrator)
    assert admin.patch(f"people/{ada}", json={"is_disabled": True}).status_code == 200
    assert browser.get("experiments").status_code == program.get("experiments").status_code == 401


def test_the_last_administrator_stays_one(lab: Lab) -> None:
    admin = lab.browser(lab.administrator)
    for change in ({"is_administrator": False}, {"is_disabled": True}):
        answer = admin.patch(f"people/{lab.administrator}", json=change)
        assert (answer.status_code, answer.json()["code"]) == (409, "conflict.last_administrator")


def test_a_link_lets_somebody_choose_a_password_once(lab: Lab) -> None:
    admin = lab.browser(lab.administrator)
    made = admin.post("people", json={"name": "Grace", "email": "grace@dropflow.test"})
    secret = made.json()["link"].partition("#")[2]
    browser = lab.nobody()
    assert browser.post("session", json={"link": secret}).status_code == 201
    assert browser.put("account/password", json={"new": PASSWORD}).status_code == 204
    assert lab.nobody().post("session", json={"link": secret}).json()["code"] == "session.link_spent"
    said = {"email": "grace@dropflow.test", "password": PASSWORD}
    assert lab.nobody().post("session", json=said).status_code == 201


def test_an_invitation_lets_one_person_in(lab: Lab) -> None:
    group = lab.group("Foams")
    manager = lab.browser(lab.person("Ada", {group: Right.MANAGE}))
    made = manager.post(f"groups/{group}/invitations", json={"right": "edit", "days": 7}).json()
    secret = made["link"].partition("#")[2]
    assert secret not in manager.get(f"groups/{group}/invitations").text
    newcomer = lab.nobody()
    assert newcomer.post("invitations/look", json={"secret": secret}).json()["group_name"] == "Foams"
    account = {"name": "Émilie", "email": "emilie@dropflow.test", "password": PASSWORD}
    joined = newcomer.post("invitations/accept", json={"secret": secret, "account": account})
    assert {found["right"] for found in joined.json()["groups"]} == {"manage", "edit"}
    second = lab.browser(lab.person("Eve")).post("invitations/accept", json={"secret": secret})
    assert (second.status_code, second.json()["code"]) == (404, "not_found.invitation")


def test_somebody_always_manages_a_group(lab: Lab) -> None:
    group = lab.group("Foams")
    ada = lab.person("Ada", {group: Right.MANAGE})
    browser = lab.browser(ada)
    for answer in (
        browser.put(f"groups/{group}/members/{ada}", json={"right": "view"}),
        browser.delete(f"groups/{group}/members/{ada}"),
    ):
        assert (answer.status_code, answer.json()["code"]) == (409, "conflict.last_manager")
    own = browser.get("session").json()["groups"][0]["id"]
    assert browser.post(f"groups/{own}/invitations", json={}).json()["code"] == "conflict.personal_group"


def test_a_token_is_shown_once_does_what_its_scope_says_and_ends(lab: Lab) -> None:
    ada = lab.person("Ada")
    browser = lab.browser(ada)
    made = browser.post("tokens", json={"name": "microscope", "scope": "submit", "days": 1}).json()
    assert made["secret"] not in browser.get("tokens").text
    program = httpx.Client(base_url=browser.base_url, headers={"Authorization": f"Bearer {made['secret']}"})
    with program:
        assert program.post("experiments", json={"experiment": EXPERIMENT}).status_code == 201
        assert program.get("tokens").json()["code"] == "forbidden.account"
        assert browser.get("tokens").json()["items"][0]["used_at"] is not None
        assert browser.delete(f"tokens/{made['id']}").status_code == 204
        assert program.get("experiments").json()["code"] == "token.unknown"
    assert lab.program(ada, Scope.READ, lasts=timedelta(0)).get("runs").json()["code"] == "token.expired"
    reader = lab.program(ada, Scope.READ)
    assert reader.post("experiments", json={"experiment": EXPERIMENT}).json()["code"] == "forbidden.scope"


def test_a_wrong_token_is_nobody_even_beside_a_good_cookie(lab: Lab) -> None:
    browser = lab.browser(lab.person("Ada"))
    assert browser.get("account", headers={"Authorization": "Bearer df_guessed"}).status_code == 401


def test_a_shared_run_is_all_that_its_visitor_sees(lab: Lab) -> None:
    group = lab.group("Foams")
    experiment, run = lab.finished(group)
    _, other = lab.finished(group)
    editor = lab.browser(lab.person("Ada", {group: Right.EDIT}))
    share = editor.post(f"runs/{run}/shares", json={"days": 1}).json()
    visitor = lab.nobody()
    secret = share["link"].partition("#")[2]
    assert visitor.post("session", json={"share": secret}).json()["shared_run_id"] == str(run)
    assert visitor.get(f"runs/{run}").status_code == visitor.get(f"experiments/{experiment}").status_code == 200
    assert visitor.get(f"runs/{other}").status_code == 404
    assert [found["id"] for found in visitor.get("runs").json()["items"]] == [str(run)]
    assert visitor.delete(f"runs/{run}").status_code == 403
    assert editor.delete(f"runs/{run}/shares/{share['id']}").status_code == 204
    assert visitor.get(f"runs/{run}").status_code == 401


def test_a_full_group_takes_nothing_more_before_it_is_sent(lab: Lab) -> None:
    group = lab.group("Foams")
    ada = lab.as_(lab.person("Ada", {group: Right.EDIT}))
    made = ada.api.post("experiments", json={"experiment": EXPERIMENT, "group_id": str(group)}).json()
    admin = lab.browser(lab.administrator)
    limits = {"max_bytes": 1000, "max_active_runs": 1}
    assert admin.put(f"groups/{group}/limits", json=limits).json()["usage"]["max_bytes"] == 1000
    wrong = admin.put(f"groups/{group}/limits", json=limits | {"max_bytes": False})
    assert (wrong.status_code, wrong.json()["errors"][0]["field"]) == (422, "max_bytes")
    plan = {"files": [{"name": f"{n}.tif", "size_bytes": 400} for n in range(3)]}
    refused = ada.api.post(f"experiments/{made['id']}/uploads/plan", json=plan)
    assert (refused.status_code, refused.json()["code"]) == (413, "quota.bytes")
    fits = {"files": plan["files"][:2]}
    assert ada.api.post(f"experiments/{made['id']}/uploads/plan", json=fits).status_code == 200
    usage = ada.api.get(f"groups/{group}").json()["usage"]
    assert usage["used_bytes"] == 800, "what was announced counts"
    put = ada.api.put(f"experiments/{made['id']}/files", params={"name": "b.tif"}, content=b"II*\0" + bytes(600))
    assert (put.status_code, put.json()["code"]) == (413, "quota.bytes")


def test_who_did_what_is_written_down(lab: Lab) -> None:
    group = lab.group("Foams")
    ada = lab.as_(lab.person("Ada", {group: Right.EDIT}))
    made = ada.api.post("experiments", json={"experiment": EXPERIMENT, "group_id": str(group)}).json()
    assert ada.api.delete(f"experiments/{made['id']}").status_code == 204
    assert ada.api.delete(f"experiments/{made['id']}").status_code == 404
    admin = lab.browser(lab.administrator)
    lines = admin.get("administration/audit", params={"action": "experiments_delete"}).json()["items"]
    found = [line for line in lines if line["about"]["experiment_id"] == made["id"]]
    assert [(line["person_name"], line["via"], line["about"]["name"]) for line in found] == [
        ("Ada", "session", EXPERIMENT["name"])
    ]


@pytest.mark.parametrize("name", ["", "two\nlines", "turned\u202earound", "null\0", "x" * 201])
def test_a_name_is_one_honest_line(lab: Lab, name: str) -> None:
    answer = lab.browser(lab.person("Ada")).post("groups", json={"name": name})
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, "name")
