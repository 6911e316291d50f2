"""Which part of a film a figure is about: a range of times and of radii."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.errors import FieldProblem, ParametersError
from dropflow.statistics.flow_moments import FlowMoments
from dropflow.statistics.histograms import N_MOMENTS, FrameHistograms
from dropflow.statistics.in_sight import InSight

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Scope:
    """Limits, each included; None is none."""

    from_s: float | None = None
    to_s: float | None = None
    radius_min_um: float | None = None
    radius_max_um: float | None = None

    def __post_init__(self) -> None:
        for low, high in (("from_s", "to_s"), ("radius_min_um", "radius_max_um")):
            first, last = getattr(self, low), getattr(self, high)
            if first is not None and last is not None and not first < last:
                raise ParametersError(
                    "A range goes from a smaller value to a larger one.",
                    fields=[FieldProblem(low, f"must be smaller than {high}")],
                )

    @property
    def has_radii(self) -> bool:
        """Whether radii are limited."""
        return self.radius_min_um is not None or self.radius_max_um is not None

    def times(self, time_s: npt.NDArray[np.float64]) -> Mask:
        """Which times lie inside."""
        return _inside(time_s, self.from_s, self.to_s)

    def radii(self, radius_um: npt.NDArray[np.float64]) -> Mask:
        """Which radii lie inside."""
        return _inside(radius_um, self.radius_min_um, self.radius_max_um)

    def histograms(self, whole: FrameHistograms) -> FrameHistograms:
        """The columns and radius bins whose middles lie inside.

        Over a range of radii the moments are those of the bins' middles; over all radii they stay exact.
        """
        inside = self.times(whole.time_s)
        found = whole if inside.all() else whole[inside]
        if not self.has_radii:
            return found
        bins = self.bins(whole.edges_um)
        counts, radius_um = found.counts[:, bins], whole.radius_um[bins]
        moments = np.stack([(counts * radius_um**power).sum(axis=1) for power in range(N_MOMENTS)], axis=1)
        return replace(found, edges_um=whole.edges_um[bins[0] : bins[-1] + 2], counts=counts, moments=moments)

    def bins(self, edges_um: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """The radius bins whose middles (in log r) lie inside, at least one.

        Raises
        ------
        ParametersError
            None does.
        """
        bins = np.flatnonzero(self.radii(np.sqrt(edges_um[:-1] * edges_um[1:])))
        if not len(bins):
            raise ParametersError(
                "No radius bin lies in this range.",
                fields=[FieldProblem("radius_min_um", f"bins go from {edges_um[0]:g} to {edges_um[-1]:g}")],
            )
        return bins

    def seen(self, whole: InSight, radius_um: npt.NDArray[np.float64]) -> InSight:
        """Of the radius bins whose middles lie inside."""
        return InSight(whole.n_frames, whole.counts[self.radii(radius_um)])

    def flow(self, whole: FlowMoments) -> FlowMoments:
        """The steps that begin inside."""
        inside = self.times(whole.time_s)
        if inside.all():
            return whole
        return FlowMoments(whole.time_s[inside], whole.mean_um_s[inside], whole.rms_um_s[inside])

    def trajectories(self, whole: pl.DataFrame) -> pl.DataFrame:
        """Those whose middle in time and mean radius lie inside."""
        middle_s = (pl.col("start_s") + pl.col("end_s")) / 2
        return whole.filter(self._rows(middle_s, self.from_s, self.to_s), self._radius(pl.col("r_mean_um")))

    def events(self, whole: pl.DataFrame) -> pl.DataFrame:
        """Coalescences inside; the radius is that of the droplet they made."""
        return whole.filter(self._rows(pl.col("time_s"), self.from_s, self.to_s), self._radius(pl.col("r_product_um")))

    def _radius(self, radius: pl.Expr) -> pl.Expr:
        return self._rows(radius, self.radius_min_um, self.radius_max_um)

    @staticmethod
    def _rows(values: pl.Expr, low: float | None, high: float | None) -> pl.Expr:
        inside = pl.lit(value=True)
        if low is not None:
            inside &= values >= low
        return inside if high is None else inside & (values <= high)


def _inside(values: npt.NDArray[np.float64], low: float | None, high: float | None) -> Mask:
    inside = np.ones(values.shape, bool)
    if low is not None:
        inside &= values >= low
    if high is not None:
        inside &= values <= high
    return inside
