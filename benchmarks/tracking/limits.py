"""What limits any measurement of the flow in convection: how far droplets and tracers tell of the flow between them."""

from itertools import product
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow.compute as pc
from scipy.interpolate import RBFInterpolator
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from benchmarks.tracking.films import N_NEAREST
from benchmarks.tracking.given import Given
from dropflow.simulation.truth import Visibility

Floats = npt.NDArray[np.float64]

_LENGTHS_UM = (60, 100, 150, 200, 300)
_NOISE_SHARES = (0.01, 0.05, 0.1, 0.2, 0.4)
"""Correlation lengths and shares of the variance that droplets have each for itself; the best by the truth is taken."""
_FREE_MEAN = 100.0
"""Variance of the mean flow, in those of the flow: it is as if nothing were known of it."""


def unknown_share(tracers: Path, *, n: int = 200) -> float:
    """What the tracers do not tell of the flow between them: error of the velocity of one from all others, over rms.

    No field can be compared with the flow of the simulation more closely than this.
    """
    particles = np.load(tracers)["particles"].astype(np.float64)
    step = len(particles) // 2
    middle = (particles[step] + particles[step + 1])[:, :3] / 2
    velocity = (particles[step + 1] - particles[step])[:, [0, 2]]
    inside = np.flatnonzero((np.abs(middle - 0.5) < (0.42, 0.1, 0.5)).all(axis=1))
    chosen = np.random.default_rng(0).choice(inside, n, replace=False)
    _, near = cKDTree(middle).query(middle[chosen], N_NEAREST + 1)
    errors = [
        RBFInterpolator(middle[others[1:]], velocity[others[1:]])(middle[[one]])[0] - velocity[one]
        for one, others in zip(chosen, near, strict=True)
    ]
    return float(np.sqrt(np.mean(np.square(errors)) / np.mean(velocity[inside] ** 2)))


def unshared_share(given: Given) -> float:
    """What visible droplets do not tell of the velocity of one among them: error of it from all others, over rms.

    The true fluid velocities at the droplets are given, and Gaussian regression with the length and noise that suit
    them best. What tracking finds between droplets cannot be more certain.
    """
    truth = given.truth.filter(pc.field("visibility") == str(Visibility.VISIBLE))
    frame, *columns = (truth[name].to_numpy() for name in ("frame", "x_um", "y_um", "flow_u_um_s", "flow_v_um_s"))
    rows = np.column_stack(columns)
    steps = [rows[frame == index] for index in range(0, int(frame.max()), 2)]
    square = sum(float(np.square(step[:, 2:]).sum()) for step in steps)
    errors = [
        sum(_left_out(step[:, :2], step[:, 2:], length_um, noise) for step in steps)
        for length_um, noise in product(_LENGTHS_UM, _NOISE_SHARES)
    ]
    return float(np.sqrt(min(errors) / square))


def _left_out(places_um: Floats, velocity_um_s: Floats, length_um: float, noise: float) -> float:
    """Sum of squares of what the others make of each, against what it is."""
    covariance = np.exp(-(cdist(places_um, places_um) ** 2) / (2 * length_um**2)) + _FREE_MEAN
    inverse = np.linalg.inv(covariance + noise * np.eye(len(places_um)))
    return float(np.square(inverse @ velocity_um_s / np.diag(inverse)[:, None]).sum())
