"""Arrays packed into a row come out as they went in."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from backend.platform.packing import pack, unpack


@dataclass(frozen=True)
class _Columns:
    counts: npt.NDArray[np.int64]
    moments: npt.NDArray[np.float64]
    empty: npt.NDArray[np.float64]


@given(
    arrays.arrays(np.int64, st.tuples(st.integers(0, 5), st.integers(0, 5))),
    arrays.arrays(np.float64, st.integers(0, 7)),
)
def test_what_is_unpacked_is_what_was_packed(counts: npt.NDArray[np.int64], moments: npt.NDArray[np.float64]) -> None:
    columns = _Columns(counts.T, moments, np.zeros((0, 4)))
    found = unpack(_Columns, pack(columns))
    for field in fields(_Columns):
        before, after = getattr(columns, field.name), getattr(found, field.name)
        assert before.dtype == after.dtype
        assert np.array_equal(before, after, equal_nan=before.dtype.kind == "f")
