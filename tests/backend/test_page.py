"""The built page beside the API."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from tests.house import House


@pytest.fixture
def site(house: House) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=str(house.api.base_url).removesuffix("/api/v1/")) as client:
        yield client


@pytest.fixture
def dist(house: House) -> Iterator[Path]:
    """What a build leaves."""
    dist = house.context.settings.frontend_dist
    (dist / "assets").mkdir(parents=True)
    (dist / "index.html").write_text('<!doctype html><base href="/"><title>built</title>')
    (dist / "assets" / "app-1a2b.js").write_text("run()")
    (dist.parent / "outside.txt").write_text("private")
    yield dist
    shutil.rmtree(dist)


@pytest.fixture
def page(site: httpx.Client, dist: Path) -> httpx.Client:
    return site


@pytest.mark.parametrize("path", ["/", "/experiments/new", "/runs/6f1e", "/experiments/6f1e?tab=flow"])
def test_every_address_of_the_page_answers_its_index(page: httpx.Client, path: str) -> None:
    answer = page.get(path)
    assert "<title>built</title>" in answer.text
    assert answer.headers["cache-control"] == "no-cache"
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]


def test_assets_are_kept_for_ever_and_missing_ones_are_not_the_index(page: httpx.Client) -> None:
    answer = page.get("/assets/app-1a2b.js")
    assert answer.text == "run()"
    assert "javascript" in answer.headers["content-type"]
    assert "immutable" in answer.headers["cache-control"]
    assert page.get("/assets/gone.js").status_code == 404


@pytest.mark.parametrize("path", ["/api", "/api/v2/health", "/api/v1/nothing"])
def test_what_is_not_in_the_api_is_a_problem_and_not_the_page(page: httpx.Client, path: str) -> None:
    answer = page.get(path)
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("GET", "account/password", "PUT"),
        ("GET", "invitations/accept", "POST"),
        ("PATCH", "experiments/00000000-0000-4000-8000-000000000000/uploads/plan", "POST"),
        ("PUT", "experiments", "GET, POST"),
    ],
)
def test_a_method_that_a_call_has_not_is_refused_with_those_that_it_has(
    page: httpx.Client, method: str, path: str, allowed: str
) -> None:
    answer = page.request(method, f"/api/v1/{path}")
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)


@pytest.mark.parametrize(
    "path", ["/../outside.txt", "/%2e%2e/outside.txt", "/..%2foutside.txt", "/assets/%2e%2e/%2e%2e/outside.txt", "/%00"]
)
def test_nothing_outside_the_build_is_served(page: httpx.Client, path: str) -> None:
    answer = page.get(path)
    assert "private" not in answer.text
    assert answer.status_code in {200, 404}


def test_a_page_that_is_not_built_says_what_to_do(site: httpx.Client) -> None:
    answer = site.get("/")
    assert answer.status_code == 503
    assert "make setup" in answer.text


def test_a_link_out_of_the_build_is_not_followed(page: httpx.Client, dist: Path) -> None:
    (dist / "link.txt").symlink_to(Path("..") / "outside.txt")
    assert "private" not in page.get("/link.txt").text
