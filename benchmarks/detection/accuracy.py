"""Accuracy on simulated frames of all scenarios, with their own constants and with constants drawn anew."""

import numpy as np
import pyarrow as pa

from benchmarks.detection.methods import METHODS, table
from benchmarks.detection.stills import Still, still
from dropflow.scoring.detection import DetectionScore, score_detection
from dropflow.scoring.matching import match_to_truth

NAMES = ("easy", "fast", "dirty", "dense", "dark")


def accuracy(n_frames: int, *, height_px: int, width_px: int) -> None:
    """Print a table; trackpy is given the least mass that is best for it, chosen with the truth in hand."""
    for is_varied in (False, True):
        print(
            f"\n{'constants drawn anew' if is_varied else 'the scenarios as they are'}, {n_frames} frames each of "
            f"{height_px} x {width_px} px; recall by radius {', '.join(('<10', '10-16', '16-32', '>=32'))} px"
        )
        print(
            f"{'':8}{'':9}{'F1':>6}{'P':>6}{'R':>6}  {'recall by radius':24}{'r bias %':>9}{'sd %':>6}{'robust':>7}"
            f"{'pos px':>7}{'r cov':>6}{'x cov':>6}{'CPU ms':>7}"
        )
        for name in NAMES:
            first = 100 if is_varied else 0
            stills = [
                still(name, first + n, is_varied=is_varied, height_px=height_px, width_px=width_px)
                for n in range(n_frames)
            ]
            for method in METHODS:
                score, took = scored(stills, method)
                print(f"{name:8}{method:9}{_line(score)}{took:>7.0f}", flush=True)


def scored(stills: list[Still], method: str) -> tuple[DetectionScore, float]:
    """Score of all stills together, and mean CPU ms a frame."""
    found = [METHODS[method](one) for one in stills]
    truth = pa.concat_tables([_framed(one.truth, i) for i, one in enumerate(stills)])
    results = pa.concat_tables([table(droplets, stills[i], i) for i, (droplets, _) in enumerate(found)])
    took = float(np.mean([cpu for _, cpu in found]))
    if method != "trackpy":
        return score_detection(match_to_truth(results, truth)), took
    masses = results["match"].to_numpy()
    best = max(
        (
            score_detection(match_to_truth(results.filter(pa.array(masses >= least)), truth))
            for least in np.quantile(masses, np.arange(0, 0.96, 0.05))
        ),
        key=lambda score: score.f1 or 0.0,
    )
    return best, took


def _framed(truth: pa.Table, frame: int) -> pa.Table:
    place = truth.column_names.index("frame")
    return truth.set_column(place, "frame", pa.array(np.full(len(truth), frame), truth.schema.field("frame").type))


def _line(score: DetectionScore) -> str:
    recall = " ".join("  -  " if value is None else f"{value:.3f}" for value in score.recall_by_radius_px.values())
    cells = [(score.f1, ">6.3f"), (score.precision, ">6.2f"), (score.recall, ">6.2f")]
    rest = [(score.radius_bias_percent, ">+9.1f"), (score.radius_sd_percent, ">6.1f")]
    rest += [(score.radius_robust_sd_percent, ">7.1f"), (score.position_median_px, ">7.2f")]
    rest += [(score.r_coverage, ">6.2f"), (score.x_coverage, ">6.2f")]
    return "".join(_cell(*cell) for cell in cells) + f"  {recall:24}" + "".join(_cell(*cell) for cell in rest)


def _cell(value: float | None, form: str) -> str:
    return format(np.nan if value is None else value, form)
