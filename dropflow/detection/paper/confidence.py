"""How sure the paper's detection is."""
import numpy as np
import numpy.typing as npt
Column = npt.NDArray[np.float64]
def position_std_px(r: Column) -> Column: return .1*r
def radius_std_px(r: Column) -> Column: return .1*r
def probability(m: Column) -> Column: return m/(m+.5)
