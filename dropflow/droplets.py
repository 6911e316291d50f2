"""The droplets of one frame as arrays: what detection gives and tracking takes."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow import tables

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Droplets:
    """Droplets of one frame, each attribute of shape (n,), float64, pixels where the name says so.

    Positions are in image axes: x right, y down, the centre of the top left pixel is (0, 0).
    """

    x_px: Column
    y_px: Column
    r_px: Column
    x_std_px: Column
    """Standard deviation of either coordinate."""
    r_std_px: Column
    probability: Column
    """That this is a real droplet, 0 to 1."""
    match: Column
    """How well a disk of this radius fits the image here (eq. 3 in the `paper` method)."""

    def __len__(self) -> int:
        return len(self.x_px)

    def __getitem__(self, which: npt.NDArray[np.bool_] | npt.NDArray[np.integer] | slice) -> "Droplets":
        """The droplets at a mask, at indices or in a slice."""
        return Droplets(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @staticmethod
    def empty() -> "Droplets":
        """No droplets."""
        return Droplets(*(np.empty(0) for _ in fields(Droplets)))

    @staticmethod
    def concatenate(parts: "list[Droplets]") -> "Droplets":
        """All droplets of `parts`, in order."""
        if not parts:
            return Droplets.empty()
        return Droplets(
            *(np.concatenate([getattr(part, name) for part in parts]) for name in Droplets.__dataclass_fields__)
        )

    def to_table(self, *, frame: int, time_s: float, pixel_size_um: float) -> pa.Table:
        """These droplets as rows of `dropflow.tables.DROPLETS`."""
        columns = self.to_columns(frame=frame, time_s=time_s, pixel_size_um=pixel_size_um)
        return pa.table(columns, schema=tables.DROPLETS)

    def to_columns(self, *, frame: int, time_s: float, pixel_size_um: float) -> dict[str, npt.NDArray[Any]]:
        """The columns of that table."""
        pixels = {column.name: getattr(self, column.name) for column in fields(self)}
        micrometres = {f"{axis}_um": pixels[f"{axis}_px"] * pixel_size_um for axis in "xyr"}
        where = {"frame": np.full(len(self), frame, np.int32), "time_s": np.full(len(self), time_s)}
        return where | pixels | micrometres

    @staticmethod
    def from_table(table: pa.Table) -> "Droplets":
        """The pixel columns of a droplet table's rows."""
        return Droplets(*(table[column.name].to_numpy() for column in fields(Droplets)))
