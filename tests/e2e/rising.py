"""Discs that rise in still water as Stokes has it: a film of any length whose truth is known."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import tifffile

from dropflow.physics.stokes import sedimentation_um_s
from tests.films import EXPERIMENT

COLUMNS = 1250
PARAMETERS: dict[str, Any] = {
    "detection": {"method": "paper", "radius_min_um": 4.0, "radius_max_um": 20.0},
    "tracking": {"method": "paper"},
    "flow": {"n_columns": 5, "n_rows": 4},
}
_MATERIAL = {"delta_density_kg_m3": -2.0, "viscosity_pa_s": 0.001}
_BYTES_A_PIXEL = 4
_RADII_PX = tuple(6.0 + number % 5 for number in range(15))
_EDGE_PX = 40.0
_NEAR_PX = 0.5
"""How far a disc may be found from where it was drawn."""


@dataclass(frozen=True)
class Rising:
    """Fifteen discs of five sizes, each in a lane of its own, in frames of 32-bit pixels of 1 um, one a second."""

    n_frames: int
    n_rows: int

    @staticmethod
    def of_bytes(n_frames: int, n_bytes: int) -> "Rising":
        """Frames of about so many bytes. Raises ValueError if a disc would leave them."""
        film = Rising(n_frames, n_bytes // _BYTES_A_PIXEL // COLUMNS)
        if float(film._y_px(n_frames - 1).min()) < _EDGE_PX:
            raise ValueError(f"discs leave frames of {film.n_rows} rows in {n_frames} frames: make them bigger")
        return film

    def describe(self, name: str) -> dict[str, Any]:
        """What is to be known of the experiment."""
        return EXPERIMENT | {"name": name, "material": _MATERIAL}

    def draw(self, folder: Path) -> None:
        """Write the frames, each unlike all others."""
        folder.mkdir()
        noise = np.random.default_rng(0).normal(30.0, 1.5, (self.n_rows, COLUMNS)).astype(np.float32)
        for frame in range(self.n_frames):
            image = np.roll(noise, 7 * frame, axis=1)
            for x_px, y_px, r_px in zip(self._x_px, self._y_px(frame), _RADII_PX, strict=True):
                _add_disc(image, float(x_px), float(y_px), r_px)
            tifffile.imwrite(folder / f"frame{frame}.tif", image)

    def check(self, trajectories: bytes) -> str:
        """See that every disc is one trajectory through all frames, where it was drawn, and that there is no other."""
        table = pq.read_table(io.BytesIO(trajectories))
        names = pc.unique(table["trajectory_id"]).to_pylist()
        assert len(names) == len(_RADII_PX), f"{len(names)} trajectories of {len(_RADII_PX)} discs"
        lanes, furthest_px = set(), 0.0
        for name in names:
            lane, error_px = self._compare(table.filter(pc.equal(table["trajectory_id"], name)))
            lanes.add(lane)
            furthest_px = max(furthest_px, error_px)
        assert len(lanes) == len(_RADII_PX), f"trajectories are only in lanes {sorted(lanes)}"
        assert furthest_px < _NEAR_PX, f"a disc was found {furthest_px:.2f} px from where it was drawn"
        return f"{len(names)} trajectories through all {self.n_frames} frames, at most {furthest_px:.2f} px from truth"

    def _compare(self, rows: pa.Table) -> tuple[int, float]:
        """The lane of a trajectory, and how far from its disc it is at most, px."""
        frames, x_px, y_px = (rows[name].to_numpy() for name in ("frame", "x_px", "y_px"))
        assert frames.tolist() == list(range(self.n_frames)), f"{len(frames)} of {self.n_frames} frames"
        lane = int(np.abs(self._x_px - x_px.mean()).argmin())
        truth_px = self._y_px(frames[:, None])[:, lane]
        return lane, float(np.hypot(x_px - self._x_px[lane], y_px - truth_px).max())

    @property
    def _x_px(self) -> npt.NDArray[np.float64]:
        return np.linspace(_EDGE_PX, COLUMNS - _EDGE_PX, len(_RADII_PX))

    def _y_px(self, frame: int | npt.NDArray[np.int32]) -> npt.NDArray[np.float64]:
        rise_px = frame * sedimentation_um_s(_RADII_PX, **_MATERIAL)
        return np.asarray(self.n_rows - _EDGE_PX - rise_px, np.float64)


def _add_disc(image: npt.NDArray[np.float32], x_px: float, y_px: float, r_px: float) -> None:
    """Add a disc with a soft edge."""
    left, top, side = int(x_px) - 24, int(y_px) - 24, 49
    disc = np.zeros((side, side), np.float32)
    centre = (round((x_px - left) * 16), round((y_px - top) * 16))
    cv2.circle(disc, centre, round(r_px * 16), 120.0, -1, cv2.LINE_AA, shift=4)
    image[top : top + side, left : left + side] += cv2.GaussianBlur(disc, (0, 0), 1.0)
