"""The last walk over the film: names, velocities and the final flow of the trajectories that are kept (3.3.3)."""

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc
import zarr

from dropflow.tables import SIZE_COLUMNS, TRAJECTORIES
from dropflow.tracking.chain import Chain
from dropflow.tracking.checkpoint import Arrays, Spool
from dropflow.tracking.film import Film
from dropflow.tracking.filtering import Reason
from dropflow.tracking.flow import FlowField
from dropflow.tracking.flow_store import FlowStore, create_flow_store
from dropflow.tracking.front import Front, Links
from dropflow.tracking.grid import Column
from dropflow.tracking.naming import Names, number
from dropflow.tracking.ranges import NO_RANGES, grown
from dropflow.tracking.saving import load_columns, load_front, prefixed, save_columns, save_front, without_prefix
from dropflow.tracking.stages import Tick

Columns = dict[str, npt.NDArray[Any]]
"""Rows of `FOLLOWED`, by the names of their columns."""

FOLLOWED = pa.schema([column for column in TRAJECTORIES if column.name not in SIZE_COLUMNS])
"""Rows of `dropflow.tables.TRAJECTORIES` without what only the whole film tells."""


@dataclass(frozen=True)
class Spools:
    """What the passes write for each other."""

    found: Spool
    """Rows as forward tracking found them."""
    notes: Spool
    """What forward tracking leaves for backward tracking."""
    linked: Spool
    """Rows after backward tracking."""
    verdicts: Spool
    kept: Spool
    """Rows of `FOLLOWED`, each part sorted by (trajectory_id, frame)."""
    rejected: Spool

    @staticmethod
    def within(folder: Path) -> "Spools":
        """Spools in a folder."""
        return Spools(*(Spool(folder, field.name) for field in fields(Spools)))

    def remove(self) -> None:
        """Delete all parts."""
        for field in fields(self):
            getattr(self, field.name).remove()


