"""A folder as an archive, of any size, the same bytes whenever it is asked for."""

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from backend.platform.zip_stream import part, zip_stream

MEMBERS = [("flow.zarr/zarr.json", b"{}"), ("flow.zarr/c/0", bytes(range(256))), ("flow.zarr/Größe", b"")]
BLOCK = 1 << 20


def test_what_is_packed_comes_out_and_is_the_same_every_time() -> None:
    packed = b"".join(zip_stream(MEMBERS))
    assert packed == b"".join(zip_stream(MEMBERS))
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        assert archive.testzip() is None
        assert [(name, archive.read(name)) for name in archive.namelist()] == MEMBERS
    assert b"".join(part(zip_stream(MEMBERS), 100, 300)) == packed[100:300]


@pytest.mark.slow
def test_an_archive_of_more_than_four_gigabytes_can_be_opened_to_its_last_member(tmp_path: Path) -> None:
    n_large, content = 66, bytes(64 * BLOCK)

    def members() -> Iterator[tuple[str, bytes]]:
        for number in range(n_large):
            yield f"flow.zarr/c/{number}", content
        yield "flow.zarr/last", b"the last one"

    path = tmp_path / "flow.zarr.zip"
    with path.open("wb") as file:
        for piece in zip_stream(members()):
            for start in range(0, len(piece), BLOCK):
                block = piece[start : start + BLOCK]
                if any(block):
                    file.write(block)
                else:
                    file.seek(len(block), io.SEEK_CUR)  # a hole: nobody's disk must hold it
    assert path.stat().st_size > 4 * 2**30
    with zipfile.ZipFile(path) as archive:
        assert len(archive.namelist()) == n_large + 1
        assert archive.read("flow.zarr/last") == b"the last one"
        with archive.open(f"flow.zarr/c/{n_large - 1}") as member:
            assert sum(map(len, iter(lambda: member.read(BLOCK), b""))) == len(content)
