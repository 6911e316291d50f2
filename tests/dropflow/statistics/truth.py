"""Truth of a simulated film in the form of results, as tracking that makes no mistake would give it."""

from pathlib import Path

import numpy as np
import polars as pl
import pyarrow.parquet as pq

from dropflow.tables import TRAJECTORIES


def write_as_trajectories(truth: Path, output: Path, *, radius_std: float = 0.0, seed: int = 0) -> None:
    """Visible droplets that are seen in three frames in a row at least; radii with this relative noise."""
    rows = pl.read_parquet(truth).filter(pl.col("visibility") == "visible").sort("droplet_id", "frame")
    is_new = (pl.col("droplet_id") != pl.col("droplet_id").shift(1)) | (pl.col("frame") != pl.col("frame").shift(1) + 1)
    rows = rows.with_columns(trajectory_id=is_new.fill_null(value=True).cum_sum().cast(pl.Int64))
    rows = rows.filter(pl.len().over("trajectory_id") >= 3)
    noise = 1 + radius_std * np.random.default_rng(seed).normal(size=len(rows))
    rows = rows.with_columns(
        r_um=pl.col("r_um") * noise,
        r_px=pl.col("r_px") * noise,
        x_std_px=pl.lit(0.1),
        r_std_px=pl.lit(0.1),
        probability=pl.lit(1.0),
        match=pl.lit(1.0),
        is_detected=pl.lit(value=True),
    )
    pq.write_table(rows.select(TRAJECTORIES.names).to_arrow().cast(TRAJECTORIES), output)
