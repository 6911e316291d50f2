"""The radii that are looked for, in pixels, and whether a frame can show them."""

from dropflow.errors import FieldProblem, ParametersError
from dropflow.experiment import Experiment
from dropflow.parameters import Parameters

SMALLEST_RADIUS_PX = 2.0
"""Below this a disk has fewer than 13 pixels: it has no edge, and no radius can be measured from it."""


def radius_range_px(experiment: Experiment, parameters: Parameters, shape: tuple[int, int]) -> tuple[float, float]:
    """Return the smallest and the largest radius looked for, px.

    Raises
    ------
    ParametersError
        ``parameters.radius_range``: the smallest is below 2 px, or a largest droplet is wider than the frame.
    """
    detection, pixel = parameters.detection, experiment.pixel_size_um
    r_min_px, r_max_px = detection.radius_min_um / pixel, detection.radius_max_um / pixel
    largest_px = min(shape) / 2
    problems = []
    if r_min_px < SMALLEST_RADIUS_PX:
        told = f"{detection.radius_min_um:g} um is {r_min_px:.3g} px, below the {SMALLEST_RADIUS_PX:g} px that can be "
        told += f"measured: give at least {SMALLEST_RADIUS_PX * pixel:.4g} um, or correct pixel_size_um ({pixel:g} um)"
        problems.append(FieldProblem("detection.radius_min_um", told))
    if r_max_px > largest_px:
        told = (
            f"{detection.radius_max_um:g} um is {r_max_px:.4g} px, but the frames of {shape[0]} x {shape[1]} px hold "
        )
        told += f"no more than {largest_px:g} px: give at most {largest_px * pixel:.4g} um, "
        told += f"or correct pixel_size_um ({pixel:g} um)"
        problems.append(FieldProblem("detection.radius_max_um", told))
    if problems:
        message = "The radius range does not fit the frames."
        raise ParametersError(message, code="parameters.radius_range", fields=problems)
    return r_min_px, r_max_px
