"""Sums of decision trees as arrays: small to store, quick to evaluate, and without the library that grew them."""

from dataclasses import dataclass, fields

import numba
import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trees:
    """A sum of trees. Rows go left where their feature is at most the threshold, or missing and `missing_left`."""

    feature: npt.NDArray[np.int16]
    """Shape (nodes,); -1 for a leaf."""
    threshold: npt.NDArray[np.float32]
    left: npt.NDArray[np.int16]
    """Distance to the left child in nodes; children stand behind their parent."""
    right: npt.NDArray[np.int16]
    missing_left: npt.NDArray[np.bool_]
    value: npt.NDArray[np.float32]
    """Of leaves."""
    root: npt.NDArray[np.int32]
    """First node of each tree."""
    baseline: npt.NDArray[np.float32]
    """Shape (1,): the sum before the first tree."""

    def predict(self, rows: Column) -> Column:
        """The sum for each row of `rows`, shape (n, features)."""
        return _predict(
            rows, self.feature, self.threshold, self.left, self.right, self.missing_left, self.value, self.root
        ) + float(self.baseline[0])

    def to_arrays(self, prefix: str) -> dict[str, npt.NDArray[np.generic]]:
        """Arrays to be stored under names with this prefix."""
        return {f"{prefix}_{field.name}": getattr(self, field.name) for field in fields(self)}

    @staticmethod
    def from_arrays(arrays: dict[str, npt.NDArray[np.generic]], prefix: str) -> "Trees":
        """What `to_arrays` gave."""
        return Trees(*(arrays[f"{prefix}_{field.name}"] for field in fields(Trees)))  # type: ignore[arg-type]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _predict(
    rows: Column,
    feature: npt.NDArray[np.int16],
    threshold: npt.NDArray[np.float32],
    left: npt.NDArray[np.int16],
    right: npt.NDArray[np.int16],
    missing_left: npt.NDArray[np.bool_],
    value: npt.NDArray[np.float32],
    root: npt.NDArray[np.int32],
) -> Column:
    total = np.zeros(rows.shape[0])
    # Tree by tree: its nodes stay in the nearest cache while all rows pass.
    for tree in range(root.size):
        for i in range(rows.shape[0]):
            node = root[tree]
            while feature[node] >= 0:
                entry = rows[i, feature[node]]
                goes_left = missing_left[node] if entry != entry else entry <= threshold[node]
                node += left[node] if goes_left else right[node]
            total[i] += value[node]
    return total
