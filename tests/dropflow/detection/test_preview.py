"""One frame as people see it: steps, droplets and why others are none; and the commands that show it."""

import cv2
import numpy as np
import pytest
import tifffile
import yaml
from typer.testing import CliRunner

from dropflow.cli import app
from dropflow.detection.preview import preview
from dropflow.errors import FramesError
from tests.dropflow.detection.discs import OVERLAPPING, SHAPE, detector_for, draw

STEPS = {"default": ["flat_field", "stripes"], "paper": ["flat_field", "band_pass", "contrast"]}


@pytest.mark.parametrize("method", STEPS)
def test_the_last_step_is_what_droplets_are_looked_for_in(method):
    frame = draw(OVERLAPPING)
    detector = detector_for(frame, method=method)
    shown = preview(frame, detector)
    assert [step.name for step in shown.steps] == STEPS[method]
    assert (shown.steps[-1].image == detector.prepare(frame)).all()
    assert (shown.detection.droplets.x_px == detector.detect(detector.prepare(frame)).droplets.x_px).all()
    assert sum(shown.n_rejected.values()) == len(shown.detection.rejected.droplets)
    assert all(step.image.shape == SHAPE and step.about for step in shown.steps)


@pytest.fixture
def stack(tmp_path):
    """A film of two frames and its description."""
    (tmp_path / "frames").mkdir()
    for index in range(2):
        discs = [(x + 3 * index, y, r) for x, y, r in OVERLAPPING]
        tifffile.imwrite(tmp_path / f"frames/{index}.tif", draw(discs))
    about = {"name": "a", "pixel_size_um": 1.0, "frame_interval_s": 1.0, "droplets": "bright"}
    about["material"] = {"delta_density_kg_m3": -20.0, "viscosity_pa_s": 0.001}
    (tmp_path / "experiment.yaml").write_text(yaml.safe_dump(about))
    (tmp_path / "parameters.yaml").write_text("detection: {radius_min_um: 5, radius_max_um: 40}")
    return tmp_path


def run(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_a_picture_shows_the_droplets(stack):
    given = ["preview", stack / "frames", "--experiment", stack / "experiment.yaml", "--parameters"]
    given += [stack / "parameters.yaml", "--frame", 1, "--scale", 2]
    found = run(*given, "-o", stack / "out/overlay.png", "--steps", stack / "steps")
    assert found.exit_code == 0, found.output
    assert "droplets in frame 1" in found.output
    picture = cv2.imread(str(stack / "out/overlay.png"))
    assert picture.shape == (2 * SHAPE[0], 2 * SHAPE[1], 3)
    assert sorted(path.name for path in (stack / "steps").iterdir()) == ["1-flat_field.png", "2-stripes.png"]
    run(*given, "-o", stack / "more.png", "--rejected")
    reds = [int(((p[..., 2] > 200) & (p[..., 1] < 80)).sum()) for p in (picture, cv2.imread(str(stack / "more.png")))]
    assert reds[1] > reds[0]


def test_a_frame_that_is_not_there_is_one_line(stack):
    found = run("preview", stack / "frames", "--experiment", stack / "experiment.yaml", "--frame", 7, "-o", "x.png")
    assert isinstance(found.exception, FramesError)
    assert found.exception.code == "frames.no_such_frame"
    assert "frames 0 to 1" in str(found.exception)


def test_suggested_parameters_can_be_used(stack):
    given = [stack / "frames", "--experiment", stack / "experiment.yaml"]
    found = run("suggest", *given, "-o", stack / "suggested.yaml")
    assert found.exit_code == 0, found.output
    assert "radius_min_um" in found.output
    assert np.isfinite(yaml.safe_load((stack / "suggested.yaml").read_text())["detection"]["radius_min_um"])
    assert run("preview", *given, "--parameters", stack / "suggested.yaml", "-o", stack / "o.png").exit_code == 0
