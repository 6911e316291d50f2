"""What is known of the flow from the steps so far, in either direction of time."""

from dataclasses import replace

import numpy as np

from dropflow.parameters import Divergence
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.grid import CornerGrid, Grid
from dropflow.tracking.probable.directions import Up
from dropflow.tracking.probable.flow_record import load_flow, load_model, save_flow, save_model
from dropflow.tracking.probable.least_squares import Model, Observations
from dropflow.tracking.probable.lost_places import LostPlaces
from dropflow.tracking.probable.regression import WaveFlow, regress
from dropflow.tracking.probable.spectrum_estimate import estimate_spectrum
from dropflow.tracking.saving import load_columns, prefixed, save_columns, without_prefix

_MOST_REMEMBERED = 3
"""Steps whose droplets say something of the next one."""
_ENOUGH_REMEMBERED = 600
"""Droplets; steps before those that had so many have little to add."""
_ESTIMATED_AFTER = (1, 3, 8, 24, 64)
_ESTIMATED_EVERY = 192
_POTENTIAL_SOUGHT = (3, 8)
"""From this many steps to that many; a flow without divergence in these is taken to have none."""
_ENOUGH_OBSERVATIONS = 600
"""For the spectrum; more steps than that takes are not looked at."""
_MOST_OBSERVATIONS = 1000
"""Of a step, for the spectrum; every second or third droplet is taken where there are more."""
_LEAST_OBSERVATIONS = 3
_STOKES_DRIFT_VARIANCE = 1e-5
"""By which the error of Stokes' factor may change from step to step."""
_UNKNOWN_STOKES_VARIANCE = 0.3**2
_FIRST_CHANGE_PER_S = 0.1
"""Share of its rms by which an unknown flow is thought to change in a second."""
_LONGEST_WAIT = 32
"""Steps between searches for the flow where it cannot be found."""
_KEPT = 0.8
_N_PROBES = 8
"""Along x and y: points at which the flow is compared with that of the step before."""
_MEDIAN_SQUARE = 0.455
"""Median of the square of a standard normal variable."""


