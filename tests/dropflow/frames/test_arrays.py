"""HDF5, Zarr and ND2: which array is the film, what is never opened, and what blocks may become."""

import gzip
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt
import pytest
import zarr

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames import Choice, open_frames
from tests.dropflow.frames.nd2_file import Nd2File

Film = npt.NDArray[np.uint16]


def refusal(path: Path, *, read: int | None = None, **choice: Any) -> FramesError:
    """The error that opening, or reading a frame, raises."""
    with pytest.raises(FramesError) as raised, open_frames(path, Choice(**choice)) as frames:
        frames[0 if read is None else read]
    return raised.value


def read(path: Path, **choice: Any) -> npt.NDArray[Any]:
    """All frames."""
    with open_frames(path, Choice(**choice)) as frames:
        return np.array(list(frames))


@pytest.fixture
def hdf5(tmp_path: Path, film: Film) -> Path:
    """A file with the film, its mirror image, and links of every kind beside them."""
    with h5py.File(tmp_path / "elsewhere.h5", "w") as file:
        file["frames"] = film
    path = tmp_path / "film.h5"
    with h5py.File(path, "w") as file:
        file["a/frames"] = film
        file["a/mirrored"] = film[..., ::-1]
        file["a/image"] = film[0]
        file["a/soft"] = h5py.SoftLink("/a/mirrored")
        file["a/near"] = h5py.SoftLink("frames")
        file["a/out"] = h5py.ExternalLink("elsewhere.h5", "/frames")
        file["a/hidden"] = h5py.SoftLink("/a/out")
        file["a/round"] = h5py.SoftLink("/a/round")
        file["a/again"] = file["a"]
    return path


def test_the_named_dataset_is_read_and_else_all_are_listed(hdf5: Path, film: Film) -> None:
    np.testing.assert_array_equal(read(hdf5, dataset="/a/mirrored"), film[..., ::-1])
    np.testing.assert_array_equal(read(hdf5, dataset="a/soft"), film[..., ::-1])
    np.testing.assert_array_equal(read(hdf5, dataset="a/near"), film)
    np.testing.assert_array_equal(read(hdf5, dataset="a/image"), film[:1])
    problem = refusal(hdf5)
    assert problem.code == "frames.choose"
    assert "/a/frames (11, 12, 17)" in problem.message
    assert "dataset" in str(problem.hint)
    assert refusal(hdf5, dataset="b/frames").code == "frames.choose"
    assert refusal(hdf5, dataset="a").code == "frames.choose"
    assert refusal(hdf5, dataset="a/round").code == "frames.choose"


@pytest.mark.parametrize("dataset", ["a/out", "a/hidden", "a/out/x"])
def test_a_link_to_another_file_is_never_followed(hdf5: Path, dataset: str) -> None:
    assert refusal(hdf5, dataset=dataset).code == "frames.external"


def test_data_that_lies_in_other_files_is_never_read(tmp_path: Path, film: Film) -> None:
    (tmp_path / "raw.bin").write_bytes(film.tobytes())
    with h5py.File(tmp_path / "source.h5", "w") as file:
        file["frames"] = film
    layout = h5py.VirtualLayout(film.shape, film.dtype)
    layout[:] = h5py.VirtualSource(str(tmp_path / "source.h5"), "frames", film.shape)
    with h5py.File(tmp_path / "virtual.h5", "w") as file:
        file.create_virtual_dataset("frames", layout)
    with h5py.File(tmp_path / "external.h5", "w") as file:
        file.create_dataset("frames", film.shape, film.dtype, external=str(tmp_path / "raw.bin"))
    assert refusal(tmp_path / "virtual.h5").code == "frames.external"
    assert refusal(tmp_path / "external.h5").code == "frames.external"


@pytest.mark.parametrize("chunks", [None, (1, 12, 17), (4, 5, 17), (11, 12, 17)])
def test_a_frame_that_was_never_written_is_missing_not_black(
    tmp_path: Path, film: Film, chunks: tuple[int, ...] | None
) -> None:
    path = tmp_path / "film.h5"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("frames", (40, 12, 17), film.dtype, chunks=chunks)
        if chunks is not None:
            data[:8] = film[:8]
    if chunks is None:
        assert refusal(path).code == "frames.missing"
        return
    with open_frames(path) as frames:
        np.testing.assert_array_equal(frames[7], film[7])
    problem = refusal(path, read=30)
    assert (problem.code, problem.frame) == ("frames.missing", 30)


