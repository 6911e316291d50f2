"""How well the size distribution was measured, before and after tracking."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.scoring.detection import share
from dropflow.scoring.matching import Matching
from dropflow.simulation.truth import Visibility

EDGES_UM = np.concatenate([[0.0], np.geomspace(2.0, 80.0, 28), [np.inf]])
"""Bins of radius, 15 % wide each, and all that is smaller or larger."""


@dataclass(frozen=True)
class SizeScore:
    """Distance of two size distributions. None where there was no true droplet."""

    l1: float | None
    """Sum over bins of |n - true n|, over the number of true droplets: 0 is perfect, no result at all gives 1."""
    l1_any: float | None
    """The same without the results that match a real droplet which counts as not visible."""
    l1_shape: float | None
    """Sum over bins of |share - true share|, from 0 to 2: as `l1`, without the numbers."""


def score_size_distribution(matching: Matching) -> SizeScore:
    """L1 distance between the sizes of the results and those of the visible droplets, over all frames.

    Results that match a borderline droplet are left out. Compare the score of ``droplets.parquet`` (before tracking)
    with that of ``trajectories.parquet`` (after).
    """
    is_visible = matching.truth_is(Visibility.VISIBLE)
    counts = ~matching.is_matched_to(Visibility.BORDERLINE)
    true = _counts(matching.truth["r_um"].to_numpy()[is_visible])
    r_um = matching.results["r_um"].to_numpy()
    found = _counts(r_um[counts])
    found_any = _counts(r_um[counts & ~matching.is_matched_to(Visibility.NOT)])
    return SizeScore(
        l1=share(float(np.abs(found - true).sum()), float(true.sum())),
        l1_any=share(float(np.abs(found_any - true).sum()), float(true.sum())),
        l1_shape=float(np.abs(found / found.sum() - true / true.sum()).sum()) if found.any() and true.any() else None,
    )


def _counts(r_um: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.histogram(r_um, EDGES_UM)[0].astype(np.float64)