class FlowMemory:
    """The model of the flow, the velocities of the last steps, and the flow they give."""

    def __init__(self, grid: Grid, up: Up, divergence: Divergence) -> None:
        self._grid = grid
        self._up = up
        self._divergence = divergence
        probes = CornerGrid(grid.height_px, grid.width_px, _N_PROBES, _N_PROBES)
        self._probes = np.asarray(np.meshgrid(probes.x_px, probes.y_px)).reshape(2, -1)
        self.model: Model | None = None
        self.last: WaveFlow | None = None
        """The flow of the step before."""
        self.change_um_s2 = 0.0
        """How fast the flow at a place changes."""
        self._steps: list[Observations] = []
        self._ages_s: list[float] = []
        self._n_steps = 0
        self._n_failures = 0
        self._wait = 0

    @property
    def may_be_sought(self) -> bool:
        """Whether it is time to look for the flow from nothing: after failures in a row less and less often."""
        return self._wait == 0

    def note_search(self, *, has_failed: bool) -> None:
        """Remember how a search for the flow ended."""
        self._n_failures = self._n_failures + 1 if has_failed else 0
        self._wait = min(2**self._n_failures, _LONGEST_WAIT) if has_failed else 0

    @property
    def noise_um_s(self) -> float:
        """What single droplets do beyond flow and Stokes."""
        return self.model.spectrum.noise_um_s if self.model else 0.0

    @property
    def stokes_error(self) -> tuple[float, float]:
        """Relative error of Stokes' velocity with the material's numbers, and its variance."""
        if self.model is None:
            return 0.0, _UNKNOWN_STOKES_VARIANCE
        return self.model.factor_mean, self.model.factor_variance

    def flow_with(self, seen: Observations, dt_s: float, lost: LostPlaces | None = None) -> WaveFlow | None:
        """The flow of the step that follows, `dt_s` long, from what was seen of it and in the steps before.

        Where places are `lost`, the steps before say nothing of them.
        """
        parts = [self._aged(step, age + dt_s / 2) for step, age in zip(self._steps, self._ages_s, strict=True)]
        if lost is not None:
            parts = [lost.without(step) for step in parts]
        together = Observations.concatenate([*parts, seen])
        if self.model is None or not len(together):
            return None
        return regress(together, self.model, like=self.last if lost is None else None)

    def learn(self, seen: Observations, flow: WaveFlow | None, dt_s: float) -> None:
        """Remember a step that is over: what was seen of it and the flow that was found."""
        self._wait = max(self._wait - 1, 0)
        self._ages_s = [age + dt_s for age in self._ages_s]
        if len(seen):
            self._steps, self._ages_s = [*self._steps, seen], [*self._ages_s, dt_s / 2]
            n_kept = min(_n_last(self._steps, _ENOUGH_REMEMBERED), _MOST_REMEMBERED)
            self._steps, self._ages_s = self._steps[-n_kept:], self._ages_s[-n_kept:]
            self._n_steps += 1
        if flow is not None:
            self._note(flow, dt_s)
        is_time = self._n_steps in _ESTIMATED_AFTER or self._n_steps % _ESTIMATED_EVERY == 0
        if len(seen) and is_time and sum(map(len, self._steps)) >= _LEAST_OBSERVATIONS:
            self.estimate(self._steps)

    def estimate(self, steps: list[Observations], *, most_iterations: int = 25) -> None:
        """Find the model that suits the last of these steps, starting from the present one."""
        latest = steps[-_n_last(steps, _ENOUGH_OBSERVATIONS) :]
        thinned = [step[:: 1 + len(step) // _MOST_OBSERVATIONS] for step in latest]
        found = estimate_spectrum(
            thinned,
            self._grid,
            self.model,
            self._up,
            with_potential=self._may_diverge(),
            most_iterations=most_iterations,
        )
        self.model = replace(found, with_potential=found.with_potential or self._divergence is Divergence.ALWAYS)
        if self.change_um_s2 == 0.0:
            self.change_um_s2 = _FIRST_CHANGE_PER_S * self.model.spectrum.rms_um_s

    def _may_diverge(self) -> bool:
        """Whether a part of the flow that has a divergence is to be looked for."""
        if self._divergence is not Divergence.ESTIMATED:
            return self._divergence is Divergence.ALWAYS
        first, last = _POTENTIAL_SOUGHT
        return first <= self._n_steps <= last or (self.model is not None and self.model.with_potential)

    def forget(self) -> None:
        """Forget the flow, which is not what it was; Stokes' factor stays."""
        self._steps, self._ages_s, self._n_steps, self.last = [], [], 0, None

    def forget_places(self, lost: LostPlaces) -> None:
        """Forget what was seen there, which was something else."""
        left = [(lost.without(step), age) for step, age in zip(self._steps, self._ages_s, strict=True)]
        self._steps = [step for step, _ in left if len(step)]
        self._ages_s = [age for step, age in left if len(step)]

    def _note(self, flow: WaveFlow, dt_s: float) -> None:
        if self.last is not None:
            difference = (flow.at(*self._probes) - self.last.at(*self._probes)) / dt_s
            seen = float(np.sqrt(np.median(difference**2) / _MEDIAN_SQUARE))
            self.change_um_s2 = _KEPT * self.change_um_s2 + (1 - _KEPT) * seen
        self.last = flow
        mean, variance = flow.stokes_error
        if self.model is not None:
            variance = min(variance + _STOKES_DRIFT_VARIANCE, _UNKNOWN_STOKES_VARIANCE)
            self.model = replace(self.model, factor_mean=mean, factor_variance=variance)

    def _aged(self, step: Observations, age_s: float) -> Observations:
        """What was seen some time ago says less of now."""
        more = (self.change_um_s2 * age_s) ** 2
        return replace(step, across_variance=step.across_variance + more, along_variance=step.along_variance + more)

    def learn_from(self, arrays: Arrays) -> None:
        """Take the model from the state of another memory of the same film; it is as good as after many steps."""
        model = without_prefix("model.", arrays)
        if model:
            self.model = load_model(model, self._up)
            self.change_um_s2 = float(arrays["change_um_s2"])
            self._n_steps = _ESTIMATED_AFTER[-1]

    def state(self) -> Arrays:
        """Everything, as arrays."""
        arrays: Arrays = {"ages_s": np.array(self._ages_s), "change_um_s2": np.asarray(self.change_um_s2)}
        arrays["counts"] = np.array([self._n_steps, self._n_failures, self._wait])
        for index, step in enumerate(self._steps):
            arrays |= save_columns(f"step{index}", step)
        if self.model is not None:
            arrays |= prefixed("model.", save_model(self.model))
        if self.last is not None:
            arrays |= prefixed("last.", save_flow(self.last))
        return arrays

    def restore(self, arrays: Arrays) -> None:
        """Take up a state."""
        self._ages_s = arrays["ages_s"].tolist()
        self._steps = [load_columns(f"step{index}", Observations, arrays) for index in range(len(self._ages_s))]
        self._n_steps, self._n_failures, self._wait = arrays["counts"].tolist()
        self.change_um_s2 = float(arrays["change_um_s2"])
        model, last = without_prefix("model.", arrays), without_prefix("last.", arrays)
        self.model = load_model(model, self._up) if model else None
        self.last = load_flow(last, self._up) if last else None


def _n_last(steps: list[Observations], n_enough: int) -> int:
    """How many of the last steps together have `n_enough` droplets."""
    counts = np.cumsum([len(step) for step in steps[::-1]])
    return 1 + int(np.searchsorted(counts, n_enough))
