"""Chromium, as the tests drive it."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, sync_playwright

from tests.services import ROOT

NAMES = ("chromium", "chromium-browser", "google-chrome")
# Without a sandbox, for the tests may run as root; the rest keeps the browser from calling home.
FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
AXE = ROOT / "frontend" / "node_modules" / "axe-core" / "axe.min.js"
SERIOUS = ("serious", "critical")


def chromium() -> str:
    """The browser's path; a test that needs one fails with what to do where there is none."""
    found = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.fail(
            "No Chromium here. Install it (sudo apt-get install chromium) or name one: CHROMIUM=/path/to/chrome"
        )
    return found


@contextmanager
def open_page(base_url: str) -> Iterator[Page]:
    """A page of a fresh browser; its errors are the test's."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=list(FLAGS))
        try:
            page = browser.new_context(base_url=base_url, viewport={"width": 1280, "height": 900}).new_page()
            page.set_default_timeout(15_000)
            errors: list[str] = []
            page.on("pageerror", lambda error: errors.append(str(error)))
            yield page
            assert errors == []
        finally:
            browser.close()


def drop(page: Page, target: str, *paths: Path) -> None:
    """Drop files and folders from the desktop on the element that shows `target`."""
    box = page.get_by_text(target).bounding_box()
    assert box is not None
    place = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}
    data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    session = page.context.new_cdp_session(page)
    for kind in ("dragEnter", "dragOver", "drop"):
        session.send("Input.dispatchDragEvent", {"type": kind, "data": data, **place})


def serious_findings(page: Page) -> list[str]:
    """What axe finds that keeps somebody out, one line each."""
    if page.evaluate("typeof window.axe") == "undefined":
        page.add_script_tag(path=str(AXE))
    found: dict[str, Any] = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    return [
        f"{finding['id']}: {finding['help']} ({', '.join(str(node['target']) for node in finding['nodes'])})"
        for finding in found["violations"]
        if finding["impact"] in SERIOUS
    ]
