"""Which result is which true droplet: one assignment a frame, on which every score of droplets and links stands."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from scipy.sparse import csr_array
from scipy.sparse.csgraph import min_weight_full_bipartite_matching
from scipy.spatial import cKDTree

from dropflow.errors import ResultsError
from dropflow.simulation.truth import TRUTH, Visibility

MIN_GATE_PX = 3.0
GATE_OVER_RADIUS = 0.5
MAX_RADIUS_RATIO = 2.0
_UNMATCHED_COST = 1e4

Column = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Matching:
    """Results of any number of frames beside the truth."""

    results: pa.Table
    """Droplets or trajectories, columns as in `dropflow.tables`."""
    truth: pa.Table
    """Columns as in `dropflow.simulation.truth.TRUTH`."""
    truth_row: Rows
    """For each row of `results` the row of `truth` that it matches, or -1."""

    def is_matched_to(self, visibility: Visibility) -> npt.NDArray[np.bool_]:
        """For each result, whether it matches a true droplet of this visibility."""
        has_it = np.append(self.truth_is(visibility), False)  # the last entry is that of truth_row == -1
        return np.asarray(has_it[self.truth_row])

    def truth_is(self, visibility: Visibility) -> npt.NDArray[np.bool_]:
        """For each true droplet, whether it has this visibility."""
        return np.asarray(self.truth["visibility"].to_numpy(zero_copy_only=False) == visibility.value)


def match_to_truth(results: pa.Table, truth: pa.Table) -> Matching:
    """Match results with true droplets (of whatever visibility), frame by frame.

    A pair can match if its distance is at most max(3 px, half the true radius) and the ratio of its radii at most 2.
    Of all ways to match as many as can be matched, that with the least sum of distance / gate + |ln(radius ratio)| is
    taken; each result and each droplet is used once.
    """
    check_columns(results, ("frame", "x_px", "y_px", "r_px"), "results")
    check_columns(truth, TRUTH.names, "truth")
    truth_row = np.full(len(results), -1, np.int64)
    true_frames = _rows_by_frame(truth)
    found, real = _places(results), _places(truth)
    for frame, rows in _rows_by_frame(results).items():
        real_rows = true_frames.get(frame)
        if real_rows is not None:
            which, partner = assign(found[rows], real[real_rows])
            truth_row[rows[which]] = real_rows[partner]
    return Matching(results, truth, truth_row)


def assign(found: Column, real: Column) -> tuple[Rows, Rows]:
    """Indices of matched pairs among x, y, r of shape (n, 3) and (m, 3), in pixels."""
    gates = np.maximum(MIN_GATE_PX, GATE_OVER_RADIUS * real[:, 2])
    if len(found) == 0 or len(real) == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    near = cKDTree(found[:, :2]).query_ball_point(real[:, :2], gates)
    column = np.repeat(np.arange(len(real)), [len(rows) for rows in near])
    row = np.concatenate([np.asarray(rows, np.int64) for rows in near])
    log_ratio = np.abs(np.log(found[row, 2] / real[column, 2]))
    distance = np.hypot(found[row, 0] - real[column, 0], found[row, 1] - real[column, 1])
    is_possible = log_ratio <= np.log(MAX_RADIUS_RATIO)
    cost = distance / gates[column] + log_ratio
    return cheapest_pairs(row[is_possible], column[is_possible], cost[is_possible], _UNMATCHED_COST)


def cheapest_pairs(row: Rows, column: Rows, cost: Column, unmatched_cost: float) -> tuple[Rows, Rows]:
    """The assignment of least cost among possible pairs, where each row may stay alone for `unmatched_cost`."""
    if len(row) == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    rows, row = np.unique(row, return_inverse=True)
    columns, column = np.unique(column, return_inverse=True)
    alone = np.arange(len(rows))
    # All costs are raised by one: the solver takes an entry of zero for no entry.
    costs = np.concatenate([cost, np.full(len(rows), unmatched_cost)]) + 1.0
    places = np.concatenate([row, alone]), np.concatenate([column, len(columns) + alone])
    chosen_rows, chosen = min_weight_full_bipartite_matching(
        csr_array((costs, places), shape=(len(rows), len(columns) + len(rows)))
    )
    is_pair = chosen < len(columns)
    return rows[chosen_rows[is_pair]], columns[chosen[is_pair]]


def check_columns(table: pa.Table, names: tuple[str, ...] | list[str], what: str) -> None:
    """An error that names the columns which `table` does not have."""
    missing = [name for name in names if name not in table.column_names]
    if missing:
        raise ResultsError(f"The table of {what} has no column {', '.join(missing)}.", code="results.columns")


def _places(table: pa.Table) -> Column:
    return np.column_stack([table[name].to_numpy() for name in ("x_px", "y_px", "r_px")]).astype(np.float64)


def _rows_by_frame(table: pa.Table) -> dict[int, Rows]:
    frames = table["frame"].to_numpy()
    order = np.argsort(frames, kind="stable")
    values, starts = np.unique(frames[order], return_index=True)
    ends = np.append(starts, len(order))[1:]
    return {int(frame): order[start:end] for frame, start, end in zip(values, starts, ends, strict=True)}
