"""The help of the command, which somebody who waits for it reads nothing in."""

import subprocess
import sys

from dropflow.cli import COMMANDS

HEAVY = ("numba", "scipy", "cv2", "plotly", "zarr", "skimage")


def test_the_help_names_every_command_and_loads_nothing_that_only_computing_needs() -> None:
    code = f"""
import sys
from dropflow.cli import app
sys.argv = ["dropflow", "--help"]
app(standalone_mode=False)
print("loaded:", [name for name in {HEAVY!r} if name in sys.modules])
"""
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60).stdout
    assert all(f" {command} " in shown for command in COMMANDS)
    assert "loaded: []" in shown
