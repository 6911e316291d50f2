"""How well droplets were found and measured."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.scoring.matching import Matching
from dropflow.simulation.truth import Visibility

Column = npt.NDArray[np.float64]

RADIUS_CLASSES_PX = {"<10": (0.0, 10.0), "10-16": (10.0, 16.0), "16-32": (16.0, 32.0), ">=32": (32.0, np.inf)}


@dataclass(frozen=True)
class DetectionScore:
    """Droplets against truth. A number is None where nothing was there to count."""

    n_results: int
    n_visible: int
    """True droplets that count as visible."""
    n_right: int
    """Results that match a visible droplet."""
    n_borderline: int
    """Results that match a borderline droplet; they count neither way."""
    n_not_visible: int
    """Results that match a real droplet which counts as not visible."""
    n_false: int
    """Results that match no droplet at all."""
    precision: float | None
    """Right over all but borderline ones: those that match a droplet which is not visible count as false."""
    precision_any: float | None
    """Share of the results that match any real droplet."""
    recall: float | None
    """Share of the visible droplets that were found."""
    f1: float | None
    recall_by_radius_px: dict[str, float | None]
    radius_bias_percent: float | None
    """Median of (r - true r) / true r over right results."""
    radius_sd_percent: float | None
    """Standard deviation of the same, about its mean."""
    radius_robust_sd_percent: float | None
    """1.4826 times the median absolute deviation of the same."""
    position_median_px: float | None
    """Median distance to the true centre."""
    r_coverage: float | None
    """Share of right results whose radius is within `r_std_px` of the truth: 0.68 if that is a standard deviation."""
    x_coverage: float | None
    """Share of their coordinates (x and y) within `x_std_px`."""


def score_detection(matching: Matching) -> DetectionScore:
    """Precision, recall, radius and position errors of `matching`, which holds the results of all frames."""
    is_right = matching.is_matched_to(Visibility.VISIBLE)
    n_borderline = int(matching.is_matched_to(Visibility.BORDERLINE).sum())
    n_results, n_right = len(is_right), int(is_right.sum())
    n_false = int((matching.truth_row < 0).sum())
    is_visible = matching.truth_is(Visibility.VISIBLE)
    precision = share(n_right, n_results - n_borderline)
    recall = share(n_right, int(is_visible.sum()))
    return DetectionScore(
        n_results=n_results,
        n_visible=int(is_visible.sum()),
        n_right=n_right,
        n_borderline=n_borderline,
        n_not_visible=n_results - n_right - n_borderline - n_false,
        n_false=n_false,
        precision=precision,
        precision_any=share(n_results - n_false, n_results),
        recall=recall,
        f1=share(2 * n_right, n_results - n_borderline + int(is_visible.sum())),
        recall_by_radius_px=_recall_by_radius(matching, is_right, is_visible),
        **_errors(matching, is_right),
    )


def share(part: float, whole: float) -> float | None:
    """`part` over `whole`; None of nothing."""
    return part / whole if whole else None


def _recall_by_radius(
    matching: Matching, is_right: npt.NDArray[np.bool_], is_visible: npt.NDArray[np.bool_]
) -> dict[str, float | None]:
    r_px = matching.truth["r_px"].to_numpy()
    is_found = np.zeros(len(r_px), bool)
    is_found[matching.truth_row[is_right]] = True
    recalls = {}
    for name, (low, high) in RADIUS_CLASSES_PX.items():
        of_class = is_visible & (r_px >= low) & (r_px < high)
        recalls[name] = share(int((is_found & of_class).sum()), int(of_class.sum()))
    return recalls


def _errors(matching: Matching, is_right: npt.NDArray[np.bool_]) -> dict[str, float | None]:
    results, truth = matching.results, matching.truth
    partner = matching.truth_row[is_right]
    x, y, r = (
        results[name].to_numpy()[is_right] - truth[name].to_numpy()[partner] for name in ("x_px", "y_px", "r_px")
    )
    percent = 100.0 * r / truth["r_px"].to_numpy()[partner]
    errors: dict[str, float | None] = dict.fromkeys(
        (
            "radius_bias_percent",
            "radius_sd_percent",
            "radius_robust_sd_percent",
            "position_median_px",
            "r_coverage",
            "x_coverage",
        )
    )
    if len(percent) == 0:
        return errors
    bias = float(np.median(percent))
    errors["radius_bias_percent"] = bias
    errors["radius_sd_percent"] = float(np.std(percent))
    errors["radius_robust_sd_percent"] = float(1.4826 * np.median(np.abs(percent - bias)))
    errors["position_median_px"] = float(np.median(np.hypot(x, y)))
    if "r_std_px" in results.column_names:
        errors["r_coverage"] = float(np.mean(np.abs(r) <= results["r_std_px"].to_numpy()[is_right]))
    if "x_std_px" in results.column_names:
        std = results["x_std_px"].to_numpy()[is_right]
        errors["x_coverage"] = float(np.mean([np.abs(x) <= std, np.abs(y) <= std]))
    return errors
