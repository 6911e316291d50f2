"""The main job, as a person does it: describe a film, drop its folder, wait, read the numbers."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import polars as pl
import pytest
from playwright.sync_api import Page, expect
from polars.testing import assert_frame_equal

from tests.e2e.browser import drop, serious_findings
from tests.e2e.film import TARGET, describe_film, dropflow

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(240)]

MINUTES = 60_000
FOUR_DIGITS = 6e-4
OF_DROPLETS = {
    "Droplets": "n_droplets",
    "Droplets per frame": "n_droplets_per_frame",
    "Mean radius": "mean_radius_um",
    "Radius std": "radius_std_um",
    "Sauter radius": "sauter_radius_um",
}
OF_FLOW = {
    "Mean u": "mean_u_um_s",
    "Mean v": "mean_v_um_s",
    "Rms u": "rms_u_um_s",
    "Rms v": "rms_v_um_s",
}


@pytest.fixture(scope="session")
def summary(film: Path) -> dict[str, Any]:
    """What the command says about the film."""
    results = film.with_name("results")
    dropflow("analyse", film / "frames", "--experiment", film / "experiment.yaml", "--output", results, "--jobs", "1")
    content: dict[str, Any] = json.loads((results / "summary.json").read_text())
    return content


def number(text: str) -> float:
    """A number as the page writes it: thin spaces between thousands, a real minus, a unit behind."""
    plain = text.replace("\u2009", "").replace("\u2212", "-")
    found = re.match(r"-?[\d.]+", plain)
    assert found, f"{text!r} is no number"
    return float(found[0])


def test_the_page_gives_the_numbers_that_the_command_gives(page: Page, film: Path, summary: dict[str, Any]) -> None:
    page.goto("/")
    page.get_by_role("link", name="New experiment").first.click()
    describe_film(page, "main job")
    page.get_by_label("Flat field file", exact=True).set_input_files(film / "flat_field.tif")
    drop(page, TARGET, film / "frames")
    expect(page.get_by_text("7 files will be sent")).to_be_visible()
    assert serious_findings(page) == []

    page.get_by_role("button", name="Create and upload").click()
    expect(page.get_by_text("frames ready")).to_be_visible(timeout=MINUTES)
    assert serious_findings(page) == []

    page.get_by_role("link", name="New run").first.click()
    expect(page.get_by_role("button", name="Start the run")).to_be_disabled()
    page.get_by_label("Order, times and scale are right").check()
    assert serious_findings(page) == []
    page.get_by_role("button", name="Start the run").click()
    expect(page.get_by_text("completed", exact=True)).to_be_visible(timeout=2 * MINUTES)
    expect(page.get_by_role("heading", name="Run 1")).to_be_visible()
    assert serious_findings(page) == []

    page.get_by_role("tab", name="Numbers and parameters").click()
    expect(page.get_by_role("row", name=re.compile("^Mean radius"))).to_be_visible()
    assert serious_findings(page) == []
    for label, name in OF_DROPLETS.items():
        before, after = page.get_by_role("row", name=re.compile(f"^{label} [^p]")).get_by_role("cell").all_inner_texts()
        assert number(before) == pytest.approx(summary["detected"][name], rel=FOUR_DIGITS)
        assert number(after) == pytest.approx(summary["tracked"][name], rel=FOUR_DIGITS)
    for label, name in OF_FLOW.items():
        shown = (
            page.get_by_role("table", name="Flow").get_by_role("row", name=re.compile(f"^{label} ")).get_by_role("cell")
        )
        assert number(shown.inner_text()) == pytest.approx(summary["flow"][name], rel=FOUR_DIGITS)

    for tab in ("Sizes", "Flow", "Over time", "Figures", "Quality"):
        page.get_by_role("tab", name=tab).click()
        # What is out of sight is drawn when somebody comes to it.
        page.get_by_role("heading", level=2).last.scroll_into_view_if_needed()
        expect(page.locator(".js-plotly-plot").first).to_be_visible()
        expect(page.get_by_role("alert")).to_have_count(0)
        assert serious_findings(page) == []

    page.get_by_role("tab", name="Droplets").click()
    trajectories = pl.read_parquet(film.with_name("results") / "trajectories.parquet")
    n_in_first_frame = trajectories.filter(pl.col("frame") == 0).height
    expect(page.get_by_text(f"{n_in_first_frame} droplets on trajectories in frame 0").first).to_be_visible()
    assert serious_findings(page) == []

    page.get_by_role("tab", name="Downloads").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="trajectories.parquet", exact=True).click()
    assert_frame_equal(pl.read_parquet(download.value.path()), trajectories)


def test_what_is_wrong_with_a_field_stands_beside_it(page: Page) -> None:
    page.goto("experiments/new")
    describe_film(page, "never made")
    pixel_size = page.get_by_role("textbox", name=re.compile("^Pixel size"))
    pixel_size.fill("0")
    page.get_by_role("textbox", name=re.compile("^Viscosity")).fill("thick")
    page.get_by_role("button", name="Create without frames").click()
    expect(pixel_size).to_be_focused()
    viscosity = page.get_by_role("textbox", name=re.compile("^Viscosity"))
    expect(pixel_size).to_have_accessible_description(re.compile("^Must be more than 0"))
    expect(viscosity).to_have_accessible_description(re.compile("^Must be a number"))
    assert serious_findings(page) == []
    page.goto("/")
    expect(page.get_by_role("heading", name="Experiments")).to_be_visible()
    expect(page.get_by_text("never made")).to_have_count(0)


def test_frames_that_cannot_be_used_are_refused_with_the_file(page: Page, film: Path, tmp_path: Path) -> None:
    frames = tmp_path / "frames"
    shutil.copytree(film / "frames", frames)
    damaged = frames / "frame_000003.tif"
    damaged.write_bytes(damaged.read_bytes()[:-1000])
    page.goto("experiments/new")
    describe_film(page, "with a damaged frame")
    drop(page, TARGET, frames)
    page.get_by_role("button", name="Create and upload").click()
    refusal = page.get_by_role("alert")
    expect(refusal).to_contain_text("These frames cannot be used", timeout=MINUTES)
    expect(refusal).to_contain_text("frame_000003.tif")
    expect(page.get_by_text("frames refused")).to_be_visible()
    assert serious_findings(page) == []
