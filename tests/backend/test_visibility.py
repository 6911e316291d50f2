"""What a person may not see is as if it were not there, on every route."""

from collections.abc import Iterator
from uuid import UUID, uuid4

import httpx
import pytest
from sqlalchemy import func

from backend.app import bare_app
from backend.models import Group, Membership, Person
from backend.models import Upload as UploadRow
from backend.platform.dependencies import current_viewer
from backend.platform.visibility import Viewer
from tests.films import EXPERIMENT, PARAMETERS
from tests.house import House, Json

UPLOAD_ID = UUID("00000000-0000-4000-8000-00000000aaaa")
ROUTES = [
    (method.upper(), path.removeprefix("/api/v1/"))
    for path, methods in bare_app().openapi()["paths"].items()
    for method in methods
    if "{experiment_id}" in path or "{run_id}" in path
]
BODIES: dict[tuple[str, str], Json] = {
    ("PATCH", "experiments/{experiment_id}"): {"json": {"experiment": EXPERIMENT}},
    ("POST", "experiments/{experiment_id}/runs"): {"json": {"parameters": PARAMETERS}},
    ("POST", "experiments/{experiment_id}/uploads/plan"): {"json": {"files": [{"name": "a.tif", "size_bytes": 9}]}},
    ("POST", "experiments/{experiment_id}/uploads"): {
        "headers": {"Tus-Resumable": "1.0.0", "Upload-Length": "9", "Upload-Metadata": "filename YS50aWY="}
    },
    ("PATCH", "experiments/{experiment_id}/uploads/{upload_id}"): {
        "headers": {
            "Tus-Resumable": "1.0.0",
            "Upload-Offset": "0",
            "Content-Type": "application/offset+octet-stream",
        },
        "content": b"II*\0",
    },
    ("HEAD", "experiments/{experiment_id}/uploads/{upload_id}"): {"headers": {"Tus-Resumable": "1.0.0"}},
    ("PUT", "experiments/{experiment_id}/files"): {"params": {"name": "a.tif"}, "content": b"II*\0" + bytes(600)},
}


@pytest.fixture(scope="module")
def finished(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    with shared_house.context.sessions.begin() as session:
        files = [{"role": "frames", "name": "a.tif", "size_bytes": 9, "sha256": None}]
        about = {"store_key": "experiments/gone", "expires_at": func.now(), "finished_at": func.now()}
        session.add(
            UploadRow(
                id=UPLOAD_ID, experiment_id=UUID(run["experiment_id"]), files=files, n_files=1, size_bytes=9, **about
            )
        )
    return shared_house.again(run)


@pytest.fixture
def foreigner(shared_house: House) -> Iterator[None]:
    """From now on a person asks who is in a group of their own."""
    person, group = Person(name="Foreigner"), Group(name="Theirs")
    with shared_house.context.sessions.begin() as session:
        session.add_all([person, group])
        session.flush()
        session.add(Membership(person_id=person.id, group_id=group.id))
        viewer = Viewer(person.id)
    shared_house.app.dependency_overrides[current_viewer] = lambda: viewer
    yield
    del shared_house.app.dependency_overrides[current_viewer]


def _ask(house: House, method: str, path: str, run: Json) -> httpx.Response:
    address = path.format(
        experiment_id=run["experiment_id"], run_id=run["id"], upload_id=UPLOAD_ID, frame=0, name=_name(path)
    )
    return house.api.request(method, address, **BODIES.get((method, path), {}))


def _name(path: str) -> str:
    return "size_distribution_before" if "figures" in path else "summary.json"


@pytest.mark.parametrize(("method", "path"), ROUTES)
def test_a_foreigner_finds_nothing(
    shared_house: House, finished: Json, foreigner: None, method: str, path: str
) -> None:
    answer = _ask(shared_house, method, path, finished)
    assert answer.status_code == 404, answer.text
    if method == "HEAD":
        return  # the answer has no body
    assert answer.json()["code"] in {"not_found.experiment", "not_found.run"}


def test_a_foreigner_s_list_is_empty(shared_house: House, finished: Json, foreigner: None) -> None:
    assert shared_house.ok(shared_house.api.get("experiments"))["items"] == []


def test_a_foreigner_makes_experiments_in_their_own_group_only(
    shared_house: House, finished: Json, foreigner: None
) -> None:
    made = shared_house.experiment()
    assert made["group"]["name"] == "Theirs"
    assert shared_house.again(made) == made
    others = shared_house.api.post(
        "experiments", json={"experiment": EXPERIMENT, "group_id": "00000000-0000-4000-8000-000000000002"}
    )
    assert others.status_code == 404
    assert others.json()["code"] == "not_found.group"


@pytest.mark.parametrize(
    ("method", "path"), [route for route in ROUTES if route[0] == "GET" and "events" not in route[1]]
)
def test_a_member_finds_everything(shared_house: House, finished: Json, method: str, path: str) -> None:
    assert _ask(shared_house, method, path, finished).status_code == 200


def test_a_member_of_another_group_shares_what_belongs_to_it(shared_house: House, finished: Json) -> None:
    colleague = Person(name="Colleague")
    with shared_house.context.sessions.begin() as session:
        session.add(colleague)
        session.flush()
        session.add(Membership(person_id=colleague.id, group_id=UUID(_group_of(shared_house, finished))))
        viewer = Viewer(colleague.id)
    shared_house.app.dependency_overrides[current_viewer] = lambda: viewer
    try:
        assert shared_house.again(finished) == finished
    finally:
        del shared_house.app.dependency_overrides[current_viewer]


def test_what_does_not_exist_answers_as_what_may_not_be_seen(shared_house: House, finished: Json) -> None:
    absent = {"id": str(uuid4()), "experiment_id": str(uuid4())}
    answer = _ask(shared_house, "GET", "runs/{run_id}", absent)
    assert (answer.status_code, answer.json()["code"]) == (404, "not_found.run")


def _group_of(house: House, run: Json) -> str:
    answer = house.ok(house.api.get(f"experiments/{run['experiment_id']}"))
    return str(answer["group"]["id"])
