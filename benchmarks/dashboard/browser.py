"""Chromium on the page of a run: what a person does, and how long until nothing moves any more."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from tests.e2e.browser import FLAGS, chromium

QUIET_MS, LONGEST_S = 250, 30
WATCH = Path(__file__).with_name("watch.js")
_BEGIN = "() => { Object.assign(window.dropflowActivity, { began_ms: 0, last_ms: 0, answered_ms: 0 }); }"
_SETTLED = f"""() => {{
  const {{ n_open, last_ms }} = window.dropflowActivity;
  return n_open === 0 && last_ms > 0 && performance.now() - last_ms > {QUIET_MS}
    && !document.querySelector('[aria-label="Loading"]');
}}"""
_TOOK = (
    "() => [window.dropflowActivity.answered_ms, window.dropflowActivity.last_ms - window.dropflowActivity.began_ms]"
)
Act = Callable[[Page], object]


@dataclass(frozen=True)
class Answer:
    """What somebody waits for after an input."""

    seen_ms: float
    """Until the next picture of the page ("Interaction to Next Paint", in steps of 8 ms; less than 16 counts as 16)."""
    whole_ms: float
    """Until the last change that followed, of the document or a canvas."""


@contextmanager
def browser() -> Iterator[Browser]:
    """A browser that is gone afterwards."""
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium(), args=list(FLAGS))
        try:
            yield opened
        finally:
            opened.close()


def opened(window: Browser, address: str) -> tuple[Page, float]:
    """A page in a fresh profile, and the seconds until all of it stands there: nothing comes from a cache."""
    page = window.new_context(viewport={"width": 1280, "height": 900}).new_page()
    page.add_init_script(path=WATCH)
    page.goto(address)
    page.wait_for_function(_SETTLED, timeout=LONGEST_S * 1e3)
    last_ms: float = page.evaluate("() => window.dropflowActivity.last_ms")
    return page, last_ms / 1e3


def answer(page: Page, act: Act) -> Answer:
    """From the input (a key pressed, a pointer let go) to what the page shows of it, first and last."""
    time.sleep(0.2)
    page.evaluate(_BEGIN)
    act(page)
    page.wait_for_function(_SETTLED, timeout=LONGEST_S * 1e3)
    seen_ms, whole_ms = page.evaluate(_TOOK)
    return Answer(max(16.0, seen_ms), whole_ms)


def tab(name: str) -> Act:
    """Choose a tab."""
    return lambda page: page.get_by_role("tab", name=name, exact=True).click()


def drawn_over(label: str, left: float, right: float, low: float, high: float) -> Act:
    """Draw a rectangle in a plot; shares of its width and height."""

    def act(page: Page) -> None:
        box = page.get_by_role("figure", name=label).locator(".nsewdrag").first.bounding_box()
        assert box is not None
        at = [
            (box["x"] + share * box["width"], box["y"] + up * box["height"])
            for share, up in ((left, low), (right, high))
        ]
        page.mouse.move(*at[0])
        page.mouse.down()
        page.mouse.move(*at[1], steps=3)
        page.mouse.up()

    return act


def pressed(name: str) -> Act:
    """Press a button."""
    return lambda page: page.get_by_role("button", name=name).first.click()
