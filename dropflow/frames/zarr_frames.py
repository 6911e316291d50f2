"""A Zarr array (versions 2 and 3), or the full-size array of an OME-Zarr image, as frames."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import zarr

from dropflow.errors import FramesError
from dropflow.frames.arrays import Slabs, array_shape, check_block, is_stack
from dropflow.frames.choice import Axes, Choice, Selection, check_single, pick, select
from dropflow.frames.contract import Frame, Times, check_count, check_size
from dropflow.frames.findings import Finding, finding
from dropflow.frames.grey import to_grey
from dropflow.frames.ome_zarr import OmeArray, described
from dropflow.frames.reader import Reader
from dropflow.frames.zarr_blocks import blocks_of
from dropflow.frames.zarr_store import METADATA, FilesStore

_MAX_ARRAYS = 1000


class ZarrFrames(Reader[FilesStore]):
    """The frames of one array: (frame, row, column), with colours last, or with the axes that OME-Zarr names."""

    what = "Zarr store"

    def __init__(self, source: FilesStore, *, name: str, choice: Choice) -> None:
        self._choice = choice
        self._ome: OmeArray | None = None
        self._selection: Selection | None = None
        super().__init__(source, name=name)

    def _open(self) -> None:
        path = self._choose_path()
        array: Any = zarr.open_array(self._source, path=path, mode="r")
        self._array, self._path = array, path
        self._label = f"{self._name}, {path or '/'}"
        check_block(array.shape, array.chunks, array.dtype, self._label)
        check_block(array.shape, array.shards or array.chunks, array.dtype, self._label)
        blocks = array.shards or array.chunks
        self._source.blocks = blocks_of(array.metadata.to_dict(), blocks, array.dtype.itemsize, self._label)
        if self._ome is None:
            check_single(self._choice, file=self._label)
            self._n_frames = array_shape(array.shape, array.dtype, self._label).n_frames
        else:
            self._n_frames = self._select_axes(self._ome)
        self._slabs = Slabs(
            self._slab,
            n_in_block=self._frames_in_block(),
            n_frames=self._n_frames,
            frame_bytes=array.nbytes // self._n_frames,
        )
        first = self._read(0)
        self.shape, self.dtype = (first.shape[0], first.shape[1]), first.dtype

    def __len__(self) -> int:
        return self._n_frames

    def label(self, index: int) -> str:
        return f"{self._label}, frame {index}"

    def times_s(self) -> Times | None:
        if self._ome is None or self._ome.interval_s is None or self._choice.is_z_time:
            return None
        return np.arange(len(self), dtype=np.float64) * self._ome.interval_s

    def findings(self) -> tuple[Finding, ...]:
        prefix = f"{self._path}/" if self._path else ""
        n_stored = sum(key.startswith(prefix) and _last(key) not in METADATA for key in self._source.keys)
        blocks = self._array.shards or self._array.chunks
        n_expected = int(np.prod([-(-n // step) for n, step in zip(self._array.shape, blocks, strict=True)]))
        if n_stored >= n_expected:
            return ()
        message = (
            f"{n_expected - n_stored} of {n_expected} blocks are not stored, and read as {self._array.fill_value}: "
            "they are empty, or lost."
        )
        return (finding("stack.blocks_absent", message, (), n=n_expected - n_stored),)

    def _read(self, index: int) -> Frame:
        pixels = self._slabs.frame(index)
        return to_grey(pixels, self._label, self._choice.grey_from)

    def _slab(self, start: int, stop: int) -> npt.NDArray[Any]:
        """Frames `start` to `stop` as they are stored."""
        if self._ome is None or self._selection is None:
            return np.asarray(self._array[start:stop] if self._array.ndim > 2 else self._array[...][None])
        chosen = self._selection
        along, fixed = ("t", "z") if chosen.along == "time" else ("z", "t")
        place = {along: slice(start, stop), fixed: chosen.fixed, "c": chosen.channel}
        slab = np.asarray(self._array[tuple(place.get(axis, slice(None)) for axis in self._ome.axes)])
        return slab if along in self._ome.axes else slab[None]

    def _frames_in_block(self) -> int:
        chunk = self._array.chunks
        if self._ome is None or self._selection is None:
            return chunk[0] if self._array.ndim > 2 else 1
        along = "t" if self._selection.along == "time" else "z"
        return chunk[self._ome.axes.index(along)] if along in self._ome.axes else 1

    def _choose_path(self) -> str:
        """The array that is named, the only OME-Zarr image, or the only array that may be a stack."""
        images = described(_attributes(self._source))
        wanted = None if self._choice.dataset is None else self._choice.dataset.strip("/")
        if wanted is None and images:
            self._ome = images[pick("position", len(images), self._choice.position, file=self._name)]
            return self._ome.path
        found = dict(_arrays(self._source))
        if wanted is not None:
            self._ome = next((image for image in images if image.path == wanted), None)
            if wanted in found:
                return wanted
            raise self._which(f"There is no array {wanted!r} in the Zarr store", found)
        stacks = [path for path, array in found.items() if not path or array.ndim > 2]
        stacks = [path for path in stacks if is_stack(found[path].shape, found[path].dtype)]
        if len(stacks) == 1:
            return stacks[0]
        if not found:
            raise FramesError("The Zarr store holds no array.", code="frames.empty", file=self._name)
        raise self._which(f"The Zarr store holds {len(stacks)} arrays that may be the frames", found)

    def _which(self, message: str, found: Mapping[str, Any]) -> FramesError:
        seen = ", ".join(f"{path or '/'} {array.shape}" for path, array in list(found.items())[:8])
        return FramesError(
            f"{message} (it holds {seen or 'no arrays'}).",
            code="frames.choose",
            file=self._name,
            hint="Set dataset in the experiment to the path of one of them.",
        )

    def _select_axes(self, ome: OmeArray) -> int:
        size = dict(zip(ome.axes, self._array.shape, strict=True))
        if ome.axes[-2:] != ("y", "x") or not set(ome.axes) <= {"t", "c", "z", "y", "x"} or len(size) != len(ome.axes):
            raise FramesError(
                f"Its axes ({', '.join(ome.axes)}) are no stack of frames.", code="frames.not_a_stack", file=self._label
            )
        check_size(size["y"], size["x"], self._label)
        axes = Axes(size.get("t", 1), size.get("z", 1), size.get("c", 1), ome.channel_names)
        self._selection = select(axes, self._choice, file=self._label)
        check_count(self._selection.n, self._label)
        return self._selection.n


def _attributes(store: FilesStore) -> dict[str, Any]:
    about = store.json("zarr.json")
    attributes = about.get("attributes", {}) if about else store.json(".zattrs")
    return attributes if isinstance(attributes, dict) else {}


def _arrays(store: FilesStore) -> Iterator[tuple[str, Any]]:
    """Every array in the store, by path."""
    places = sorted({key.rpartition("/")[0] for key in store.keys if _last(key) in {"zarr.json", ".zarray"}})
    for path in places[:_MAX_ARRAYS]:
        about = store.json(f"{path}/zarr.json" if path else "zarr.json")
        if about.get("node_type") != "group":
            yield path, zarr.open_array(store, path=path, mode="r")


def _last(key: str) -> str:
    return key.rpartition("/")[2]
