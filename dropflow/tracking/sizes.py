"""What the whole film says of each droplet's size: its radius along the trajectory, and whether it is in focus."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from dropflow.tables import TRAJECTORIES
from dropflow.tracking.checkpoint import Spool
from dropflow.tracking.filtering import VERDICTS, Reason
from dropflow.tracking.focus import MatchCensus, mean_matches
from dropflow.tracking.identification import Indices
from dropflow.tracking.prediction import Motion
from dropflow.tracking.radii import RadiusChanges, RadiusErrors, smoothed_radii

REJECTED = pa.schema([*VERDICTS, ("is_in_focus", pa.bool_()), ("weight", pa.float64())])
"""Rows of `dropflow.tracking.filtering.VERDICTS`, whether the droplet is in focus, and how much it counts.

`weight` is 0 but for those in view too briefly. Those count in the size distribution as much as they are probable; at
the first and last frame less by the share of detections that come to nothing in the frames between.
"""


@dataclass(frozen=True)
class Sizes:
    """What was learnt of a film."""

    errors: RadiusErrors
    least_match: float
    """Trajectories with less are out of focus."""
    product_id: Indices
    """Trajectories in which droplets that coalesced go on, sorted by id and frame."""
    product_frame: Indices
    pixel_size_um: float
    n_frames: int
    """Of the film."""
    share_at_ends: float
    """Of short trajectories at the ends of the film, those that would have gone on."""

    def complete(self, rows: pa.Table) -> pa.Table:
        """Whole trajectories with all columns of `dropflow.tables.TRAJECTORIES`."""
        r_px, std_px = smoothed_radii(rows, self.errors, self._is_product(rows))
        more = {
            "r_smooth_um": r_px * self.pixel_size_um,
            "r_smooth_std_um": std_px * self.pixel_size_um,
            "is_in_focus": ~(mean_matches(rows) < self.least_match),
        }
        for name, values in more.items():
            rows = rows.append_column(TRAJECTORIES.field(name), pa.array(values))
        return rows

    def judged(self, rejected: pa.Table) -> pa.Table:
        """Rows of `REJECTED`."""
        is_in_focus = ~(rejected["match"].to_numpy() < self.least_match)
        probability = np.nan_to_num(rejected["probability"].to_numpy(), nan=1.0)
        is_brief = pc.equal(rejected["reason"], str(Reason.BRIEF)).to_numpy()
        share = np.where(_is_at_end(rejected, self.n_frames), self.share_at_ends, 1.0)
        weight = np.where(is_brief, probability * share, 0.0)
        rejected = rejected.append_column(REJECTED.field("is_in_focus"), pa.array(is_in_focus))
        return rejected.append_column(REJECTED.field("weight"), pa.array(weight))

    def _is_product(self, rows: pa.Table) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        frames, ids = (rows[name].to_numpy().astype(np.int64) for name in ("frame", "trajectory_id"))
        if not len(self.product_id):
            return np.zeros(len(rows), bool)
        span = int(max(frames.max(initial=0), self.product_frame.max())) + 1
        return np.isin(ids * span + frames, self.product_id * span + self.product_frame)


def _is_at_end(judged: pa.Table, n_frames: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.asarray((judged["first_frame"].to_numpy() == 0) | (judged["last_frame"].to_numpy() == n_frames - 1))


def learn_sizes(kept: Spool, verdicts: Spool, n_parts: int, *, n_frames: int, events: Path, motion: Motion) -> Sizes:
    """Go once through the rows and verdicts of a film, a part in memory at a time.

    Parameters
    ----------
    kept
        Rows of kept trajectories, each part sorted by (trajectory_id, frame).
    verdicts
        Rows of `VERDICTS`.
    n_parts, n_frames
        Of both, and of the film.
    events
        Table of `dropflow.tracking.events.EVENTS`.
    motion
        Has the size of a pixel.
    """
    changes, census = RadiusChanges(), MatchCensus()
    n_short, n_brief_at_ends = 0, 0
    for part in range(n_parts):
        changes.add(kept.read(part))
        judged = verdicts.read(part)
        good = judged.filter(pc.equal(judged["reason"], ""))
        census.add(good["match"].to_numpy(), good["n_frames"].to_numpy().astype(np.int64))
        n_short += len(judged.filter(pc.equal(judged["reason"], str(Reason.SHORT))))
        brief = judged.filter(pc.equal(judged["reason"], str(Reason.BRIEF)))
        n_brief_at_ends += int(_is_at_end(brief, n_frames).sum())
    happened = pq.read_table(events, columns=["product_id", "frame"], filters=[("kind", "=", "coalescence")])
    product_id, product_frame = (happened[name].to_numpy().astype(np.int64) for name in ("product_id", "frame"))
    n_expected = 2 * n_short / max(n_frames - 2, 1)  # there as in any other frame
    share_at_ends = max(1 - n_expected / max(n_brief_at_ends, 1), 0.0)
    return Sizes(
        errors=changes.errors(),
        least_match=census.least_match(),
        product_id=product_id,
        product_frame=product_frame,
        pixel_size_um=motion.pixel_size_um,
        n_frames=n_frames,
        share_at_ends=share_at_ends,
    )
