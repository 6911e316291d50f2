"""Truth of a simulated film in the form of results, as tracking that makes no mistake would give it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
import pyarrow.parquet as pq
import yaml

from dropflow.droplets import Droplets
from dropflow.experiment import load_experiment
from dropflow.tables import TRAJECTORIES
from tests.dropflow.tracking.generated import Film as Seen


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
        r_smooth_um=pl.col("r_um") * noise,
        r_smooth_std_um=pl.lit(0.0),
        is_in_focus=pl.lit(value=True),
    )
    pq.write_table(rows.select(TRAJECTORIES.names).to_arrow().cast(TRAJECTORIES), output)


def seen_of_truth(film: Path, *, radius_std: float, seed: int = 0) -> Seen:
    """Visible droplets as a good detector would find them: places within 0.15 px, radii within `radius_std`."""
    experiment = load_experiment(film / "experiment.yaml")
    scenario = yaml.safe_load((film / "scenario.yaml").read_text())
    frame_shape = (int(scenario["scenario"]["height_px"]), int(scenario["scenario"]["width_px"]))
    rows = pl.read_parquet(film / "truth.parquet")
    rng = np.random.default_rng(seed)
    frames, known = [], []
    for frame in range(int(scenario["n_frames"])):
        here = rows.filter((pl.col("frame") == frame) & (pl.col("visibility") == "visible"))
        x, y, r = (here[name].to_numpy() for name in ("x_px", "y_px", "r_px"))
        one = np.ones(len(here))
        off = rng.normal(0, 0.15, (2, len(here)))
        noisy = r * (1 + rng.normal(0, radius_std, len(here)))
        frames.append(Droplets(x + off[0], y + off[1], noisy, 0.15 * one, radius_std * r, one, one))
        known.append(here["droplet_id"].to_numpy())
    times_s = np.arange(len(frames)) * float(experiment.frame_interval_s or 1.0)
    return Seen(experiment, frame_shape, times_s, frames, known)


@dataclass(frozen=True)
class Fates:
    """Which droplets became which, from ``events.csv``."""

    product: dict[int, int]
    """Of each droplet that coalesced."""
    frame: dict[int, int]
    """In which each product can be seen first."""

    @staticmethod
    def read(film: Path) -> "Fates":
        events = pl.read_csv(film / "events.csv").filter(pl.col("kind") == "coalescence")
        product, frame = {}, {}
        for one, other, made, at in events.select("droplet_id", "other_id", "product_id", "frame").iter_rows():
            product |= {one: made, other: made}
            frame[made] = at
        return Fates(product, frame)

    def at(self, droplet: int, frame: int) -> int:
        """What a droplet is in a frame, perhaps after several events."""
        while droplet in self.product and self.frame[self.product[droplet]] <= frame:
            droplet = self.product[droplet]
        return droplet


def droplets_of_rows(seen: Seen, trajectories: Path) -> pl.DataFrame:
    """Detected rows of a table of trajectories with the true `droplet_id` of each."""
    of_place = {
        (frame, x, y): droplet
        for frame, (found, known) in enumerate(zip(seen.frames, seen.truth, strict=True))
        for x, y, droplet in zip(found.x_px.tolist(), found.y_px.tolist(), known.tolist(), strict=True)
    }
    rows = pl.read_parquet(trajectories, columns=["trajectory_id", "frame", "x_px", "y_px", "is_detected"])
    rows = rows.filter("is_detected")
    ids = [of_place[place] for place in rows.select("frame", "x_px", "y_px").iter_rows()]
    return rows.select("trajectory_id", "frame", droplet_id=pl.Series(ids))


def large_coalescences(film: Path, fates: Fates) -> set[int]:
    """What two visible droplets became from one frame to the next, the smaller with a fifth of the other's volume."""
    rows = pl.read_parquet(film / "truth.parquet").filter(pl.col("visibility") == "visible")
    radius_um = {(one, frame): r for one, frame, r in rows.select("droplet_id", "frame", "r_um").iter_rows()}
    parts: dict[tuple[int, int], list[float]] = {}
    for (droplet, frame), r in radius_um.items():
        became = fates.at(droplet, frame + 1)
        if became != droplet and (became, frame + 1) in radius_um:
            parts.setdefault((became, frame + 1), []).append(r)
    two = {became: sorted(radii)[-2:] for (became, _), radii in parts.items() if len(radii) > 1}
    return {became for became, (smaller, larger) in two.items() if smaller**3 >= larger**3 / 5}
