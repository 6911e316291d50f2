"""The flow of a step and its model as flat arrays, bit for bit, and back."""

from functools import lru_cache

import numpy as np

from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.least_squares import Model
from dropflow.tracking.probable.regression import WaveFlow
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.waves import Waves

_waves = lru_cache(maxsize=8)(Waves)
"""Flows of many steps have the same waves: what these have reckoned once is kept with them."""


def save_model(model: Model) -> Arrays:
    """The numbers of a model."""
    spectrum = [getattr(model.spectrum, name) for name in Spectrum.__dataclass_fields__]
    waves = model.waves
    box = [waves.width_px, waves.height_px, waves.n_x, waves.n_y]
    return {"model": np.array([*spectrum, *box, model.with_potential, model.factor_mean, model.factor_variance])}


def load_model(arrays: Arrays, up: Up) -> Model:
    """What `save_model` saved."""
    *spectrum, width_px, height_px, n_x, n_y, with_potential, mean, variance = arrays["model"].tolist()
    waves = _waves(width_px, height_px, int(n_x), int(n_y))
    return Model(waves, Spectrum(*spectrum), up, bool(with_potential), mean, variance)


def save_flow(flow: WaveFlow) -> Arrays:
    """The numbers of a flow, all arrays of shape (n,), float64."""
    variance = np.ascontiguousarray(flow.variance).view(np.float64).ravel()
    about = np.array([flow.stokes_variance, flow.weight, flow.n_since])
    return {**save_model(flow.model), "amplitudes": flow.amplitudes, "variance": variance, "about": about}


def load_flow(arrays: Arrays, up: Up) -> WaveFlow:
    """What `save_flow` saved."""
    model = load_model(arrays, up)
    variance = arrays["variance"].view(np.complex128).reshape(2, *model.waves.series_shape)
    stokes_variance, weight, n_since = arrays["about"].tolist()
    return WaveFlow(model, arrays["amplitudes"], variance, stokes_variance, weight, int(n_since))
