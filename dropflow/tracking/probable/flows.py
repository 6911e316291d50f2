"""The final flow field of each step, from the droplets of the step and its neighbours."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dropflow.parameters import Divergence
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.flow import FlowField, unknown_flow
from dropflow.tracking.front import Front
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.prediction import Motion
from dropflow.tracking.probable.flow_memory import FlowMemory
from dropflow.tracking.probable.flow_record import load_flow, save_flow
from dropflow.tracking.probable.least_squares import Model, Observations, Sums
from dropflow.tracking.probable.observing import along_flow, observe
from dropflow.tracking.probable.regression import WaveFlow, regress_sums, sums_of
from dropflow.tracking.saving import load_columns, prefixed, save_columns, without_prefix

_LAG = 1
"""Steps before and after that take part: changes of the flow that are even in time cancel."""

_MOST_JUMP_RMS = 0.5
"""By which part of the flow's rms the median velocity may differ in steps that are taken together."""


@dataclass
class _Step:
    """A step, and what several fields need of it, reckoned once."""

    seen: Observations
    px_per_um_s: float
    """Displacement in the step by a velocity of 1 um/s."""
    _sums: Sums | None = None

    @cached_property
    def usual_um_s(self) -> Column:
        """Median velocity, across `up` and along it."""
        return np.array([np.median(self.seen.across_um_s), np.median(self.seen.along_um_s)])

    def summed_under(self, model: Model) -> Sums:
        """What least squares need; the noise of the model stays the same on this way through the film."""
        if self._sums is None:
            self._sums = sums_of(self.seen, model)
        return self._sums

    def along_flow(self, flow: WaveFlow | None) -> "_Step":
        """With velocities along the ways in a flow; as it is where none is known."""
        if flow is None:
            return self
        return _Step(along_flow(self.seen, flow, self.px_per_um_s), self.px_per_um_s)


class ProbableFlows:
    """Regression over a few steps around each."""

    def __init__(self, grid: Grid, motion: Motion, divergence: Divergence) -> None:
        self._grid = grid
        self._motion = motion
        self._flow = FlowMemory(grid, motion.up, divergence)
        self._window: list[_Step] = []
        self._last: WaveFlow | None = None
        """The flow of the step before, along whose ways velocities are taken."""
        self._n_after = 0
        """Steps of the window whose field is still to come."""

    def add(self, before: Front, after: Front, dt_s: float, motion: Motion) -> Iterable[FlowField]:
        """Take a step; give the field of the one `_LAG` steps before."""
        self._motion = motion
        weight = (before.is_seen & after.is_seen).astype(np.float64)
        seen = observe(
            self._motion,
            before.droplets,
            after.droplets,
            dt_s,
            log_r=np.log(after.smooth_r_px),
            log_r_variance=after.log_r_std**2,
            weight=weight,
        )
        self._window.append(_Step(seen, dt_s / motion.pixel_size_um).along_flow(self._last))
        self._n_after += 1
        return [self._next()] if self._n_after > _LAG else []

    def finish(self) -> Iterable[FlowField]:
        """The fields of the last steps."""
        return [self._next() for _ in range(self._n_after)]

    def _next(self) -> FlowField:
        flow = self._regressed()
        if flow is not None and self._last is None:  # found as if all ways were straight
            self._window = [step.along_flow(flow) for step in self._window]
            flow = self._regressed()
        centre = len(self._window) - self._n_after
        field = unknown_flow(self._grid) if flow is None else on_grid(flow, self._window[centre].seen, self._grid)
        self._last = flow or self._last
        self._n_after -= 1
        self._window = self._window[max(centre + 1 - _LAG, 0) :]
        return field

    def _has_jumped(self, here: _Step, other: _Step) -> bool:
        """Whether everything moves otherwise in another step, as when the camera was pushed in one of them."""
        if self._flow.model is None or not len(here.seen) or not len(other.seen):
            return False
        jump_um_s = np.hypot(*(other.usual_um_s - here.usual_um_s))
        return bool(jump_um_s > _MOST_JUMP_RMS * self._flow.model.spectrum.rms_um_s)

    def _regressed(self) -> WaveFlow | None:
        """The flow of the step whose field is next."""
        centre = len(self._window) - self._n_after
        here = self._window[centre]
        near = self._window[max(centre - _LAG, 0) : centre + _LAG + 1]
        around = [step for step in near if step is here or not self._has_jumped(here, step)]
        n_seen = sum(len(step.seen) for step in around)
        if self._flow.model is None and n_seen:
            self._flow.estimate([Observations.concatenate([step.seen for step in around])])
        if self._flow.model is None or not n_seen:
            return None
        first, *others = (step.summed_under(self._flow.model) for step in around)
        flow = regress_sums(sum(others, start=first), self._flow.model)
        mean, variance = flow.stokes_error
        self._flow.model = replace(self._flow.model, factor_mean=mean, factor_variance=max(variance, 1e-5))
        return flow

    def learn_from(self, arrays: Arrays) -> None:
        """Take up the model of the flow."""
        self._flow.learn_from(without_prefix("flow.", arrays))

    def state(self) -> Arrays:
        """The window and what is known of the flow."""
        arrays = prefixed("flow.", self._flow.state())
        for index, step in enumerate(self._window):
            arrays |= save_columns(f"window{index}", step.seen)
        if self._last is not None:
            arrays |= prefixed("last.", save_flow(self._last))
        px_per_um_s = np.array([step.px_per_um_s for step in self._window])
        return arrays | {"window": np.array([len(self._window), self._n_after]), "px_per_um_s": px_per_um_s}

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._flow.restore(without_prefix("flow.", arrays))
        _, self._n_after = arrays["window"].tolist()
        self._window = [
            _Step(load_columns(f"window{index}", Observations, arrays), px_per_um_s)
            for index, px_per_um_s in enumerate(arrays["px_per_um_s"].tolist())
        ]
        last = without_prefix("last.", arrays)
        self._last = load_flow(last, self._motion.up) if last else None


def on_grid(flow: WaveFlow, here: Observations, grid: Grid) -> FlowField:
    """The flow at the centres of cells; a cell is interpolated where neither it nor one beside it has a droplet."""
    shape = (grid.n_rows, grid.n_columns)
    velocity, (across, along) = flow.on_grid(grid.x_px, grid.y_px)
    side, up = flow.model.up[1] ** 2, flow.model.up[0] ** 2
    std = np.sqrt(np.stack([side * across + up * along, up * across + side * along]))
    count = np.bincount(grid.cell_of(here.x_px, here.y_px), minlength=grid.n_rows * grid.n_columns).reshape(shape)
    near = count > 0
    beside = near.copy()
    beside[1:] |= near[:-1]
    beside[:-1] |= near[1:]
    beside[:, 1:] |= near[:, :-1]
    beside[:, :-1] |= near[:, 1:]
    return FlowField(grid, velocity, std, count.astype(np.int64), ~beside)
