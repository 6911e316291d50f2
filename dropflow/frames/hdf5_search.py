"""The dataset in an HDF5 file that holds the frames: the one that is named, or the only one there is."""

from collections.abc import Iterator

import h5py

from dropflow.errors import FramesError
from dropflow.frames.arrays import is_stack

_MAX_OBJECTS = 10_000
_MAX_DEPTH = 32
_MAX_SOFT_LINKS = 16


def find(file: h5py.File, wanted: str | None, name: str) -> h5py.Dataset:
    """The dataset called `wanted`, or the only stack in the file.

    Raises
    ------
    FramesError
        ``frames.choose`` if there are several or none has that name, ``frames.empty`` if there is none,
        ``frames.external`` if its data is not in this file.
    """
    if wanted is not None:
        return _own(_follow(file, wanted, name), name)
    stacks = [data for data in _datasets(file) if is_stack(data.shape, data.dtype) and len(data.shape) > 2]
    if not stacks:
        raise FramesError(
            "The HDF5 file holds no array of frames.",
            code="frames.empty",
            file=name,
            hint="There must be a dataset with the axes (frame, row, column).",
        )
    if len(stacks) > 1:
        raise _choose(f"The HDF5 file holds {len(stacks)} arrays that may be the frames", stacks, name)
    return _own(stacks[0], name)


def _follow(file: h5py.File, path: str, name: str) -> h5py.Dataset:
    """Go along `path` name by name, for HDF5 itself would follow links into other files."""
    found: h5py.Group | h5py.Dataset = file
    left = [part for part in path.split("/") if part]
    n_soft = 0
    while left:
        part = left.pop(0)
        link = found.get(part, getlink=True) if isinstance(found, h5py.Group) else None
        if isinstance(link, h5py.ExternalLink):
            raise _external(f"{path!r} is a link to another file", name)
        if isinstance(link, h5py.SoftLink) and n_soft < _MAX_SOFT_LINKS:
            n_soft += 1
            found = file if link.path.startswith("/") else found
            left = [step for step in link.path.split("/") if step and step != "."] + left
            continue
        if not isinstance(link, h5py.HardLink):
            raise _choose(f"There is no dataset {path!r} in the HDF5 file", list(_datasets(file)), name)
        found = found[part]
    if not isinstance(found, h5py.Dataset):
        raise _choose(f"{path!r} in the HDF5 file is no dataset", list(_datasets(file)), name)
    return found


def _datasets(group: h5py.Group) -> Iterator[h5py.Dataset]:
    """The datasets in the file itself, without those behind links."""
    waiting: list[tuple[h5py.Group, int]] = [(group, 0)]
    n_seen = 0
    while waiting:
        here, depth = waiting.pop()
        for key in here:
            n_seen += 1
            if n_seen > _MAX_OBJECTS or depth > _MAX_DEPTH:
                return
            if isinstance(here.get(key, getlink=True), h5py.HardLink):
                found = here[key]
                if isinstance(found, h5py.Dataset):
                    yield found
                elif isinstance(found, h5py.Group):
                    waiting.append((found, depth + 1))


def _own(data: h5py.Dataset, name: str) -> h5py.Dataset:
    if data.is_virtual or data.external:
        raise _external(f"{data.name} keeps its data in other files", name)
    return data


def _external(message: str, name: str) -> FramesError:
    return FramesError(
        f"{message}; other files are never opened.",
        code="frames.external",
        file=name,
        hint="Copy the data into one file (h5repack, or h5copy).",
    )


def _choose(message: str, candidates: list[h5py.Dataset], name: str) -> FramesError:
    seen = ", ".join(f"{data.name} {data.shape}" for data in candidates[:8])
    return FramesError(
        f"{message} (it holds {seen or 'no datasets'}).",
        code="frames.choose",
        file=name,
        hint="Set dataset in the experiment to the path of one of them.",
    )
