"""One array in an HDF5 file as frames. No other file is ever opened: links, external data and views are refused."""

from itertools import product

import h5py

from dropflow.errors import FramesError
from dropflow.frames.arrays import array_shape, check_block
from dropflow.frames.choice import Choice, check_single
from dropflow.frames.contract import Frame
from dropflow.frames.damage import Source
from dropflow.frames.grey import to_grey
from dropflow.frames.hdf5_search import find
from dropflow.frames.reader import Reader

_CACHE_BYTES = 2**26


class Hdf5Frames(Reader[Source]):
    """The frames of a dataset of shape (frames, rows, columns), or with colours last."""

    what = "HDF5 file"

    def __init__(self, source: Source, *, name: str, choice: Choice) -> None:
        self._choice = choice
        super().__init__(source, name=name)

    def _open(self) -> None:
        check_single(self._choice, file=self._name)
        self._file = h5py.File(self._source, "r", rdcc_nbytes=_CACHE_BYTES)
        self._data = find(self._file, self._choice.dataset, self._name)
        self._label = f"{self._name}, {self._data.name}"
        # MATLAB stores the last index first: its rows are the file's columns.
        self._is_transposed = "MATLAB_class" in self._data.attrs
        self._shape = array_shape(self._data.shape, self._data.dtype, self._label, is_transposed=self._is_transposed)
        check_block(self._data.chunks or (), self._data.dtype, self._label)
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
        self._check_written(index)
        pixels = self._data[index] if self._shape.has_frame_axis else self._data[()]
        return to_grey(pixels.T if self._is_transposed else pixels, self._label, self._choice.grey_from)

    def _check_written(self, index: int) -> None:
        """Refuse a frame that was never written: HDF5 would give zeros."""
        chunks = self._data.chunks
        if chunks is None:
            is_written = self._data.id.get_offset() is not None or self._data.id.get_storage_size() > 0
        else:
            starts = [range(0, n, step) for n, step in zip(self._data.shape, chunks, strict=True)]
            if self._shape.has_frame_axis:
                starts[0] = range(index - index % chunks[0], index + 1, chunks[0])
            is_written = all(
                self._data.id.get_chunk_info_by_coord(start).byte_offset is not None for start in product(*starts)
            )
        if not is_written:
            raise FramesError(
                "The frame was never written: the recording may have been stopped early.",
                code="frames.missing",
                file=self._label,
                frame=index,
            )
