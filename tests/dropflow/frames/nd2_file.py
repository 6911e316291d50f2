"""Writes small ND2 files of version 3, chunk by chunk, for nobody else writes them."""

import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

_MAGIC = 0x0ABECEDA
_BOOL, _INT, _UINT, _DOUBLE, _STRING, _LEVEL = 1, 2, 3, 6, 8, 11
_NAME_BYTES_OF_FRAME = 4072
_GLASS = {"pFluorescentProbe": {"uiCount": 0}}


@dataclass
class Nd2File:
    """Planes in the order of the loops, which run from the slowest to the fastest: (axis, count) of T, P, Z."""

    planes: npt.NDArray[Any]
    """Shape (planes, rows, columns, channels)."""
    loops: list[tuple[str, int]]
    times_ms: npt.NDArray[np.float64] | None = None
    is_deflated: bool = False
    left_out: set[int] = field(default_factory=set)
    """Planes that the loops count but the file does not hold."""

    def write(self, path: Path) -> Path:
        """Write the file."""
        path.write_bytes(self.content())
        return path

    def content(self) -> bytes:
        """The file's bytes."""
        parts = _Parts()
        parts.add(b"ND2 FILE SIGNATURE CHUNK NAME01!", b"Ver3.0".ljust(64, b"\0"), n_name_bytes=32)
        parts.add(b"ImageAttributesLV!", level("SLxImageAttributes", self._attributes()))
        parts.add(b"ImageMetadataSeqLV|0!", level("SLxPictureMetadata", self._picture()))
        if self.loops:
            parts.add(b"ImageMetadataLV!", level("SLxExperiment", _experiment(self.loops)))
        for number, plane in enumerate(self.planes):
            if number not in self.left_out:
                pixels = zlib.compress(plane.tobytes()) if self.is_deflated else plane.tobytes()
                name = b"ImageDataSeq|%d!" % number
                parts.add(name, struct.pack("<d", number) + pixels, n_name_bytes=_NAME_BYTES_OF_FRAME)
        if self.times_ms is not None:
            parts.add(b"CustomData|AcqTimesCache!", self.times_ms.astype("<f8").tobytes())
        return parts.finished()

    def _attributes(self) -> dict[str, Any]:
        n_planes, rows, columns, n_channels = self.planes.shape
        bits = self.planes.dtype.itemsize * 8
        return {
            "uiWidth": columns,
            "uiWidthBytes": columns * n_channels * self.planes.dtype.itemsize,
            "uiHeight": rows,
            "uiComp": n_channels,
            "uiBpcInMemory": bits,
            "uiBpcSignificant": bits,
            "uiSequenceCount": n_planes,
            "eCompression": 0 if self.is_deflated else 2,
        }

    def _picture(self) -> dict[str, Any]:
        n_channels = self.planes.shape[3]
        planes = {
            f"a{index}": {"uiCompCount": 1, "sDescription": f"camera {index}", **_GLASS} for index in range(n_channels)
        }
        return {
            "bCalibrated": True,
            "dCalibration": 0.5,
            "sPicturePlanes": {"uiCount": n_channels, "sPlaneNew": planes},
        }


class _Parts:
    """Chunks one after the other, and the map of where they are."""

    def __init__(self) -> None:
        self._content, self._map = b"", b""

    def add(self, name: bytes, data: bytes, *, n_name_bytes: int | None = None) -> None:
        self._map += name + struct.pack("<QQ", len(self._content), len(data))
        n_name_bytes = n_name_bytes or len(name) + 20
        self._content += struct.pack("<IIQ", _MAGIC, n_name_bytes, len(data)) + name.ljust(n_name_bytes, b"\0") + data

    def finished(self) -> bytes:
        name = b"ND2 FILEMAP SIGNATURE NAME 0001!"
        data = self._map + b"ND2 CHUNK MAP SIGNATURE 0000001!" + struct.pack("<Q", len(self._content))
        return self._content + struct.pack("<IIQ", _MAGIC, len(name), len(data)) + name + data


def level(name: str, values: dict[str, Any]) -> bytes:
    """A group of values in the "lite variant" coding of ND2 metadata."""
    inside = b"".join(_value(key, value) for key, value in values.items())
    head = _head(_LEVEL, name)
    length = len(head) + 12 + len(inside)
    return head + struct.pack("<IQ", len(values), length) + inside + bytes(8 * len(values))


def _value(name: str, value: Any) -> bytes:
    if isinstance(value, dict):
        return level(name, value)
    if isinstance(value, bool):
        return _head(_BOOL, name) + struct.pack("<B", value)
    if isinstance(value, int):
        return _head(_UINT if name.startswith("ui") else _INT, name) + struct.pack("<I", value)
    if isinstance(value, float):
        return _head(_DOUBLE, name) + struct.pack("<d", value)
    return _head(_STRING, name) + str(value).encode("utf-16-le") + b"\0\0"


def _head(kind: int, name: str) -> bytes:
    coded = (name + "\0").encode("utf-16-le")
    return struct.pack("<BB", kind, len(coded) // 2) + coded


def _experiment(loops: list[tuple[str, int]]) -> dict[str, Any]:
    (axis, count), *inner = loops
    if axis == "T":
        about: dict[str, Any] = {
            "eType": 1,
            "uLoopPars": {"uiCount": count, "dStart": 0.0, "dPeriod": 500.0, "dDuration": 500.0 * count},
        }
    elif axis == "Z":
        about = {"eType": 4, "uLoopPars": {"uiCount": count, "dZLow": 0.0, "dZHigh": 1.0, "dZStep": 0.5, "dZHome": 0.0}}
    else:
        points = {f"i{index:010}": {"dPosX": 1.0 * index, "dPosY": 0.0, "dPosZ": 0.0} for index in range(count)}
        about = {"eType": 2, "uLoopPars": {"uiCount": count, "Points": points}}
    if inner:
        about["ppNextLevelEx"] = {"i0000000000": _experiment(inner)}
    return about
