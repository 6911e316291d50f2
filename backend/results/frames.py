"""Droplets and flow of single frames, out of the tables and the flow field."""

from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import zarr

from backend.models import Product
from backend.platform.object_store import ObjectStore
from backend.results.errors import NotYet
from backend.results.schemas import FrameDroplets, FrameFlow
from dropflow.droplets import Droplets

_PLACE = ["x_px", "y_px", "r_px", "match"]


def detected(store: ObjectStore, product: Product, frame: int) -> FrameDroplets:
    """The detections of one frame."""
    with store.open(product.prefix + "droplets.parquet") as file:
        rows = pq.read_table(file, columns=_PLACE, filters=[("frame", "=", frame)])
    return FrameDroplets(frame=frame, **rows.to_pydict())


def detected_droplets(store: ObjectStore, product: Product, frame: int) -> Droplets:
    """The same as detection leaves them."""
    with store.open(product.prefix + "droplets.parquet") as file:
        return Droplets.from_table(pq.read_table(file, filters=[("frame", "=", frame)]))


def tracked(store: ObjectStore, product: Product, frame: int) -> FrameDroplets:
    """The droplets of one frame that belong to trajectories, and where each goes."""
    columns = ["trajectory_id", "frame", *_PLACE, "is_detected"]
    with store.open(product.prefix + "trajectories.parquet") as file:
        rows = pq.read_table(file, columns=columns, filters=[("frame", "in", [frame, frame + 1])])
    now = rows.filter(pa.compute.equal(rows["frame"], frame))
    later = rows.filter(pa.compute.equal(rows["frame"], frame + 1)).select(["trajectory_id", "x_px", "y_px", "r_px"])
    later = later.rename_columns({"x_px": "next_x_px", "y_px": "next_y_px", "r_px": "next_r_px"})
    joined = now.join(later, "trajectory_id").sort_by("trajectory_id").drop_columns(["frame"])
    return FrameDroplets(frame=frame, **joined.to_pydict())


def open_flow(store: ObjectStore, product: Product) -> zarr.Group:
    """The flow field of a film."""
    return zarr.open_group(store.zarr_store(product.prefix + "flow.zarr"), mode="r")


def flow(store: ObjectStore, product: Product, frame: int) -> FrameFlow:
    """The flow between a frame and the next."""
    group = open_flow(store, product)
    velocity = _array(group, "velocity_um_s")
    if frame >= velocity.shape[0]:
        raise NotYet
    u, v = np.asarray(velocity[frame])
    return FrameFlow(
        frame=frame,
        grid_x_px=_values(group, "grid_x_px", ...),
        grid_y_px=_values(group, "grid_y_px", ...),
        u_um_s=u.tolist(),
        v_um_s=v.tolist(),
        droplet_count=_values(group, "droplet_count", frame),
        is_interpolated=_values(group, "is_interpolated", frame),
    )


def _array(group: zarr.Group, name: str) -> zarr.Array[Any]:
    found = group[name]
    if not isinstance(found, zarr.Array):
        raise TypeError(f"{name} is no array of the flow field")
    return found


def _values(group: zarr.Group, name: str, index: Any) -> list[Any]:
    values: list[Any] = np.asarray(_array(group, name)[index]).tolist()
    return values
