"""Forward tracking over the whole film (section 3.3.1)."""

import numpy as np
import pyarrow as pa

from dropflow.tracking.chain import PaperChain
from dropflow.tracking.checkpoint import Arrays, Spool
from dropflow.tracking.film import Film
from dropflow.tracking.forward import State, advance
from dropflow.tracking.front import Front
from dropflow.tracking.saving import load_flow, load_front, save_flow, save_front
from dropflow.tracking.stages import Tick


class ForwardPass:
    """From the first frame to the last: every detection gets into a trajectory, if only its own."""

    name = "forward"

    def __init__(self, film: Film, chain: PaperChain, rows: Spool) -> None:
        self._film = film
        self._chain = chain
        self._rows = rows
        self._state = State.initial()
        self.n_parts = film.n_parts

    def n_frames_of(self, turn: int) -> int:
        """Frames of one part."""
        return len(self._film.frames_of(turn))

    def run(self, turn: int, tick: Tick) -> None:
        """Track through the frames of one part."""
        tables = []
        for frame in self._film.frames_of(turn):
            self._step_to(frame)
            tables.append(self._state.front.to_table(frame))
            tick()
        self._rows.write(turn, pa.concat_tables(tables))

    def _step_to(self, frame: int) -> None:
        detected = self._film.detected(frame)
        dt_s = self._film.dt_s(frame - 1) if frame else 1.0  # into the first frame nothing moves
        self._state = advance(self._state, detected, self._film.look_at(frame), self._chain, dt_s)

    def state(self) -> Arrays:
        """Where the trajectories are, and the flow there."""
        return {
            **save_front("front", self._state.front),
            **save_flow("flow", self._state.flow),
            "next_id": np.asarray(self._state.next_id),
        }

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        front: Front = load_front("front", arrays)
        flow = load_flow("flow", arrays, self._chain.grid)
        self._state = State(front, flow, int(arrays["next_id"]))
