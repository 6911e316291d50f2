"""Backward tracking over the whole film, and the verdict on each trajectory (sections 3.3.2 and 3.3.3)."""

from dataclasses import replace

import numpy as np
import pyarrow as pa

from dropflow.tracking.chain import Chain
from dropflow.tracking.checkpoint import Arrays, Spool
from dropflow.tracking.film import Film
from dropflow.tracking.filtering import VERDICTS, Trails
from dropflow.tracking.front import Front
from dropflow.tracking.identification import Indices
from dropflow.tracking.notes import notes_of
from dropflow.tracking.saving import load_columns, load_front, prefixed, save_columns, save_front, without_prefix
from dropflow.tracking.stages import Tick


class BackwardPass:
    """From the last frame to the first, over the rows that forward tracking wrote.

    A trajectory is complete, and its verdict known, one frame before it begins. The verdicts of a part are those of
    the trajectories found complete while it was walked: they begin in the part's frames or in the one after.
    """

    name = "backward"

    def __init__(self, film: Film, chain: Chain, found: Spool, notes: Spool, rows: Spool, verdicts: Spool) -> None:
        self._film = film
        self._chain = chain
        self._found = found
        self._notes = notes
        self._rows = rows
        self._verdicts = verdicts
        self._front = Front.empty()
        self._trails = Trails.begin(self._front, film.n_frames)
        self._walk = chain.backward()
        self._notes_of_step: Arrays = {}
        """Those of the step into the frame of the front."""
        self._merged = np.empty((0, 2), np.int64)
        self.n_parts = film.n_parts

    def n_frames_of(self, turn: int) -> int:
        """Frames of one part."""
        return len(self._film.frames_of(self.n_parts - 1 - turn))

    def begin(self, before: Arrays) -> None:
        """Learn from forward tracking."""
        self._walk.learn_from(before)

    def run(self, turn: int, tick: Tick) -> None:
        """Track back through the frames of one part."""
        part = self.n_parts - 1 - turn
        found, notes = self._found.read(part), self._notes.read(part)
        frames = found["frame"].to_numpy()
        fronts: list[Front] = []
        complete: list[Trails] = []
        for frame in reversed(self._film.frames_of(part)):
            start, stop = np.searchsorted(frames, [frame, frame + 1])
            complete.append(self._step_to(frame, Front.from_table(found.slice(start, stop - start))))
            self._notes_of_step = notes_of(notes, frame)
            fronts.append(self._front)
            tick()
        if part == 0:
            complete.append(self._trails)
        self._rows.write(part, Front.to_table(fronts[::-1], self._film.frames_of(part)[0]))
        verdicts = [trails.to_verdicts(self._chain.judge(trails)) for trails in complete]
        self._verdicts.write(part, pa.concat_tables([VERDICTS.empty_table(), *verdicts]))

    def _step_to(self, frame: int, found: Front) -> Trails:
        """Go back to `frame`; return the trails of the trajectories that begin in the frame after it."""
        earlier = replace(found, trajectory_id=self._renamed(found.trajectory_id)).sorted()
        # A droplet that is only thought to be there, and never seen again, has left before.
        earlier = earlier[earlier.is_seen | np.isin(earlier.trajectory_id, self._front.trajectory_id)]
        predicted_px, arrived_px = None, None
        if frame + 1 < self._film.n_frames:
            motion = self._film.motion(self._chain.motion, frame)
            look = self._film.look_at(frame, then=frame - 1)
            step = self._walk.step(self._front, earlier, look, self._film.dt_s(frame), motion, self._notes_of_step)
            earlier, predicted_px, arrived_px = step.front, step.predicted_px, step.arrived_px
            self._merged = np.concatenate([self._merged, np.column_stack([step.merged, step.merged_into])])
        self._front = earlier
        self._trails, complete = self._trails.extend(earlier, frame, predicted_px, arrived_px)
        return complete

    def _renamed(self, found_ids: Indices) -> Indices:
        """The ids that trajectories have by now; what has no more rows to come is forgotten."""
        self._merged = self._merged[np.isin(self._merged[:, 0], found_ids)]
        order = np.argsort(self._merged[:, 0])
        known, names = self._merged[order].T
        if not len(known):
            return found_ids
        at = np.minimum(np.searchsorted(known, found_ids), len(known) - 1)
        return np.where(known[at] == found_ids, names[at], found_ids)

    def state(self) -> Arrays:
        """Where the trajectories are, what became of their names, and how far each was followed."""
        return {
            **save_front("front", self._front),
            **save_columns("trails", self._trails),
            **prefixed("walk.", self._walk.state()),
            **prefixed("notes.", self._notes_of_step),
            "merged": self._merged,
        }

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._front = load_front("front", arrays)
        self._trails = load_columns("trails", Trails, arrays)
        self._walk.restore(without_prefix("walk.", arrays))
        self._notes_of_step = without_prefix("notes.", arrays)
        self._merged = arrays["merged"]
