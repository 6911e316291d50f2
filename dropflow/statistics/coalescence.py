"""Coalescence: two trajectories end where one begins, with the volume of both (section 5)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl
from scipy.spatial import cKDTree

Floats = npt.NDArray[np.float64]

EVENT_COLUMNS = {
    "frame": pl.Int32,
    "time_s": pl.Float64,
    "parent_1": pl.Int64,
    "parent_2": pl.Int64,
    "product": pl.Int64,
    "x_um": pl.Float64,
    "y_um": pl.Float64,
    "r_1_um": pl.Float64,
    "r_2_um": pl.Float64,
    "r_product_um": pl.Float64,
    "volume_residual": pl.Float64,
}
"""One row an event. `volume_residual` is the product's volume minus the parents', in its own standard deviations."""


def coalescence_events(
    trajectories: pl.DataFrame, *, relative_radius_std: float, frame_shape_um: tuple[float, float], n_sigma: float = 3.0
) -> pl.DataFrame:
    """Find pairs of trajectories that end in one frame where another begins in the next.

    The parents' next places, by their last velocities, must lie within the product's radius plus their own of its
    first place, touch each other, and their volumes must add up to the product's within `n_sigma`.

    Parameters
    ----------
    trajectories
        One row a trajectory (`summarise_trajectories`).
    relative_radius_std
        Uncertainty of `r_first_um` and `r_last_um` over the radius. A volume has three times as much.
    frame_shape_um
        Height and width of the frame: droplets that leave it end, too, and are left out.
    n_sigma
        How well the volume must be conserved.
    """
    ends, begins = (
        _inner(trajectories, "x_next_um", "y_next_um", frame_shape_um),
        _inner(trajectories, "x_first_um", "y_first_um", frame_shape_um),
    )
    begins = begins.filter(pl.col("first_frame") > 0)
    product, parent = _near(ends, begins)
    rows = _pairs(product, parent)
    events = _described(ends, begins, rows, relative_radius_std)
    return _best(events.filter(pl.col("volume_residual").abs() <= n_sigma))


def _inner(trajectories: pl.DataFrame, x: str, y: str, frame_shape_um: tuple[float, float]) -> pl.DataFrame:
    height_um, width_um = frame_shape_um
    r = pl.col("r_mean_um")
    return trajectories.filter(
        (pl.col(x) > r) & (pl.col(x) < width_um - r) & (pl.col(y) > r) & (pl.col(y) < height_um - r)
    )


def _near(ends: pl.DataFrame, begins: pl.DataFrame) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Indices of a product and of a trajectory that ended in the frame before, near enough to be a parent."""
    none = np.empty(0, np.int64)
    if ends.is_empty() or begins.is_empty():
        return none, none
    # Frames stand so far apart in a third dimension that only the right one is near.
    far_um = 1e3 * float(begins["r_first_um"].to_numpy().max()) + 1e4
    at = np.stack([begins["x_first_um"], begins["y_first_um"], begins["first_frame"].to_numpy() * far_um], axis=1)
    gone = np.stack([ends["x_next_um"], ends["y_next_um"], (ends["last_frame"].to_numpy() + 1.0) * far_um], axis=1)
    reach_um = 2.0 * begins["r_first_um"].to_numpy()
    found = cKDTree(gone).query_ball_point(at, reach_um)
    product = np.repeat(np.arange(len(found)), [len(near) for near in found])
    parent = np.array([index for near in found for index in near], np.int64)
    return product.astype(np.int64), parent


def _pairs(product: npt.NDArray[np.int64], parent: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """All pairs of candidate parents of the same product, shape (n, 3): product, parent, parent."""
    candidates = pl.DataFrame({"product": product, "parent": parent})
    both = candidates.join(candidates, on="product", suffix="_2").filter(pl.col("parent") < pl.col("parent_2"))
    return both.select("product", "parent", "parent_2").to_numpy().astype(np.int64)


def _described(
    ends: pl.DataFrame, begins: pl.DataFrame, rows: npt.NDArray[np.int64], relative_radius_std: float
) -> pl.DataFrame:
    made, one, two = begins[rows[:, 0]], ends[rows[:, 1]], ends[rows[:, 2]]
    r, r1, r2 = (part[name].to_numpy() for part, name in ((made, "r_first_um"), (one, "r_last_um"), (two, "r_last_um")))
    apart = np.hypot(
        one["x_next_um"].to_numpy() - two["x_next_um"].to_numpy(),
        one["y_next_um"].to_numpy() - two["y_next_um"].to_numpy(),
    )
    centre = [
        (one[f"{axis}_next_um"].to_numpy() * r1**3 + two[f"{axis}_next_um"].to_numpy() * r2**3) / (r1**3 + r2**3)
        for axis in "xy"
    ]
    off = np.hypot(made["x_first_um"].to_numpy() - centre[0], made["y_first_um"].to_numpy() - centre[1])
    uncertainty = 3 * relative_radius_std * np.sqrt(r**6 + r1**6 + r2**6)
    events = pl.DataFrame(
        {
            "frame": made["first_frame"],
            "time_s": made["start_s"],
            "parent_1": one["trajectory_id"],
            "parent_2": two["trajectory_id"],
            "product": made["trajectory_id"],
            "x_um": made["x_first_um"],
            "y_um": made["y_first_um"],
            "r_1_um": r1,
            "r_2_um": r2,
            "r_product_um": r,
            "volume_residual": (r**3 - r1**3 - r2**3) / uncertainty,
            "off_um": off,
        }
    )
    is_near = (apart <= 1.3 * (r1 + r2)) & (off <= 0.5 * r + 2.0)
    return events.filter(pl.Series(is_near))


def _best(events: pl.DataFrame) -> pl.DataFrame:
    """Each trajectory takes part in one event at most on either side: nearer ones first."""
    ordered = events.sort("off_um")
    taken: set[int] = set()
    kept = []
    for index, (product, one, two) in enumerate(ordered.select("product", "parent_1", "parent_2").iter_rows()):
        # A trajectory may be the product of one event and a parent in another: the keys of its ends differ.
        ends = {2 * product, 2 * one + 1, 2 * two + 1}
        if not ends & taken:
            taken |= ends
            kept.append(index)
    return ordered[kept].drop("off_um").sort("frame", "product").cast(EVENT_COLUMNS)  # type: ignore[arg-type]


@dataclass(frozen=True)
class CoalescenceRates:
    """Events by the radii of both partners."""

    edges_um: Floats
    """Shape (n + 1,)."""
    counts: npt.NDArray[np.int64]
    """Shape (n, n): smaller partner along the first axis, larger along the second."""
    rate_per_um2_s: Floats
    """Events per area of the frame and time, shape (n, n); its relative error is 1 / sqrt(counts)."""


def coalescence_rates(
    events: pl.DataFrame, edges_um: Floats, *, area_um2: float, duration_s: float
) -> CoalescenceRates:
    """Count events by size pair, per area and time."""
    r = np.sort(np.stack([events["r_1_um"].to_numpy(), events["r_2_um"].to_numpy()]), axis=0)
    counts, _, _ = np.histogram2d(r[0], r[1], bins=(edges_um, edges_um))
    rate = counts / (area_um2 * duration_s) if duration_s > 0 else np.zeros_like(counts)
    return CoalescenceRates(edges_um, counts.astype(np.int64), rate)
