"""The spectrum of a flow from the droplets themselves: the one under which their velocities are most probable."""

from dataclasses import dataclass, replace

import numpy as np

from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.evidence import Evidence, evidence, parameters_of, spectrum_of
from dropflow.tracking.probable.least_squares import Model, Observations
from dropflow.tracking.probable.spectrum import Spectrum
from dropflow.tracking.probable.waves import Waves

_MOST_LATTICES = 3
_SAME_SIZE = 0.25
"""A lattice whose box or finest wave changed by less than this (in ln) will do."""
_LONGEST_STEP = 1.5
"""Of a parameter at once; most are logarithms."""
_NEGLIGIBLE_GAIN = 0.03
"""Of the logarithm of the evidence."""
_MOSTLY = 0.5
"""A step that keeps less of what it promised is followed by a shorter one."""
_FIRST_DAMPING, _DAMPING = 0.3, 4.0
_NEGLIGIBLE_SHARE = 0.01
"""A flow with less of its energy in a potential is taken to have none."""
_USUAL_LENGTH_SHARE = 0.15
"""Of the frame, a correlation length that surprises nobody: the centre of a prior that spans an order of magnitude."""


@dataclass(frozen=True)
class _Prior:
    """Normal prior of each parameter; in logarithms, the share in log odds."""

    mean: Column
    std: Column

    def weigh(self, seen: Evidence, parameters: Column) -> Evidence:
        """What was seen and what was expected, together."""
        off = (parameters - self.mean) / self.std
        return seen + Evidence(-float(off @ off) / 2, np.asarray(-off / self.std), np.diag(self.std**-2.0))


def estimate_spectrum(
    steps: list[Observations], grid: Grid, model: Model | None, up: Up, *, with_potential: bool, most_iterations: int
) -> Model:
    """The model of highest evidence for the observations of some steps, started from `model` if there is one.

    Parameters
    ----------
    steps : list of Observations
        Each the droplets of one step, independent of each other.
    grid : Grid
        For the size of the frame.
    model : Model or None
        Where to start; its error of the sedimentation's factor is kept.
    up : (float, float)
        Unit vector against gravity.
    with_potential : bool
        Whether to look for a part of the flow that has a divergence in the plane; without, twice as fast.
    most_iterations : int
        Of the climb to the highest evidence.

    Returns
    -------
    Model
        With waves that suit the length found.
    """
    prior = _prior_of(steps, grid)
    found = model or _first_guess(prior, grid, up)
    for _ in range(_MOST_LATTICES):
        start = replace(found, waves=_waves_for(found.spectrum, grid), with_potential=with_potential)
        found = replace(start, spectrum=_climb(steps, start, prior, most_iterations))
        has_moved = _is_another(_waves_for(found.spectrum, grid), start.waves)
        if not has_moved:
            break
    has_potential = with_potential and found.spectrum.potential_share > _NEGLIGIBLE_SHARE
    return replace(found, with_potential=has_potential)


def _climb(steps: list[Observations], model: Model, prior: _Prior, most_iterations: int) -> Spectrum:
    """Fisher scoring: each step to the top of the paraboloid that the evidence should be, shorter ones where it is not.

    Climbing ends where less than `_NEGLIGIBLE_GAIN` is to be won: nothing that data could tell apart.
    """
    low, high = prior.mean - 4 * prior.std, prior.mean + 4 * prior.std
    at = np.clip(parameters_of(model.spectrum), low, high)
    here = prior.weigh(evidence(steps, model, at), at)
    damping = 0.0
    for _ in range(most_iterations):
        is_held = ((at <= low) & (here.slope < 0)) | ((at >= high) & (here.slope > 0))
        slope = np.where(is_held, 0.0, here.slope)
        bend = here.information + damping * np.diag(np.diag(here.information))
        bend[is_held] = bend[:, is_held] = 0
        bend[is_held, is_held] = 1
        step = np.clip(np.linalg.solve(bend, slope), -_LONGEST_STEP, _LONGEST_STEP)
        step = np.clip(at + step, low, high) - at
        promised = here.slope @ step - step @ here.information @ step / 2
        if promised < _NEGLIGIBLE_GAIN:
            break
        there = prior.weigh(evidence(steps, model, at + step), at + step)
        kept = (there.value - here.value) / promised
        damping = damping / _DAMPING if kept > _MOSTLY else max(damping * _DAMPING, _FIRST_DAMPING)
        if kept > 0:
            at, here = at + step, there
    return spectrum_of(at)


def _prior_of(steps: list[Observations], grid: Grid) -> _Prior:
    """Weak expectations from the size of the frame and of the velocities."""
    speed = np.concatenate([np.concatenate([step.across_um_s, step.along_um_s]) for step in steps])
    known = np.concatenate([np.concatenate([step.across_variance, step.along_variance]) for step in steps])
    rms = max(float(np.sqrt(np.median(speed**2) * 2)), float(np.sqrt(np.median(known))), 1e-9)
    length = _USUAL_LENGTH_SHARE * np.sqrt(grid.height_px * grid.width_px)
    mean = np.array([np.log(rms), np.log(length), -3.0, np.log(0.03), np.log(0.1 * rms)])
    return _Prior(mean, np.array([1.0, 0.8, 1.5, 1.2, 1.0]))


def _first_guess(prior: _Prior, grid: Grid, up: Up) -> Model:
    spectrum = spectrum_of(prior.mean)
    return Model(_waves_for(spectrum, grid), spectrum, up, with_potential=True, factor_mean=0.0, factor_variance=0.3**2)


def _waves_for(spectrum: Spectrum, grid: Grid) -> Waves:
    return Waves.over(grid, spectrum.length_px, spectrum.finest_per_px)


def _is_another(waves: Waves, other: Waves) -> bool:
    """Whether two lattices differ so much that what one finds must be looked at with the other."""
    box = np.log(waves.width_px / other.width_px)
    finest = np.log(waves.modulus_per_px.max() / other.modulus_per_px.max())
    return bool(max(abs(box), abs(finest)) > _SAME_SIZE)
