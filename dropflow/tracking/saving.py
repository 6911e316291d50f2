"""Frozen dataclasses of arrays as flat arrays under a prefix, and back, bit for bit."""

from dataclasses import fields
from typing import Any, TypeVar

import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.flow import FlowField
from dropflow.tracking.front import Front
from dropflow.tracking.grid import Grid

Columns = TypeVar("Columns")


def save_columns(prefix: str, columns: Any) -> Arrays:
    """The fields of a dataclass that has arrays alone."""
    return {f"{prefix}.{field.name}": getattr(columns, field.name) for field in fields(columns)}


def load_columns(prefix: str, kind: type[Columns], arrays: Arrays) -> Columns:
    """What `save_columns` saved."""
    return kind(*(arrays[f"{prefix}.{field.name}"] for field in fields(kind)))  # type: ignore[arg-type]


def prefixed(prefix: str, arrays: Arrays) -> Arrays:
    """The same arrays under longer names."""
    return {prefix + name: array for name, array in arrays.items()}


def without_prefix(prefix: str, arrays: Arrays) -> Arrays:
    """What `prefixed` was given."""
    return {name[len(prefix) :]: array for name, array in arrays.items() if name.startswith(prefix)}


def save_front(prefix: str, front: Front) -> Arrays:
    """The arrays of a front."""
    own = {f"{prefix}.{f.name}": getattr(front, f.name) for f in fields(Front) if f.name != "droplets"}
    return own | save_columns(prefix, front.droplets)


def load_front(prefix: str, arrays: Arrays) -> Front:
    """What `save_front` saved."""
    own = {f.name: arrays[f"{prefix}.{f.name}"] for f in fields(Front) if f.name != "droplets"}
    return Front(droplets=load_columns(prefix, Droplets, arrays), **own)


def save_flow(prefix: str, flow: FlowField | None) -> Arrays:
    """The arrays of a flow field; none where there is no field yet."""
    if flow is None:
        return {}
    names = [field.name for field in fields(FlowField) if field.name != "grid"]
    return {f"{prefix}.{name}": getattr(flow, name) for name in names}


def load_flow(prefix: str, arrays: Arrays, grid: Grid) -> FlowField | None:
    """What `save_flow` saved."""
    names = [field.name for field in fields(FlowField) if field.name != "grid"]
    if f"{prefix}.{names[0]}" not in arrays:
        return None
    saved: list[npt.NDArray[Any]] = [arrays[f"{prefix}.{name}"] for name in names]
    return FlowField(grid, *saved)
