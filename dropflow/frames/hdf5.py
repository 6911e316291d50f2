"""One array in an HDF5 file as frames. No other file is ever opened: links, external data and views are refused."""

from itertools import product
from math import prod
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.frames.arrays import Slabs, array_shape, check_block
from dropflow.frames.choice import Choice, check_single
from dropflow.frames.contract import Frame
from dropflow.frames.damage import Source
from dropflow.frames.grey import to_grey
from dropflow.frames.hdf5_search import find
from dropflow.frames.inflating import check_inflated
from dropflow.frames.reader import Reader

_DEFLATE = 1
_FILTERS = {_DEFLATE, *(2, 3, 4, 5, 6), 32000}
"""Deflate, shuffle, checksum, szip, nbit, scale and offset, LZF: what every HDF5 library can undo."""


class Hdf5Frames(Reader[Source]):
    """The frames of a dataset of shape (frames, rows, columns), or with colours last."""

    what = "HDF5 file"

    def __init__(self, source: Source, *, name: str, choice: Choice) -> None:
        self._choice = choice
        super().__init__(source, name=name)

    def _open(self) -> None:
        check_single(self._choice, file=self._name)
        self._file = h5py.File(self._source, "r", rdcc_nbytes=0)
        self._data = find(self._file, self._choice.dataset, self._name)
        self._label = f"{self._name}, {self._data.name}"
        # MATLAB stores the last index first: its rows are the file's columns.
        self._is_transposed = "MATLAB_class" in self._data.attrs
        self._shape = array_shape(self._data.shape, self._data.dtype, self._label, is_transposed=self._is_transposed)
        chunks = self._data.chunks
        if chunks is not None:
            check_block(self._data.shape, chunks, self._data.dtype, self._label)
        self._deflate_at = self._check_filters()
        self._slabs = Slabs(
            self._slab,
            n_in_block=chunks[0] if chunks and self._shape.has_frame_axis else 1,
            n_frames=self._shape.n_frames,
            frame_bytes=self._data.nbytes // self._shape.n_frames,
        )
        first = self._read(0)
        self.shape, self.dtype = (first.shape[0], first.shape[1]), first.dtype

    def __len__(self) -> int:
        return self._shape.n_frames

    def label(self, index: int) -> str:
        return f"{self._label}, frame {index}"

    def close(self) -> None:
        with self._lock:
            self._file.close()
            super().close()

    def _read(self, index: int) -> Frame:
        pixels = self._slabs.frame(index)
        return to_grey(pixels.T if self._is_transposed else pixels, self._label, self._choice.grey_from)

    def _slab(self, start: int, stop: int) -> npt.NDArray[Any]:
        """Frames `start` to `stop` as they are stored; `start` is the first of a block, or `stop` is the next frame."""
        if self._data.chunks is None:
            is_written = self._data.id.get_offset() is not None or self._data.id.get_storage_size() > 0
        else:
            is_written = self._check_blocks(self._data.chunks, start)
        if not is_written:
            raise FramesError(
                "The frame was never written: the recording may have been stopped early.",
                code="frames.missing",
                file=self._label,
            )
        return np.asarray(self._data[start:stop] if self._shape.has_frame_axis else self._data[()][None])

    def _check_blocks(self, chunks: tuple[int, ...], start: int) -> bool:
        """Whether all blocks of frame `start` were written (HDF5 gives zeros for others); none may inflate too far."""
        starts = [range(0, n, step) for n, step in zip(self._data.shape, chunks, strict=True)]
        if self._shape.has_frame_axis:
            starts[0] = range(start - start % chunks[0], start + 1, chunks[0])
        most_bytes = prod(chunks) * self._data.dtype.itemsize
        for place in product(*starts):
            block = self._data.id.get_chunk_info_by_coord(place)
            if block.byte_offset is None:
                return False
            if self._deflate_at is not None and not block.filter_mask >> self._deflate_at & 1:
                check_inflated("zlib", self._data.id.read_direct_chunk(place)[1], most_bytes)
        return True

    def _check_filters(self) -> int | None:
        """The place of deflate among the filters that pack the data; others than the common ones are refused."""
        packing = self._data.id.get_create_plist()
        filters = [packing.get_filter(at) for at in range(packing.get_nfilters())]
        if unknown := [
            f"{name.decode(errors='replace')} {code}" for code, _, _, name in filters if code not in _FILTERS
        ]:
            raise FramesError(
                f"Its packing ({', '.join(unknown)}) is not read.",
                code="frames.unsupported",
                file=self._label,
                hint="Store it with gzip or LZF (h5repack -f GZIP=1).",
            )
        return next((at for at, (code, *_) in enumerate(filters) if code == _DEFLATE), None)
