"""How well the size distribution was measured, before and after tracking."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.scoring.detection import share
from dropflow.scoring.matching import Matching
from dropflow.simulation.truth import Visibility
from dropflow.statistics.expected_counts import shares_of_bins

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

    Results that match a borderline droplet are left out. Where results have the columns `r_std_um` and `weight`, each
    radius counts with its error and each droplet as much as its weight. Compare the score of ``droplets.parquet``
    (before tracking) with that of the droplets of `dropflow.statistics.counted` (after).
    """
    is_visible = matching.truth_is(Visibility.VISIBLE)
    counts = ~matching.is_matched_to(Visibility.BORDERLINE)
    true = _counts(pa.table({"r_um": matching.truth["r_um"].filter(pa.array(is_visible))}))
    found = _counts(matching.results.filter(pa.array(counts)))
    found_any = _counts(matching.results.filter(pa.array(counts & ~matching.is_matched_to(Visibility.NOT))))
    return SizeScore(
        l1=share(float(np.abs(found - true).sum()), float(true.sum())),
        l1_any=share(float(np.abs(found_any - true).sum()), float(true.sum())),
        l1_shape=float(np.abs(found / found.sum() - true / true.sum()).sum()) if found.any() and true.any() else None,
    )


def _counts(rows: pa.Table) -> npt.NDArray[np.float64]:
    r_um = rows["r_um"].to_numpy()
    std_um = rows["r_std_um"].to_numpy() if "r_std_um" in rows.column_names else np.zeros(len(rows))
    weight = rows["weight"].to_numpy() if "weight" in rows.column_names else np.ones(len(rows))
    counts = np.zeros(len(EDGES_UM) + 1)
    for which, radius_bin, part in shares_of_bins(r_um, std_um, EDGES_UM):
        counts += np.bincount(radius_bin, part * weight[which], len(counts))
    return counts[1:-1]
