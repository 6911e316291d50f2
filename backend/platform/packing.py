"""Dataclasses of arrays as bytes in a row of the database: small, and quick to read by the thousand."""

import json
import math
import zlib
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

Columns = TypeVar("Columns")

_LENGTH_BYTES = 4


def pack(columns: Any) -> bytes:
    """The names, types and shapes of the arrays as JSON, then their values, compressed."""
    arrays = {field.name: np.ascontiguousarray(getattr(columns, field.name)) for field in fields(columns)}
    head = json.dumps({name: [values.dtype.str, values.shape] for name, values in arrays.items()}).encode()
    values = b"".join(values.tobytes() for values in arrays.values())
    return zlib.compress(len(head).to_bytes(_LENGTH_BYTES, "little") + head + values, level=1)


def unpack(kind: type[Columns], content: bytes) -> Columns:
    """What `pack` packed."""
    plain = zlib.decompress(content)
    at = _LENGTH_BYTES + int.from_bytes(plain[:_LENGTH_BYTES], "little")
    arrays: dict[str, npt.NDArray[Any]] = {}
    for name, (dtype, shape) in json.loads(plain[_LENGTH_BYTES:at]).items():
        arrays[name] = np.frombuffer(plain, dtype, math.prod(shape), at).reshape(shape)
        at += arrays[name].nbytes
    return kind(**arrays)
