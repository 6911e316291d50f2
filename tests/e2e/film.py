"""A film as somebody brings it: simulated frames, and what they type to describe it."""

import os
import re
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Page

from tests.services import ROOT

TARGET = "Drop a folder, images, a film or a ZIP here"


def dropflow(*arguments: str | Path) -> None:
    """Run the command as people do."""
    command = Path(sys.executable).with_name("dropflow")
    variables = {**os.environ, "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
    subprocess.run([command, *arguments], check=True, cwd=ROOT, env=variables, capture_output=True)


def simulate(folder: Path) -> None:
    """Six small frames of easy droplets, with a flat field."""
    size = ("--height", "512", "--width", "612")
    dropflow("simulate", folder, "--scenario", "easy", "--frames", "6", "--seed", "3", *size)


def describe_film(page: Page, name: str) -> None:
    """Fill in the form of a new experiment."""
    typed = {
        "Name": name,
        "Pixel size": "0.625",
        "Frame interval": "0.5",
        "Density difference": "-20",
        "Viscosity": "0.001",
    }
    for label, text in typed.items():
        page.get_by_role("textbox", name=re.compile(f"^{label}")).fill(text)
    page.get_by_role("radiogroup", name="Droplets").get_by_text("Bright").click()
