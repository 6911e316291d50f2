"""A person tunes, looks at every dashboard, compares and takes pictures away; then everything once more in the dark."""

import re
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import cv2
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.browser import drop, serious_findings
from tests.e2e.film import TARGET, describe_film

pytestmark = [pytest.mark.e2e, pytest.mark.slow, pytest.mark.timeout(900)]

MINUTES = 60_000
TABS = ("Sizes", "Droplets", "Flow", "Over time", "Figures", "Quality", "Numbers and parameters", "Downloads")
PAGES = ("", "experiments/new", "planning", "compare", "account", "groups", "administration", "no/such/page")
SVG = "{http://www.w3.org/2000/svg}"


def test_a_film_is_tuned_analysed_looked_at_compared_and_taken_away(page: Page, film: Path) -> None:
    _upload(page, film)
    _tune(page)
    _start(page)
    _look_at_every_dashboard(page)
    _see_what_was_rejected(page)
    _take_pictures_away(page)
    _share_a_view(page)
    _compare_with_another_run(page)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nobody_is_kept_out_of_any_page(page: Page, scheme: Literal["light", "dark"]) -> None:
    page.emulate_media(color_scheme=scheme)
    for address in PAGES:
        page.goto(address or "/")
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        expect(page.get_by_label("Loading")).to_have_count(0)
        assert serious_findings(page) == [], address


def _upload(page: Page, film: Path) -> None:
    page.goto("experiments/new")
    describe_film(page, "dashboards")
    drop(page, TARGET, film / "frames")
    page.get_by_role("button", name="Create and upload").click()
    expect(page.get_by_text("frames ready")).to_be_visible(timeout=MINUTES)


def _tune(page: Page) -> None:
    page.get_by_role("link", name="New run").first.click()
    page.get_by_label("Order, times and scale are right").check()
    # Nobody warmed the workers up.
    expect(page.get_by_text(re.compile("candidates? rejected, looked at in"))).to_be_visible(timeout=3 * MINUTES)
    before = page.get_by_label(re.compile("^Preview of frame 0")).get_attribute("aria-label")
    radius = page.get_by_role("textbox", name=re.compile("^Radius min"))
    radius.fill("12")
    expect(page.get_by_label(re.compile("^Preview of frame 0"))).not_to_have_attribute("aria-label", before or "")
    radius.fill("4")
    page.get_by_role("switch", name="Rejected candidates").check()
    expect(page.get_by_role("table", name="Rejected candidates by reason")).to_be_visible()
    page.get_by_role("radiogroup", name="What is previewed").get_by_text("Following").click()
    expect(page.get_by_text(re.compile("on trajectories found again in the next frame")).first).to_be_visible(
        timeout=MINUTES
    )
    page.get_by_role("button", name="Presets").click()
    page.get_by_role("textbox", name="Keep the parameters of the form as").fill("As the paper")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("As the paper is kept.")).to_be_visible()
    assert serious_findings(page) == []
    page.keyboard.press("Escape")


def _start(page: Page) -> None:
    page.get_by_role("button", name="Start the run").click()
    expect(page.get_by_text("completed", exact=True)).to_be_visible(timeout=3 * MINUTES)


def _look_at_every_dashboard(page: Page) -> None:
    schemes: tuple[Literal["light", "dark"], ...] = ("light", "dark")
    for scheme in schemes:
        page.emulate_media(color_scheme=scheme)
        for tab in TABS:
            page.get_by_role("tab", name=tab).click()
            expect(page.get_by_label("Loading")).to_have_count(0)
            if tab != "Numbers and parameters":  # there a run may warn
                expect(page.get_by_role("alert")).to_have_count(0)
            assert serious_findings(page) == [], (tab, scheme)
    page.emulate_media(color_scheme="light")


def _see_what_was_rejected(page: Page) -> None:
    page.get_by_role("tab", name="Droplets").click()
    page.get_by_role("group", name="Drawn over the frame").get_by_text("Rejected").click()
    expect(page.get_by_role("table", name="Rejected candidates by reason")).to_be_visible()
    page.get_by_role("switch", name="As detection sees it").check()
    expect(page.get_by_label("Looking at the frame once more")).to_have_count(0)
    assert "prepared=true" in page.url
    assert serious_findings(page) == []
    page.get_by_role("switch", name="As detection sees it").uncheck()


def _take_pictures_away(page: Page) -> None:
    png = cv2.imread(str(_exported(page, "Picture (PNG)")))
    assert png is not None
    assert png.shape[1] >= 1200
    drawn = ElementTree.parse(_exported(page, "Drawing (SVG)")).getroot()  # noqa: S314 - our own page wrote it
    assert drawn.find(f"{SVG}image") is not None
    assert len(drawn.findall(f".//{SVG}path")) >= 3  # droplets, those in the next frame, arrows
    page.get_by_role("button", name="Export").click()
    page.get_by_role("menuitem", name="Film (MP4) …").click()
    page.get_by_label("Last frame").fill("3")
    with page.expect_download(timeout=MINUTES) as download:
        page.get_by_role("button", name="Make the film").click()
    film = cv2.VideoCapture(str(download.value.path()))
    n_frames = 0
    while film.read()[0]:
        n_frames += 1
    assert n_frames == 4


def _exported(page: Page, kind: str) -> Path:
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=kind).click()
    return Path(download.value.path())


def _share_a_view(page: Page) -> None:
    """A rectangle in one plot is the range of all, and the address holds it."""
    page.get_by_role("tab", name="Sizes").click()
    plot = page.get_by_role("figure", name="Size distribution before tracking").locator(".nsewdrag").first
    box = plot.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.2 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.8 * box["height"], steps=5)
    page.mouse.up()
    expect(page).to_have_url(re.compile(r"[?&]t=.*&r=|[?&]r=.*&t="))
    page.reload()
    expect(page.get_by_role("button", name="Show everything")).to_be_visible()
    page.get_by_role("tab", name="Over time").click()
    expect(page.get_by_role("button", name="Show everything")).to_be_visible()
    page.get_by_role("button", name="Show everything").click()
    expect(page).not_to_have_url(re.compile(r"[?&]t="))


def _compare_with_another_run(page: Page) -> None:
    page.get_by_role("link", name="Run with other parameters").click()
    page.get_by_role("button", name="Presets").click()
    page.get_by_role("button", name="Use As the paper").click()
    page.get_by_role("textbox", name=re.compile("^Radius min")).fill("8")
    _start(page)
    expect(page.get_by_role("heading", name="Run 2")).to_be_visible()
    page.get_by_role("link", name="dashboards").click()
    page.get_by_role("link", name="Compare these runs").click()
    differs = page.get_by_role("region", name="Table of what differs")
    expect(differs.get_by_role("row", name="Detection, radius min 8 µm 4 µm")).to_be_visible()
    expect(differs.get_by_role("row")).to_have_count(2)
    expect(page.get_by_role("figure", name=re.compile("Size distributions"))).to_be_visible()
    expect(page.get_by_text("its driving parameter is not known").first).to_be_visible()
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
        assert serious_findings(page) == []
    page.get_by_role("button", name=re.compile("^Leave out")).first.click()
    expect(page.get_by_role("button", name=re.compile("^Leave out"))).to_have_count(1)
