"""Single trajectories and short pieces of many, out of the table of a film."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from backend.models import Product
from backend.platform.object_store import ObjectStore

FILE = "trajectories.parquet"
_PLACE = ["trajectory_id", "frame", "x_px", "y_px"]
_COLUMNS = [
    *_PLACE,
    *("time_s", "r_px", "r_um", "r_std_px", "match", "probability", "is_detected"),
    *("u_um_s", "v_um_s", "sedimentation_um_s"),
]


def frames_between(store: ObjectStore, product: Product, first: int, last: int) -> pa.Table:
    """Places of all trajectories in the frames from `first` to `last`, both of them too."""
    with store.open(product.prefix + FILE) as file:
        return pq.read_table(file, columns=_PLACE, filters=[("frame", ">=", first), ("frame", "<=", last)])


def one(store: ObjectStore, product: Product, trajectory_id: int) -> pa.Table:
    """The rows of one trajectory, in the order of frames."""
    with store.open(product.prefix + FILE) as file:
        rows = pq.read_table(file, columns=_COLUMNS, filters=[("trajectory_id", "=", trajectory_id)])
    return rows.sort_by("frame")


def tails(rows: pa.Table, frame: int) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], pa.Table]:
    """Ids, offsets and points of the trajectories that are in `frame` itself."""
    there = rows.filter(pc.equal(rows["frame"], frame))["trajectory_id"]
    kept = rows.filter(pc.is_in(rows["trajectory_id"], value_set=there.combine_chunks()))
    kept = kept.sort_by([("trajectory_id", "ascending"), ("frame", "ascending")])
    ids, starts = np.unique(kept["trajectory_id"].to_numpy(), return_index=True)
    return ids, np.append(starts, len(kept)), kept


def values(rows: pa.Table, name: str) -> list[Any]:
    """A column as JSON has it: what is not a number is null."""
    column = rows[name].to_numpy(zero_copy_only=False)
    if column.dtype.kind != "f":
        return list(column.tolist())
    return [value if np.isfinite(value) else None for value in column.tolist()]
