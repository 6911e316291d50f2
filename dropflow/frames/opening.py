"""From a path or named files to the reader that knows what they are."""

from pathlib import Path
from typing import BinaryIO

from dropflow.errors import FramesError
from dropflow.frames.archive import ZipFiles
from dropflow.frames.choice import Choice
from dropflow.frames.contract import Files, Frame, Frames
from dropflow.frames.damage import Source
from dropflow.frames.files import FolderFiles, film_names, image_names, natural_order, one_folder
from dropflow.frames.kinds import STILLS, VIDEOS, WHAT_TO_GIVE, not_an_image, sniff
from dropflow.frames.left_out import ReadableFrames
from dropflow.frames.parts import PartFrames
from dropflow.frames.stack import Closeable, StackFrames
from dropflow.frames.tiff import TiffFrames

_MARKS_OF_ZARR = frozenset({"zarr.json", ".zarray", ".zgroup"})


def open_frames(source: Path | Files, choice: Choice | None = None) -> Frames:
    """Open a stack lazily.

    Parameters
    ----------
    source
        A file or folder, or named files from elsewhere: images in a folder or ZIP, a multi-page TIFF, a video, an
        HDF5, ND2 or Zarr store (a folder or ZIP), or several files of many frames each. What a file is, is decided by
        its content. Frames are in natural order of their files' names, and inside a file in its own order.
    choice
        What the experiment says of its files (`Choice.of`): without it colour is refused, and so is a file that holds
        more than one film.

    Raises
    ------
    FramesError
        ``frames.not_found``, ``frames.empty``, ``frames.not_an_image``, ``frames.truncated``, ``frames.colour``,
        ``frames.choose``, ... naming the file.
    """
    files, names = stack_files(source)
    choice = choice or Choice()
    frames = _open(files, names, choice, label=_label(source))
    return ReadableFrames(frames, choice.left_out) if choice.left_out else frames


def open_image(source: Path) -> Frame:
    """Read one image file (such as a flat field) as a grey frame, shape (rows, columns)."""
    with open_frames(source) as frames:
        if len(frames) != 1:
            raise FramesError(f"One image is expected, not {len(frames)}.", code="frames.page_count", file=str(source))
        return frames[0]


def stack_files(source: Path | Files) -> tuple[Files, list[str]]:
    """The files of a stack and the names of those that hold frames, in natural order."""
    if not isinstance(source, Path):
        return source, _names_of_frames(source, _label(source))
    if source.is_file():
        return FolderFiles(source.parent), [source.name]
    if not source.is_dir():
        raise FramesError("There is no such file or folder.", code="frames.not_found", file=str(source))
    is_zarr = any((source / mark).is_file() for mark in _MARKS_OF_ZARR)
    files = FolderFiles(source, is_deep=is_zarr)
    return files, _names_of_frames(files, str(source))


def _label(source: Path | Files) -> str:
    return str(source) if isinstance(source, Path) else "the stack"


def _names_of_frames(files: Files, label: str, *, is_archive: bool = False) -> list[str]:
    """Of all names, those of one film, in natural order. What is alone and no archive may be called anything."""
    names = list(files.names())
    roots = _zarr_roots(names)
    images, films = image_names(names), film_names(names)
    if len(roots) == 1 and not any(_is_outside(name, roots[0]) for name in (*images, *films)):
        return natural_order(name for name in names if not _is_outside(name, roots[0]))
    if sum(map(bool, (roots, images, films))) > 1 or len(roots) > 1:
        raise FramesError(
            f"There is more than one film here ({', '.join([*roots, *films, *images][:4])}, ...).",
            code="frames.several_films",
            file=label,
            hint="Give the files of one film only.",
        )
    if len(names) == 1 and not images and not is_archive:
        return names
    if not images and not films:
        raise FramesError("There are no images here.", code="frames.empty", file=label, hint=WHAT_TO_GIVE)
    return list(one_folder(images or films, label=label))


def _is_outside(name: str, root: str) -> bool:
    return bool(root) and not name.startswith(f"{root}/")


def _zarr_roots(names: list[str]) -> list[str]:
    if not any(name[name.rfind("/") + 1 :] in _MARKS_OF_ZARR for name in names):
        return []
    from dropflow.frames.zarr_store import zarr_roots

    return zarr_roots(names)


def _open(files: Files, names: list[str], choice: Choice, *, label: str, archive: Closeable | None = None) -> Frames:
    """Open the files of one film; `archive` is closed with it."""
    roots = _zarr_roots(names)
    if roots:
        from dropflow.frames.zarr_frames import ZarrFrames
        from dropflow.frames.zarr_store import FilesStore

        return ZarrFrames(FilesStore(files, roots[0], owned=archive), name=roots[0] or label, choice=choice)
    if len(names) == 1 and archive is None:
        return _open_file(files, names[0], choice, is_single=True)
    if _holds_many(files, names[0], choice):
        return PartFrames(names, lambda name: _open_file(files, name, choice), archive=archive)
    return StackFrames(files, names, choice=choice, archive=archive)


def _holds_many(files: Files, name: str, choice: Choice) -> bool:
    """Whether the first file is of a kind, or length, that holds many frames."""
    with files.open(name) as file:
        kind = sniff(file)
    if kind != "tiff":
        return kind in VIDEOS or kind in {"hdf5", "nd2"}
    with TiffFrames(Source(files.open(name)), name=name, choice=choice) as pages:
        return len(pages) > 1


def _open_file(files: Files, name: str, choice: Choice, *, is_single: bool = False) -> Frames:
    """Open one file of any number of frames."""
    source = Source(files.open(name))
    kind = sniff(source.as_file())
    if choice.dataset is not None and kind not in {"hdf5", "zip"}:
        source.close()
        raise FramesError(
            "The experiment names a dataset, which only HDF5 and Zarr have.",
            code="frames.choose",
            file=name,
            hint="Take dataset out of the experiment.",
        )
    if kind == "tiff":
        return TiffFrames(source, name=name, choice=choice)
    if kind in VIDEOS:
        from dropflow.frames.video import VideoFrames

        return VideoFrames(source, name=name, choice=choice, kind=kind)
    if kind == "hdf5":
        from dropflow.frames.hdf5 import Hdf5Frames

        return Hdf5Frames(source, name=name, choice=choice)
    if kind == "nd2":
        from dropflow.frames.nd2_frames import Nd2Frames

        return Nd2Frames(source, name=name, choice=choice)
    if kind == "zip" and is_single:
        return _open_zip(source.as_file(), name, choice)
    source.close()
    if kind in STILLS and is_single:
        return StackFrames(files, [name], choice=choice)
    raise not_an_image(name)


def _open_zip(file: BinaryIO, label: str, choice: Choice) -> Frames:
    archive = ZipFiles(file, label=label)
    try:
        return _open(archive, _names_of_frames(archive, label, is_archive=True), choice, label=label, archive=archive)
    except BaseException:
        archive.close()
        raise