class FinalPass:
    """From the first frame to the last, over the rows and verdicts of backward tracking; looks at no image.

    The rows of a frame are written when the next frame is known, for they hold the velocity towards it.
    """

    name = "final"

    def __init__(self, film: Film, chain: Chain, spools: Spools, flow_path: Path, about: dict[str, Any]) -> None:
        self._film = film
        self._chain = chain
        self._spools = spools
        self.flow_path = flow_path
        self._about = about
        self._names = Names.none()
        self._next_id = 0
        self._front = Front.empty()
        self._velocity_um_s = np.empty((2, 0))
        self._flows = chain.flows()
        self._n_flows = 0
        self._drift_um = np.zeros(2)
        self.ranges = NO_RANGES
        self._n_rejected = np.zeros(len(Reason), np.int64)
        self.n_parts = film.n_parts

    def n_frames_of(self, turn: int) -> int:
        """Frames of one part."""
        return len(self._film.frames_of(turn))

    def begin(self, before: Arrays) -> None:
        """Learn from backward tracking."""
        self._flows.learn_from(without_prefix("walk.", before))

    def run(self, turn: int, tick: Tick) -> None:
        """Finish the rows and flow fields of one part."""
        if turn == 0:
            create_flow_store(self.flow_path, self._chain.grid, self._film.times_s, self._about)
        self._name(turn)
        linked = self._spools.linked.read(turn)
        frame_of_row = linked["frame"].to_numpy()
        tables: list[Columns] = []
        flows: list[FlowField] = []
        frames = self._film.frames_of(turn)
        for frame in frames:
            start, stop = np.searchsorted(frame_of_row, [frame, frame + 1])
            later = self._kept(Front.from_table(linked.slice(start, stop - start)))
            if frame:
                tables.append(self._step_to(later, frame, flows))
            else:
                self._front, self._velocity_um_s = later, np.full((2, len(later)), np.nan)
            tick()
        if frames[-1] == self._film.n_frames - 1:
            tables.append(self._rows(frames[-1]))
            flows.extend(self._flows.finish())
        rows = {name: np.concatenate([np.empty(0), *(some[name] for some in tables)]) for name in FOLLOWED.names}
        order = np.lexsort((rows["frame"], rows["trajectory_id"]))
        self._spools.kept.write(turn, pa.table({name: rows[name][order] for name in rows}, schema=FOLLOWED))
        self._store(flows)

    def _store(self, flows: list[FlowField]) -> None:
        if flows:
            FlowStore(zarr.open_group(self.flow_path, mode="r+")).write(self._n_flows, flows)
        for flow in flows:
            self._drift_um = self._drift_um + flow.mean_um_s() * self._film.dt_s(self._n_flows)
            self._n_flows += 1

    def outcome(self, pushed_um: Column) -> Arrays:
        """The numbers of the whole film, after the last part; pushes of the camera are no drift."""
        duration_s = float(self._film.times_s[-1] - self._film.times_s[0])
        return {
            "n_trajectories": np.asarray(self._next_id - self._n_rejected.sum()),
            "n_rejected": self._n_rejected,
            "drift_um_s": (self._drift_um - pushed_um) / duration_s if duration_s else np.zeros(2),
        }

    def _name(self, part: int) -> None:
        """Number the trajectories whose verdicts are in this part."""
        named = number(self._spools.verdicts.read(part), self._next_id)
        self._next_id += len(named)
        self._names = self._names.with_more(named, frame=self._film.frames_of(part)[0])
        self.ranges = grown(self.ranges, named)
        rejected = named.filter(pc.not_equal(named["reason"], "")).drop_columns(["tracked_id"])
        reasons = rejected["reason"].to_numpy(zero_copy_only=False)
        self._n_rejected += np.array([np.count_nonzero(reasons == str(reason)) for reason in Reason])
        self._spools.rejected.write(part, rejected)

    def _kept(self, front: Front) -> Front:
        ids, is_kept = self._names.of(front.trajectory_id)
        return replace(front, trajectory_id=ids)[is_kept].sorted()

    def _step_to(self, later: Front, frame: int, flows: list[FlowField]) -> Columns:
        """Go on to `later` at `frame`; return the rows of the frame before, and add the flows that are known by now."""
        dt_s = self._film.dt_s(frame - 1)
        links = Links.between(self._front, later)
        before, after = self._front[links.earlier], later[links.later]
        x_px, y_px = after.droplets.x_px - before.droplets.x_px, after.droplets.y_px - before.droplets.y_px
        velocity_um_s = np.stack([x_px, y_px]) * (self._chain.motion.pixel_size_um / dt_s)
        self._velocity_um_s[:, links.earlier] = velocity_um_s
        rows = self._rows(frame - 1)
        self._velocity_um_s = np.full((2, len(later)), np.nan)
        self._velocity_um_s[:, links.later] = velocity_um_s
        self._front = later
        motion = self._film.motion(self._chain.motion, frame - 1)
        flows.extend(self._flows.add(before, after, dt_s, motion))
        return rows

    def _rows(self, frame: int) -> Columns:
        front = self._front
        motion = self._film.motion(self._chain.motion, frame)
        time_s, pixel_size_um = float(self._film.times_s[frame]), motion.pixel_size_um
        return {
            **front.droplets.to_columns(frame=frame, time_s=time_s, pixel_size_um=pixel_size_um),
            "trajectory_id": front.trajectory_id,
            "is_detected": front.is_detected,
            "u_um_s": self._velocity_um_s[0],
            "v_um_s": self._velocity_um_s[1],
            "sedimentation_um_s": motion.sedimentation_um_s(front.smooth_r_px),
        }

    def state(self) -> Arrays:
        """Names, the front with its velocities, and the sums so far."""
        return {
            **save_columns("names", self._names),
            **save_front("front", self._front),
            "next_id": np.asarray(self._next_id),
            "velocity_um_s": self._velocity_um_s,
            **prefixed("flows.", self._flows.state()),
            "n_flows": np.asarray(self._n_flows),
            "drift_um": self._drift_um,
            "ranges": self.ranges,
            "n_rejected": self._n_rejected,
        }

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._names = load_columns("names", Names, arrays)
        self._front = load_front("front", arrays)
        self._next_id = int(arrays["next_id"])
        self._velocity_um_s = arrays["velocity_um_s"]
        self._flows.restore(without_prefix("flows.", arrays))
        self._n_flows = int(arrays["n_flows"])
        self._drift_um = arrays["drift_um"]
        self.ranges = arrays["ranges"]
        self._n_rejected = arrays["n_rejected"]
