"""The columns of every table, once. Names carry units and never change between stages.

Image axes: x right, y down, the centre of the top left pixel is (0, 0), u along x, v along y; frames count from 0.
"""

import pyarrow as pa

DROPLETS = pa.schema(
    [
        ("frame", pa.int32()),
        ("time_s", pa.float64()),
        ("x_px", pa.float64()),
        ("y_px", pa.float64()),
        ("r_px", pa.float64()),
        ("x_um", pa.float64()),
        ("y_um", pa.float64()),
        ("r_um", pa.float64()),
        ("x_std_px", pa.float64()),
        ("r_std_px", pa.float64()),
        ("probability", pa.float64()),
        ("match", pa.float64()),
    ]
)
"""One row a detected droplet, sorted by frame. `x_std_px` holds for either coordinate."""

TRAJECTORIES = pa.schema(
    [
        ("trajectory_id", pa.int64()),
        *DROPLETS,
        ("is_detected", pa.bool_()),
        ("u_um_s", pa.float64()),
        ("v_um_s", pa.float64()),
        ("sedimentation_um_s", pa.float64()),
        ("r_smooth_um", pa.float64()),
        ("r_smooth_std_um", pa.float64()),
        ("is_in_focus", pa.bool_()),
    ]
)
"""One row a droplet of a trajectory, sorted by (trajectory_id, frame).

`is_detected` is false where the droplet was found by prediction. `u_um_s`, `v_um_s` are the velocity of the droplet
towards its next frame (in the last row: from the frame before). `sedimentation_um_s` is the Stokes speed along `up`
(negative where the droplet sinks). `r_smooth_um` is the radius in the light of the whole trajectory (`r_um` that of the
frame alone), `r_smooth_std_um` its standard deviation. `is_in_focus` is the same in all rows of a trajectory.
"""

SIZE_COLUMNS = ("r_smooth_um", "r_smooth_std_um", "is_in_focus")
"""Columns of `TRAJECTORIES` that tables of older versions do not have."""
