"""Vectors in parts across and along `up`: errors of sedimentation are along it alone."""

import numpy as np

from dropflow.tracking.grid import Column

Up = tuple[float, float]
"""Unit vector against gravity, x right, y down."""


def turned(x: Column, y: Column, up: Up) -> tuple[Column, Column]:
    """Components of vectors across `up` and along it."""
    return np.asarray(-up[1] * x + up[0] * y), np.asarray(up[0] * x + up[1] * y)


def unturned(across: Column, along: Column, up: Up) -> Column:
    """Components of vectors along x and y, shape (2, n)."""
    return np.stack([-up[1] * across + up[0] * along, up[0] * across + up[1] * along])
