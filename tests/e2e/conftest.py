"""A browser on the running service; what it showed is kept where a test fails."""

from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import open_page
from tests.e2e.film import simulate
from tests.services import RunningService

FAILED = pytest.StashKey[bool]()
# Nothing here measures how quick the page is: a busy machine may take its time.
expect.set_options(timeout=30_000)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.when == "call":
        item.stash[FAILED] = report.failed
    return report


@pytest.fixture
def page(service: RunningService, request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Page]:
    with open_page(service.url) as opened:
        yield opened
        if request.node.stash.get(FAILED, False):
            picture = tmp_path / "page.png"
            opened.screenshot(path=picture, full_page=True)
            request.node.add_report_section("call", "page", f"The page as it was: {picture}")


@pytest.fixture(scope="session")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("e2e") / "film"
    simulate(folder)
    return folder