@pytest.mark.parametrize("options", [{"compression": "lzf"}, {"compression": 9, "shuffle": True, "fletcher32": True}])
def test_the_filters_that_every_library_has(tmp_path: Path, film: Film, options: dict[str, Any]) -> None:
    with h5py.File(tmp_path / "film.h5", "w") as file:
        file.create_dataset("frames", data=film, chunks=(3, 12, 5), **options)
    np.testing.assert_array_equal(read(tmp_path / "film.h5"), film)


def test_a_matlab_film_stands_upright(tmp_path: Path, film: Film) -> None:
    path = tmp_path / "film.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        data = file.create_dataset("film", data=film.transpose(0, 2, 1))
        data.attrs["MATLAB_class"] = np.bytes_("uint16")
    content = path.read_bytes()
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + content[512:])
    np.testing.assert_array_equal(read(path), film)


def test_colours_of_an_array_become_grey_as_said(tmp_path: Path) -> None:
    colour = np.random.default_rng(8).integers(0, 255, (3, 8, 9, 3), dtype=np.uint8)
    with h5py.File(tmp_path / "film.h5", "w") as file:
        file["frames"] = colour
    assert refusal(tmp_path / "film.h5").code == "frames.colour"
    np.testing.assert_array_equal(read(tmp_path / "film.h5", grey_from=GreyFrom.RED), colour[..., 0])


def test_what_is_no_stack_is_said(tmp_path: Path, film: Film) -> None:
    path = tmp_path / "film.h5"
    with h5py.File(path, "w") as file:
        file["words"] = ["a", "b"]
        file["numbers"] = np.arange(3.0)
        file["empty"] = np.zeros((0, 4, 5), np.uint8)
        file["huge"] = h5py.Empty("u1")
        file["complex"] = np.zeros((2, 4, 5), np.complex64)
        file["flat"] = np.zeros((2, 0, 5), np.uint8)
    assert refusal(path, dataset="words").code == "frames.not_a_stack"
    assert refusal(path, dataset="huge").code == "frames.not_a_stack"
    assert refusal(path, dataset="complex").code == "frames.not_a_stack"
    assert refusal(path, dataset="empty").code == "frames.empty"
    assert refusal(path, dataset="flat").code == "frames.no_pixels"
    with h5py.File(path, "w") as file:
        file["numbers"] = np.arange(3.0)
    assert refusal(path).code == "frames.empty"


def test_sizes_that_nobody_has_are_refused_before_memory_is_taken(tmp_path: Path) -> None:
    for name, shape, chunks in (
        ("wide", (1, 2**20, 2**20), (1, 64, 64)),
        ("long", (2**40, 8, 8), (1, 8, 8)),
        ("blocks", (4096, 1024, 1024), (2048, 1024, 1024)),
    ):
        with h5py.File(tmp_path / f"{name}.h5", "w") as file:
            file.create_dataset("frames", shape, np.uint8, chunks=chunks)
        assert refusal(tmp_path / f"{name}.h5").code == "frames.too_large"
        zarr.create_array(tmp_path / f"{name}.zarr", shape=shape, chunks=chunks, dtype=np.uint8)
        assert refusal(tmp_path / f"{name}.zarr").code == "frames.too_large"


def test_a_block_that_inflates_beyond_its_size_is_refused(tmp_path: Path, film: Film) -> None:
    with h5py.File(tmp_path / "film.h5", "w") as file:
        data = file.create_dataset("frames", film.shape, film.dtype, chunks=film.shape, compression="gzip")
        data.id.write_direct_chunk((0, 0, 0), gzip.zlib.compress(bytes(2**26)))
    assert "inflates" in refusal(tmp_path / "film.h5").message


def blosc(n_bytes: int) -> bytes:
    """A header that says so many bytes follow."""
    return b"\x02\x01\x00\x01" + n_bytes.to_bytes(4, "little") * 3 + bytes(64)


