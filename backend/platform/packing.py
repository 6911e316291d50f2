"""What is known of each frame, as bytes in a row of the database."""

import io
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

Columns = TypeVar("Columns")


def pack(columns: Any) -> bytes:
    """A dataclass of arrays as a compressed archive."""
    packed = io.BytesIO()
    np.savez_compressed(packed, **{field.name: getattr(columns, field.name) for field in fields(columns)})
    return packed.getvalue()


def unpack(kind: type[Columns], content: bytes) -> Columns:
    """What `pack` packed."""
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        return kind(**{field.name: arrays[field.name] for field in fields(kind)})  # type: ignore[arg-type]
