"""Every figure of a film by its name. The report, the service and the docs take their figures from here.

What is said of each stands in ``catalogue.yaml``; how it is drawn, and from what, stands here.
"""

from pathlib import Path

import yaml

from dropflow import figures
from dropflow.figures import numbers, of_film
from dropflow.figures.entry import ANY_FRAME, FRAME, RADII, SIGNAL, TIMES, TRAJECTORY, Drawing, Entry, Group, Needs
from dropflow.figures.of_film import no_driving, no_log, no_mixture, of_mixture, of_part

RANGES = TIMES + RADII

_DRAWINGS = {
    "phase_diagram": Drawing(draw=of_mixture(figures.phase_diagram), missing=no_mixture),
    "thresholding": Drawing(parameters=(ANY_FRAME,)),
    "watershed": Drawing(parameters=(ANY_FRAME,)),
    "match": Drawing(parameters=(ANY_FRAME,)),
    "flow_field": Drawing(parameters=(FRAME,)),
    "displacement": Drawing(parameters=(FRAME,)),
    "forward_tracking": Drawing(parameters=(TRAJECTORY, FRAME)),
    "backward_tracking": Drawing(parameters=(TRAJECTORY, FRAME)),
    "velocity_against_radius": Drawing(of_part(figures.velocity_against_radius, "velocity"), numbers.velocity, RANGES),
    "self_calibration": Drawing(of_part(figures.self_calibration, "calibration"), numbers.calibration),
    "trajectory_lengths": Drawing(of_part(figures.trajectory_lengths, "lengths"), numbers.lengths, RANGES),
    "observed_depth": Drawing(of_film.depth, numbers.depth),
    "radius_scatter": Drawing(of_part(figures.radius_scatter, "scatter"), numbers.scatter, RANGES),
    "size_distribution_before": Drawing(of_film.before, numbers.distribution_before, RANGES),
    "size_distribution_after": Drawing(of_film.after, numbers.distribution_after, RANGES),
    "size_distribution_at": Drawing(of_film.range_of_times, numbers.distribution_at, RANGES),
    "moments": Drawing(of_film.moments, numbers.moments, RANGES),
    "flow_moments": Drawing(of_film.flow_steps, numbers.flow_steps, TIMES),
    "flow_bins": Drawing(of_film.flow_bins, numbers.flow_bins, (*TIMES, SIGNAL)),
    "flow_correlation": Drawing(of_part(figures.flow_correlation, "correlation"), numbers.correlation),
    "oscillations": Drawing(of_part(figures.oscillating_signal, "oscillations"), numbers.signal, (*RANGES, SIGNAL)),
    "periods": Drawing(of_film.periods, numbers.periods, (*RANGES, SIGNAL)),
    "temperature": Drawing(of_part(figures.temperature, "shown_temperature"), numbers.temperature, TIMES, no_log),
    "driving": Drawing(of_part(figures.driving, "driving"), numbers.driving, TIMES, no_driving),
    "growth": Drawing(of_film.growth, numbers.growth, RANGES),
    "collision_efficiency": Drawing(of_film.efficiency, numbers.efficiency, RANGES),
    "coalescence": Drawing(of_part(figures.coalescence, "rates"), numbers.coalescence, RANGES),
    "viscosity": Drawing(draw=of_mixture(figures.viscosity), missing=no_mixture),
}

_WORDS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))


def _entry(name: str) -> Entry:
    words = _WORDS[name]
    group, needs = Group(words.pop("group")), Needs(words.pop("needs"))
    return Entry(name=name, group=group, needs=needs, drawing=_DRAWINGS[name], **words)


CATALOGUE: tuple[Entry, ...] = tuple(_entry(name) for name in _WORDS)
"""In the order of the paper."""

BY_NAME = {entry.name: entry for entry in CATALOGUE}