BOMBS: dict[str, tuple[Any, Callable[[], bytes]]] = {
    "gzip": (zarr.codecs.GzipCodec(), lambda: gzip.compress(bytes(2**26))),
    "zstd": (zarr.codecs.ZstdCodec(), lambda: b"\x28\xb5\x2f\xfd\xa0" + (2**31).to_bytes(4, "little") + bytes(8)),
    "blosc": (zarr.codecs.BloscCodec(), lambda: blosc(2**31 - 1)),
}


@pytest.mark.parametrize("codec", BOMBS)
@pytest.mark.parametrize("is_sharded", [False, True], ids=["chunks", "shards"])
def test_no_zarr_block_inflates_beyond_its_size(tmp_path: Path, film: Film, codec: str, is_sharded: bool) -> None:
    compressor, bomb = BOMBS[codec]
    path = tmp_path / "film.zarr"
    shards = {"shards": (4, 12, 17)} if is_sharded else {}
    zarr.create_array(path, data=film, chunks=(2, 12, 17), compressors=compressor, **shards)
    np.testing.assert_array_equal(read(path), film)
    chunk = path / "c/0/0/0"
    if not is_sharded:
        chunk.write_bytes(bomb())
    else:
        index = b"".join(n.to_bytes(8, "little") for n in (0, len(bomb()), 0, len(bomb())))
        chunk.write_bytes(bomb() + index + _crc32c(index).to_bytes(4, "little"))
    assert "inflates" in refusal(path).message


def _crc32c(content: bytes) -> int:
    """As shards check their index (RFC 3720, B.4)."""
    crc = 0xFFFFFFFF
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def test_blocks_that_would_run_what_is_in_them_are_refused(tmp_path: Path, film: Film) -> None:
    path = tmp_path / "film.zarr"
    zarr.create_array(path, data=film, zarr_format=2, compressors=None)
    about = json.loads((path / ".zarray").read_text())
    for change in ({"filters": [{"id": "pickle", "protocol": 4}]}, {"compressor": {"id": "pickle", "protocol": 4}}):
        (path / ".zarray").write_text(json.dumps(about | change))
        assert "pickle" in refusal(path).message
    (path / ".zarray").write_text(json.dumps(about | {"filters": [{"id": "fletcher32"}]}))
    problem = refusal(path)
    assert (problem.code, "fletcher32" in problem.message) == ("frames.unsupported", True)


def test_an_array_of_a_zarr_group_is_chosen_by_its_path(tmp_path: Path, film: Film) -> None:
    group = zarr.open_group(tmp_path / "film.zarr", mode="w")
    group.create_array("b/frames", data=film)
    group.create_array("b/times", data=np.arange(11.0))
    np.testing.assert_array_equal(read(tmp_path / "film.zarr"), film)
    group.create_array("a", data=film[..., ::-1])
    problem = refusal(tmp_path / "film.zarr")
    assert (problem.code, "b/frames (11, 12, 17)" in problem.message) == ("frames.choose", True)
    np.testing.assert_array_equal(read(tmp_path / "film.zarr", dataset="/a"), film[..., ::-1])
    assert refusal(tmp_path / "film.zarr", dataset="c").code == "frames.choose"


def test_blocks_of_a_zarr_array_that_are_not_there_are_noticed(tmp_path: Path, film: Film) -> None:
    path = tmp_path / "film.zarr"
    zarr.create_array(path, data=film, chunks=(1, 12, 17))
    (path / "c/4/0/0").unlink()
    with open_frames(path) as frames:
        (found,) = frames.findings()
        assert not frames[4].any()
    assert (found.code, found.n) == ("stack.blocks_absent", 1)


def test_an_ome_zarr_knows_channels_planes_and_times(tmp_path: Path) -> None:
    planes = np.random.default_rng(9).integers(0, 65535, (4, 2, 3, 6, 8), dtype=np.uint16)
    group = zarr.open_group(tmp_path / "film.zarr", mode="w", zarr_format=2)
    scale = [{"type": "scale", "scale": [2.0, 1, 1, 0.5, 0.5]}]
    axes = [{"name": "t", "unit": "second"}, *({"name": name} for name in "czyx")]
    group.attrs["multiscales"] = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": scale}]}]
    group.attrs["omero"] = {"channels": [{"label": "laser"}, {"label": "lamp"}]}
    group.create_array("0", data=planes, chunks=(3, 1, 1, 6, 8))
    path = tmp_path / "film.zarr"
    assert "2 channels (laser, lamp)" in refusal(path).message
    np.testing.assert_array_equal(read(path, channel=1, z_plane=2), planes[:, 1, 2])
    with open_frames(path, Choice(channel=0, z_plane=0)) as frames:
        np.testing.assert_allclose(frames.times_s(), [0, 2, 4, 6])


