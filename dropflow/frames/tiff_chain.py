"""The chain of pages in a TIFF file, walked to its end.

tifffile stops in silence where a chain is broken, and a film cut in two would look like a shorter film.
"""

import struct
from typing import BinaryIO

from dropflow.frames.contract import MAX_FRAMES

_HEADERS = {
    b"II*\0": ("<HHI", "<H", "<I", 12),
    b"MM\0*": (">HHI", ">H", ">I", 12),
    b"II+\0": ("<HHHHQ", "<Q", "<Q", 20),
    b"MM\0+": (">HHHHQ", ">Q", ">Q", 20),
}
"""By the first bytes: the header, a page's number of tags, an offset, and the bytes of a tag (TIFF 6.0 and BigTIFF)."""


def page_offsets(file: BinaryIO) -> list[int]:
    """Where each page of the chain begins; `file` stands anywhere before and after.

    Raises
    ------
    ValueError
        The chain leaves the file or runs in a circle: the file is cut off or damaged.
    """
    file.seek(0)
    header, count, offset, tag_bytes = _HEADERS[file.read(4)]
    file.seek(0)
    position = _read(file, header)
    seen: dict[int, None] = {}
    while position:
        if position in seen:
            raise ValueError("its pages run in a circle")
        if len(seen) >= MAX_FRAMES:
            raise ValueError(f"it has more than {MAX_FRAMES:,} pages")
        seen[position] = None
        file.seek(position)
        n_tags = _read(file, count)
        file.seek(n_tags * tag_bytes, 1)
        position = _read(file, offset)
    return list(seen)


def _read(file: BinaryIO, layout: str) -> int:
    """The last number of a structure."""
    content = file.read(struct.calcsize(layout))
    if len(content) < struct.calcsize(layout):
        raise ValueError("it ends within its list of pages")
    return int(struct.unpack(layout, content)[-1])
