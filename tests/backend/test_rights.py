"""Every operation of the OpenAPI document, asked by everybody who could: who may gets through, and nobody else."""

from dataclasses import dataclass
from typing import Any
from uuid import UUID, uuid4

import httpx
import pytest

from backend.app import bare_app
from backend.models import Right, Scope
from tests.backend.rights import BODIES, NEEDS, VALUES, Json, Needs
from tests.lab import Lab

DOCUMENT = bare_app().openapi()
OPERATIONS = {
    operation["operationId"]: (method.upper(), path.removeprefix("/api/v1/"), operation)
    for path, methods in DOCUMENT["paths"].items()
    for method, operation in methods.items()
}
NO_BODY = "HEAD"
ABSENT = {"not_found.experiment", "not_found.run", "not_found.group"}

MEMBERS = ("viewer", "editor", "manager")
EVERYBODY = ("nobody", "visitor", "stranger", *MEMBERS, "administrator", "reading token", "submitting token")
THROUGH: dict[Needs, set[str]] = {
    Needs.NOTHING: {"nobody", "visitor", "manager", "reading token"},
    Needs.PERSON: set(EVERYBODY) - {"nobody"},
    Needs.ACCOUNT: {"stranger", *MEMBERS, "administrator"},
    Needs.VIEW: {"visitor", *MEMBERS, "reading token", "submitting token"},
    Needs.EDIT: {"editor", "manager", "submitting token"},
    Needs.MEMBER: {*MEMBERS, "reading token", "submitting token"},
    Needs.EDIT_OWN: {"stranger", *MEMBERS, "administrator", "submitting token"},
    Needs.GROUP: {*MEMBERS, "administrator", "reading token", "submitting token"},
    Needs.GROUP_ACCOUNT: {*MEMBERS, "administrator"},
    Needs.MANAGE_GROUP: {"manager", "administrator"},
    Needs.ADMINISTRATOR: {"administrator"},
}
NOT_THERE = {
    Needs.VIEW: {"stranger", "administrator"},
    Needs.EDIT: {"stranger", "administrator"},
    Needs.MEMBER: {"stranger", "administrator", "visitor"},
    Needs.GROUP: {"stranger", "visitor"},
    Needs.GROUP_ACCOUNT: {"stranger"},
    Needs.MANAGE_GROUP: {"stranger"},
}


@dataclass(frozen=True)
class Walk:
    """Somebody of each kind around one group, and the things in it."""

    lab: Lab
    group: UUID
    people: dict[str, UUID]
    things: dict[str, UUID]

    def client(self, who: str) -> httpx.Client:
        if who == "nobody":
            return self.lab.nobody()
        if who == "visitor":
            return self.lab.visitor(self.things["run_id"])
        if who.endswith("token"):
            scope = Scope.READ if who.startswith("reading") else Scope.SUBMIT
            return self.lab.program(self.people["manager"], scope)
        return self.lab.browser(self.people[who])

    def ask(self, operation: str, who: str) -> tuple[int, str]:
        """Status and problem code of an answer; streams are left once they began."""
        method, path, about = OPERATIONS[operation]
        values = {name: str(value) for name, value in self.things.items()}
        values |= VALUES.get(operation, {}) | {"frame": "0"}
        values["person_id"] = str(self.people.get(who, uuid4()))
        address = path.format(**{name: values.get(name) or _unknown(name) for name in _parameters(path)})
        with self.client(who).stream(method, address, **_body(operation, about, self.things)) as answer:
            if answer.status_code < 400:
                return answer.status_code, ""
            answer.read()
            return answer.status_code, answer.json()["code"] if method != "HEAD" else NO_BODY


@pytest.fixture
def walk(lab: Lab) -> Walk:
    group = lab.group("Walk")
    people = {right: lab.person(right, {group: Right(value)}) for right, value in zip(MEMBERS, Right, strict=True)}
    people |= {"stranger": lab.person("stranger"), "administrator": lab.administrator}
    experiment, run = lab.finished(group)
    return Walk(lab, group, people, {"group_id": group, "experiment_id": experiment, "run_id": run})


def _parameters(path: str) -> list[str]:
    return [part.partition("}")[0] for part in path.split("{")[1:]]


def _unknown(name: str) -> str:
    """An id of what is not there: who gets through is told so."""
    assert name.endswith("_id"), f"a path with {{{name}}}: say in VALUES what stands there"
    return str(uuid4())


def _body(operation: str, about: Json, things: dict[str, UUID]) -> Json:
    if operation in BODIES:
        body = BODIES[operation]
        params = {name: str(value).format(**things) for name, value in body.get("params", {}).items()}
        return body | ({"params": params} if params else {})
    content = about.get("requestBody", {}).get("content", {})
    if "application/json" not in content:
        assert not about.get("requestBody", {}).get("required"), f"say in BODIES what {operation} is sent"
        return {}
    schema = content["application/json"]["schema"]
    model = DOCUMENT["components"]["schemas"][schema["$ref"].rpartition("/")[2]] if "$ref" in schema else schema
    assert "examples" in model, f"give the body of {operation} an example"
    body: dict[str, Any] = dict(model["examples"][0])
    if operation in ("experiments_create", "experiments_move"):
        body |= {"group_id": str(things["group_id"])}
    return {"json": body}


def test_every_operation_has_an_expectation() -> None:
    missing = sorted(set(OPERATIONS) - set(NEEDS))
    assert missing == [], "say in tests/backend/rights.py what each of these needs"
    assert sorted(set(NEEDS) - set(OPERATIONS)) == []


@pytest.mark.parametrize("operation", sorted(OPERATIONS))
def test_who_may_gets_through_and_nobody_else(walk: Walk, operation: str) -> None:
    needs = NEEDS[operation]
    refused = [who for who in EVERYBODY if who not in THROUGH[needs] and needs is not Needs.NOTHING]
    for who in refused:
        status, code = walk.ask(operation, who)
        if who == "nobody":
            assert (status, code) in ((401, "session.none"), (401, NO_BODY)), who
        elif who in NOT_THERE.get(needs, set()):
            assert (status, code in ABSENT | {NO_BODY}) == (404, True), (who, status, code)
        else:
            assert (status, code.partition(".")[0]) in ((403, "forbidden"), (403, NO_BODY)), (who, status, code)
    for who in sorted(THROUGH[needs], key=EVERYBODY.index):
        experiment, run = walk.lab.finished(walk.group)
        walk.things.update(experiment_id=experiment, run_id=run)
        if operation == "groups_delete":
            continue
        status, code = walk.ask(operation, who)
        assert status not in (401, 403) or code.startswith("session."), (who, status, code)
        assert status < 500, (who, status, code)
        assert code not in ABSENT | {"request.invalid"}, (who, status, code)


def test_what_does_not_exist_answers_as_what_may_not_be_seen(walk: Walk) -> None:
    client = walk.client("stranger")
    there = client.get(f"runs/{walk.things['run_id']}")
    absent = client.get(f"runs/{uuid4()}")
    assert (there.status_code, there.json()) == (absent.status_code, absent.json())


def test_lists_hold_only_what_one_may_see(walk: Walk) -> None:
    for who in ("stranger", "administrator"):
        assert str(walk.things["experiment_id"]) not in walk.client(who).get("experiments").text
        assert str(walk.things["run_id"]) not in walk.client(who).get("runs").text
    seen = walk.client("viewer").get("experiments").json()["items"]
    assert [item["id"] for item in seen] == [str(walk.things["experiment_id"])]
    assert str(walk.group) not in walk.client("stranger").get("groups").text
    assert str(walk.group) in walk.client("administrator").get("groups").text
