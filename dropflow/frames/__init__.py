"""Any image stack as lazy frames: one reader a file, one contract (`dropflow.frames.contract.Frames`)."""

from pathlib import Path
from typing import BinaryIO

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames.contract import Files, Frame, Frames
from dropflow.frames.decode import not_an_image, sniff
from dropflow.frames.files import FolderFiles, ZipFiles, image_names, one_folder
from dropflow.frames.stack import StackFrames
from dropflow.frames.tiff import TiffFrames

__all__ = ["Files", "Frame", "Frames", "open_frames", "open_image", "stack_files"]


def open_frames(source: Path | Files, *, grey_from: GreyFrom | None = None) -> Frames:
    """Open a stack lazily.

    Parameters
    ----------
    source
        A folder of images, a multi-page TIFF, a ZIP of images, or named files from elsewhere. What a file is, is
        decided by its content. Frames are in natural order of their names.
    grey_from
        How colour frames become grey; without it they are refused.

    Raises
    ------
    FramesError
        ``frames.not_found``, ``frames.empty``, ``frames.not_an_image``, ``frames.truncated``, ``frames.colour``, ...
        naming the file.
    """
    files, names = stack_files(source)
    if len(names) == 1:
        return _open_one(files, names[0], grey_from)
    return StackFrames(files, names, grey_from=grey_from)


def stack_files(source: Path | Files) -> tuple[Files, list[str]]:
    """The files of a stack and the names of those that hold frames, in natural order."""
    if not isinstance(source, Path):
        files, label = source, "the stack"
    elif source.is_dir():
        files, label = FolderFiles(source), str(source)
    elif source.is_file():
        return FolderFiles(source.parent), [source.name]
    else:
        raise FramesError("There is no such file or folder.", code="frames.not_found", file=str(source))
    names = list(files.names())
    images = image_names(names)
    if len(names) == 1 and not images:
        images = names
    if not images:
        raise FramesError("There are no images here.", code="frames.empty", file=label, hint="Give TIFF, PNG or JPEG.")
    return files, list(one_folder(images, label=label))


def open_image(source: Path) -> Frame:
    """Read one image file (such as a flat field) as a grey frame, shape (rows, columns)."""
    with open_frames(source) as frames:
        if len(frames) != 1:
            raise FramesError(f"One image is expected, not {len(frames)}.", file=str(source))
        return frames[0]


def _open_one(files: Files, name: str, grey_from: GreyFrom | None) -> Frames:
    """A stack that is one file: a TIFF of any number of pages, a ZIP, or a single image."""
    file = files.open(name)
    kind = sniff(file)
    if kind == "tiff":
        return TiffFrames(file, name=name, grey_from=grey_from)
    if kind == "zip":
        return _open_zip(file, name, grey_from)
    file.close()
    if kind is None:
        raise not_an_image(name)
    return StackFrames(files, [name], grey_from=grey_from)


def _open_zip(file: BinaryIO, label: str, grey_from: GreyFrom | None) -> Frames:
    try:
        archive = ZipFiles(file, label=label)
        names = image_names(archive.names())
        if not names:
            raise FramesError("The ZIP archive holds no images.", code="frames.empty", file=label)
        return StackFrames(archive, one_folder(names, label=label), grey_from=grey_from, archive=archive)
    except FramesError:
        file.close()
        raise
