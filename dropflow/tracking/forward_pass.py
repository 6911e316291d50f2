"""Forward tracking over the whole film (section 3.3.1)."""

from dropflow.tracking.chain import Chain
from dropflow.tracking.checkpoint import Arrays, Spool
from dropflow.tracking.film import Film
from dropflow.tracking.front import Front
from dropflow.tracking.notes import notes_to_table
from dropflow.tracking.stages import Tick


class ForwardPass:
    """From the first frame to the last: every detection gets into a trajectory, if only its own."""

    name = "forward"

    def __init__(self, film: Film, chain: Chain, rows: Spool, notes: Spool) -> None:
        self._film = film
        self._rows = rows
        self._notes = notes
        self._chain = chain
        self._walk = chain.forward()
        self.n_parts = film.n_parts

    def n_frames_of(self, turn: int) -> int:
        """Frames of one part."""
        return len(self._film.frames_of(turn))

    def begin(self, before: Arrays) -> None:
        """Nothing comes before."""

    def run(self, turn: int, tick: Tick) -> None:
        """Track through the frames of one part."""
        fronts, notes = [], []
        frames = self._film.frames_of(turn)
        for frame in frames:
            dt_s = self._film.dt_s(frame - 1) if frame else 1.0  # into the first frame nothing moves
            motion = self._film.motion(self._chain.motion, max(frame - 1, 0))
            step = self._walk.step(self._film.detected(frame), self._film.look_at(frame, then=frame + 1), dt_s, motion)
            fronts.append(step.front)
            notes.append(step.notes)
            tick()
        self._rows.write(turn, Front.to_table(fronts, frames[0]))
        self._notes.write(turn, notes_to_table(notes, frames[0]))

    def state(self) -> Arrays:
        """The walk's."""
        return self._walk.state()

    def restore(self, arrays: Arrays) -> None:
        """Go on from `arrays`."""
        self._walk.restore(arrays)
