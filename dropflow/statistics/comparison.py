"""Periods of several experiments against what drives them (section 4.7, Fig. 15)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from dropflow.statistics.findings import Findings
from dropflow.statistics.oscillations import PeriodLaw, driving_group, period_law

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class DrivenPeriods:
    """The certain periods of one experiment and its driving parameter."""

    name: str
    driving_per_s: float
    """xi."""
    period_s: Floats
    period_std_s: Floats


@dataclass(frozen=True)
class LeftOut:
    """An experiment that has no place in the comparison."""

    name: str
    reason: str


def driven_periods(name: str, found: Findings, *, driving_per_s: float | None = None) -> DrivenPeriods | LeftOut:
    """What an experiment adds to the comparison, or why it adds nothing.

    Parameters
    ----------
    name
        What it is called beside the others.
    found
        Its statistics.
    driving_per_s
        xi where it is known from elsewhere; else the mean over its temperature log.
    """
    if driving_per_s is None and found.driving is not None:
        driving_per_s = found.driving.mean_per_s
    if driving_per_s is None or not np.isfinite(driving_per_s) or driving_per_s <= 0:
        reason = "its driving parameter is not known: it needs a temperature log and a material with a binodal"
        return LeftOut(name, reason)
    certain = found.oscillations.is_period_certain
    if not certain.any():
        return LeftOut(name, "it has no two certain oscillations")
    return DrivenPeriods(
        name, driving_per_s, found.oscillations.period_s[certain], found.oscillations.period_std_s[certain]
    )


def law_of(experiments: Sequence[DrivenPeriods]) -> PeriodLaw:
    """The exponent of the period against xi; periods of one experiment share its xi and may err together."""
    n_each = [len(one.period_s) for one in experiments]
    driving = np.repeat([one.driving_per_s for one in experiments], n_each)
    period_s = np.concatenate([np.empty(0), *(one.period_s for one in experiments)])
    return period_law(driving, period_s, experiment=np.repeat(np.arange(len(experiments)), n_each))


def table_of(experiments: Sequence[DrivenPeriods]) -> pl.DataFrame:
    """One row a period."""
    n_each = [len(one.period_s) for one in experiments]
    driving = np.repeat([one.driving_per_s for one in experiments], n_each).astype(np.float64)
    nothing = np.empty(0)
    return pl.DataFrame(
        {
            "experiment": pl.Series([one.name for one in experiments for _ in one.period_s], dtype=pl.String),
            "driving_per_s": driving,
            "group": driving_group(driving),
            "period_s": np.concatenate([nothing, *(one.period_s for one in experiments)]),
            "period_std_s": np.concatenate([nothing, *(one.period_std_s for one in experiments)]),
        }
    )
