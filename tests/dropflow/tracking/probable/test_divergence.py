"""Whether the flow may have sources and sinks in the plane: estimated from the droplets, never, or always."""

from pathlib import Path

import numpy as np
import pytest

from dropflow.scoring import read_flow
from dropflow.statistics.flow_maps import divergence_per_s, vorticity_per_s
from tests.dropflow.tracking.generated import Film, Floats, film, vortices
from tests.dropflow.tracking.tracked import tracked

WIDTH_PX = 300
CELLS = {"n_columns": 122, "n_rows": 102}
"""Of about 5 px: differences over two of them are derivatives within a hundredth."""


def turning_and_rising(x_px: Floats, y_px: Floats, time_s: float) -> Floats:
    """Vortices, and as strong a flow away from where fluid rises into the plane."""
    along, down = np.pi * x_px / WIDTH_PX, np.pi * y_px / WIDTH_PX
    away = 8 * np.stack([np.cos(along) * np.sin(down), np.sin(along) * np.cos(down)])
    return vortices(8, WIDTH_PX)(x_px, y_px, time_s) + away


@pytest.fixture(scope="module")
def turning() -> Film:
    return film(flow=vortices(8, WIDTH_PX), n_droplets=200, n_frames=6)


@pytest.fixture(scope="module")
def rising() -> Film:
    return film(flow=turning_and_rising, n_droplets=200, n_frames=6)


def divergence_found(given: Film, folder: Path, divergence: str) -> tuple[Floats, Floats]:
    """Divergence and vorticity of the flow of all steps, 1/s, and those of cells."""
    steps = read_flow(tracked(given, folder, flow={**CELLS, "divergence": divergence}).flow)
    pixel = given.experiment.pixel_size_um
    x_um, y_um = steps.grid_x_px * pixel, steps.grid_y_px * pixel
    fields = [[of(u, v, x_um, y_um) for u, v in steps.velocity_um_s] for of in (divergence_per_s, vorticity_per_s)]
    inner = (slice(None), slice(2, -2), slice(2, -2))
    return np.array(fields[0])[inner], np.array(fields[1])[inner]


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize(("divergence", "has_sources"), [("never", True), ("never", False), ("estimated", False)])
def test_a_flow_without_divergence_has_none_anywhere(
    divergence: str, has_sources: bool, turning: Film, rising: Film, tmp_path: Path
) -> None:
    """By `never` even where the droplets have one; by `estimated` where they have none."""
    sources, turns = divergence_found(rising if has_sources else turning, tmp_path, divergence)
    assert rms(turns) > 0.01
    assert rms(sources) < 0.01 * rms(turns)


@pytest.mark.parametrize("divergence", ["estimated", "always"])
def test_sources_and_sinks_of_the_droplets_are_found(divergence: str, rising: Film, tmp_path: Path) -> None:
    """Within a quarter of their strength."""
    sources, turns = divergence_found(rising, tmp_path, divergence)
    assert rms(sources) == pytest.approx(2 * np.pi / WIDTH_PX * 8 / 2, rel=0.25)
    assert rms(turns) == pytest.approx(rms(sources), rel=0.35)


def test_a_part_that_is_always_allowed_stays_small_where_there_is_none(turning: Film, tmp_path: Path) -> None:
    """`always` leaves it in the model, with what strength the droplets show."""
    sources, turns = divergence_found(turning, tmp_path, "always")
    assert 0 < rms(sources) < 0.1 * rms(turns)