def test_metadata_of_a_zarr_group_opens_nothing_but_its_own_files(tmp_path: Path, film: Film) -> None:
    zarr.create_array(tmp_path / "elsewhere", data=film)
    group = zarr.open_group(tmp_path / "film.zarr", mode="w")
    axes = [{"name": name} for name in "tyx"]
    group.attrs["ome"] = {"multiscales": [{"axes": axes, "datasets": [{"path": "../elsewhere"}]}]}
    assert refusal(tmp_path / "film.zarr").code == "frames.truncated"


@pytest.fixture
def nd2_planes() -> npt.NDArray[np.uint16]:
    """Two positions of four times, each with two channels: planes of (rows, columns, channels)."""
    return np.random.default_rng(10).integers(0, 65535, (8, 6, 8, 2), dtype=np.uint16)


def test_an_nd2_file_gives_the_chosen_position_and_channel_over_time(
    tmp_path: Path, nd2_planes: npt.NDArray[np.uint16]
) -> None:
    times_ms = np.arange(8) * 100.0 + 7
    path = Nd2File(nd2_planes, [("T", 4), ("P", 2)], times_ms=times_ms).write(tmp_path / "film.nd2")
    assert "2 positions" in refusal(path).message
    assert "2 channels (camera 0, camera 1)" in refusal(path, position=1).message
    np.testing.assert_array_equal(read(path, position=1, channel=0), nd2_planes[1::2, ..., 0])
    with open_frames(path, Choice(position=1, channel=1)) as frames:
        np.testing.assert_allclose(frames.times_s(), times_ms[1::2] / 1000)


def test_z_planes_of_an_nd2_file(tmp_path: Path, nd2_planes: npt.NDArray[np.uint16]) -> None:
    path = Nd2File(nd2_planes[..., :1], [("T", 4), ("Z", 2)]).write(tmp_path / "film.nd2")
    assert "2 z-planes" in refusal(path).message
    np.testing.assert_array_equal(read(path, z_plane=1), nd2_planes[1::2, ..., 0])
    path = Nd2File(nd2_planes[:3, ..., :1], [("Z", 3)]).write(tmp_path / "film.nd2")
    np.testing.assert_array_equal(read(path, is_z_time=True), nd2_planes[:3, ..., 0])


def test_an_nd2_recording_that_was_stopped_gives_what_is_there(
    tmp_path: Path, nd2_planes: npt.NDArray[np.uint16]
) -> None:
    file = Nd2File(nd2_planes[..., :1], [("T", 8)], left_out={2, 6, 7})
    path = file.write(tmp_path / "film.nd2")
    with open_frames(path) as frames:
        assert len(frames) == 6
        assert [(found.code, found.n) for found in frames.findings()] == [("stack.frames_fewer", 2)]
    assert refusal(path, read=2).code == "frames.missing"
    content = file.content()
    file.left_out = set(range(8))
    path.write_bytes(file.content())
    assert refusal(path).code == "frames.empty"
    path.write_bytes(content[:-41])
    assert refusal(path).code == "frames.truncated"


def test_nd2_metadata_that_inflates_without_end_is_refused(tmp_path: Path, nd2_planes: npt.NDArray[np.uint16]) -> None:
    content = Nd2File(nd2_planes[..., :1], [("T", 8)], is_deflated=True).content()
    name = b"ImageAttributesLV!"
    bomb = b"\x4c" + bytes(11) + gzip.zlib.compress(bytes(2**26))
    at = content.index(name) - 16
    moved = content + content[at : at + 8] + len(bomb).to_bytes(8, "little") + content[at + 16 : at + 54] + bomb
    place = content.rindex(name) + len(name)
    moved = moved[:place] + len(content).to_bytes(8, "little") + moved[place + 8 :] + content[-40:]
    (tmp_path / "film.nd2").write_bytes(moved)
    assert "inflates" in refusal(tmp_path / "film.nd2").message
