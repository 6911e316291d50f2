"""Circles that may be droplets: what the strategies hand to the match."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Circles:
    """n circles, each attribute of shape (n,), float64, in pixels of the image they were found in."""

    x_px: Column
    y_px: Column
    r_px: Column

    def __len__(self) -> int:
        return len(self.x_px)

    def __getitem__(self, which: npt.NDArray[np.bool_] | npt.NDArray[np.integer]) -> "Circles":
        return Circles(self.x_px[which], self.y_px[which], self.r_px[which])

    @staticmethod
    def none() -> "Circles":
        return Circles(np.empty(0), np.empty(0), np.empty(0))

    @staticmethod
    def concatenate(parts: "list[Circles]") -> "Circles":
        """All circles of `parts`, in order."""
        return Circles(*(np.concatenate([getattr(part, name) for part in parts]) for name in ("x_px", "y_px", "r_px")))

    def enlarged(self, factor: int) -> "Circles":
        """These circles in the pixels of an image that is `factor` times as large."""
        half = (factor - 1) / 2
        return Circles(self.x_px * factor + half, self.y_px * factor + half, self.r_px * factor)
