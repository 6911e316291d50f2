"""TIFF files as microscopes, cameras and programs write them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import tifffile

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames import Choice, Frames, open_frames

Film = npt.NDArray[Any]


def opened(path: Path, **choice: Any) -> Frames:
    """The frames with this choice."""
    return open_frames(path, Choice(**choice))


def refusal(path: Path, **choice: Any) -> FramesError:
    """The error that opening with this choice raises."""
    with pytest.raises(FramesError) as raised:
        opened(path, **choice).close()
    return raised.value


@pytest.mark.parametrize("compression", [None, "lzw", "deflate", "adobe_deflate", "packbits", "lzma", "zstd"])
@pytest.mark.parametrize("layout", [{}, {"rowsperstrip": 5}, {"tile": (16, 32)}], ids=["strip", "strips", "tiles"])
@pytest.mark.parametrize("dtype", ["uint8", "uint16", "int16", "float32", "float64"])
def test_common_compressions_layouts_and_depths(
    tmp_path: Path, compression: str | None, layout: dict[str, Any], dtype: str
) -> None:
    film = np.random.default_rng(2).integers(0, 200, (3, 21, 33)).astype(dtype)
    path = tmp_path / "film.tif"
    has_predictor = compression in {"lzw", "deflate"}
    tifffile.imwrite(
        path, film, photometric="minisblack", compression=compression, predictor=has_predictor or None, **layout
    )
    with opened(path) as frames:
        assert frames.dtype == np.dtype(dtype)
        np.testing.assert_array_equal(list(frames), film)


def test_twelve_bits_packed_together_come_out_as_sixteen(tmp_path: Path) -> None:
    values = np.random.default_rng(3).integers(0, 4096, (4, 6), dtype=np.uint16)
    bits = ((values[..., None] >> np.arange(11, -1, -1)) & 1).astype(np.uint8).reshape(4, -1)
    path = tmp_path / "frame.tif"
    tifffile.imwrite(path, np.packbits(bits, axis=1), photometric="minisblack")
    with tifffile.TiffFile(path, mode="r+b") as tiff:
        tiff.pages[0].tags["BitsPerSample"].overwrite(12)
        tiff.pages[0].tags["ImageWidth"].overwrite(6)
    with opened(path) as frames:
        np.testing.assert_array_equal(frames[0], values)


def test_a_jpeg_inside_is_read(tmp_path: Path) -> None:
    ramp = np.tile(np.arange(64, dtype=np.uint8), (48, 1))
    tifffile.imwrite(tmp_path / "frame.tif", ramp, compression="jpeg", photometric="minisblack")
    with opened(tmp_path / "frame.tif") as frames:
        assert np.abs(frames[0].astype(int) - ramp).max() <= 4


def test_other_compressions_are_named(tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "frame.tif", np.zeros((16, 16), np.uint8), compression="jpeg2000")
    problem = refusal(tmp_path / "frame.tif")
    assert (problem.code, "JPEG" in problem.message) == ("frames.unsupported", True)


def test_white_is_zero_where_the_file_says_so(tmp_path: Path) -> None:
    pixels = np.arange(12, dtype=np.uint8).reshape(3, 4)
    tifffile.imwrite(tmp_path / "frame.tif", pixels, photometric="miniswhite")
    with opened(tmp_path / "frame.tif") as frames:
        np.testing.assert_array_equal(frames[0], 255 - pixels)


def test_a_palette_of_greys_is_grey_and_one_of_colours_is_colour(tmp_path: Path) -> None:
    indices = np.arange(12, dtype=np.uint8).reshape(3, 4)
    greys = np.tile(np.arange(256, dtype=np.uint16)[::-1] * 257, (3, 1))
    tifffile.imwrite(tmp_path / "grey.tif", indices, photometric="palette", colormap=greys)
    with opened(tmp_path / "grey.tif") as frames:
        np.testing.assert_array_equal(frames[0], greys[0][indices])
    greys[1] = 0
    tifffile.imwrite(tmp_path / "colour.tif", indices, photometric="palette", colormap=greys)
    assert refusal(tmp_path / "colour.tif").code == "frames.colour"
    with opened(tmp_path / "colour.tif", grey_from=GreyFrom.GREEN) as frames:
        assert not frames[0].any()


@pytest.mark.parametrize("planarconfig", ["contig", "separate"])
def test_colour_in_either_layout_and_alpha_that_says_nothing(tmp_path: Path, planarconfig: str) -> None:
    colour = np.random.default_rng(4).integers(0, 255, (20, 30, 3), dtype=np.uint8)
    stored = colour if planarconfig == "contig" else np.moveaxis(colour, -1, 0)
    tifffile.imwrite(tmp_path / "frame.tif", stored, photometric="rgb", planarconfig=planarconfig)
    assert refusal(tmp_path / "frame.tif").code == "frames.colour"
    with opened(tmp_path / "frame.tif", grey_from=GreyFrom.BLUE) as frames:
        np.testing.assert_array_equal(frames[0], colour[..., 2])
    with opened(tmp_path / "frame.tif", grey_from=GreyFrom.LUMINANCE) as frames:
        np.testing.assert_allclose(frames[0], colour @ [0.299, 0.587, 0.114], atol=0.51)
    tifffile.imwrite(tmp_path / "alpha.tif", colour[..., :2], photometric="minisblack", extrasamples=["unassalpha"])
    with opened(tmp_path / "alpha.tif") as frames:
        np.testing.assert_array_equal(frames[0], colour[..., 0])


@pytest.fixture
def planes() -> Film:
    """Times, z-planes and channels of small frames: (4, 3, 2, 6, 8)."""
    return np.random.default_rng(5).integers(0, 65535, (4, 3, 2, 6, 8), dtype=np.uint16)


def write_ome(path: Path, planes: Film, order: str = "TZCYX", **metadata: Any) -> Path:
    """An OME-TIFF with planes in the given order of axes."""
    stored = planes.transpose(["TZCYX".index(axis) for axis in order])
    tifffile.imwrite(path, stored, ome=True, photometric="minisblack", metadata={"axes": order, **metadata})
    return path


@pytest.mark.parametrize("order", ["TZCYX", "TCZYX", "ZTCYX", "CTZYX"])
def test_an_ome_tiff_gives_the_chosen_channel_and_plane_over_time(tmp_path: Path, planes: Film, order: str) -> None:
    path = write_ome(tmp_path / "film.ome.tif", planes, order)
    with opened(path, channel=1, z_plane=2) as frames:
        np.testing.assert_array_equal(list(frames), planes[:, 2, 1])


def test_what_must_be_chosen_is_named_with_what_there_is(tmp_path: Path, planes: Film) -> None:
    path = write_ome(tmp_path / "film.ome.tif", planes, Channel={"Name": ["laser", "lamp"]})
    problem = refusal(path)
    assert problem.code == "frames.choose"
    assert "2 channels (laser, lamp)" in problem.message
    assert "channel" in str(problem.hint)
    assert "3 z-planes" in refusal(path, channel=0).message
    assert "channel 2" in refusal(path, channel=2, z_plane=0).message
    assert "cannot be times" in refusal(path, channel=0, is_z_time=True).message


def test_z_planes_may_be_times(tmp_path: Path, planes: Film) -> None:
    path = write_ome(tmp_path / "film.ome.tif", planes[:1, :, :1])
    assert "is_z_time" in str(refusal(path).hint)
    with opened(path, is_z_time=True) as frames:
        np.testing.assert_array_equal(list(frames), planes[0, :, 0])


def test_a_position_of_the_stage_is_chosen(tmp_path: Path, planes: Film) -> None:
    path = tmp_path / "film.ome.tif"
    with tifffile.TiffWriter(path, ome=True) as writer:
        for position in range(2):
            writer.write(planes[:, position, 0], photometric="minisblack", metadata={"axes": "TYX"})
    assert "2 positions" in refusal(path).message
    with opened(path, position=1) as frames:
        np.testing.assert_array_equal(list(frames), planes[:, 1, 0])


def ome_xml(n_times: int, data: str, own: str = "") -> str:
    """An OME-XML description of frames of 6 x 8."""
    return (
        f'<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06" {own}><Image ID="Image:0">'
        f'<Pixels ID="Pixels:0" DimensionOrder="XYCZT" Type="uint16" SizeX="8" SizeY="6"'
        f' SizeC="1" SizeZ="1" SizeT="{n_times}"'
        f' TimeIncrement="20" TimeIncrementUnit="ms">{data}</Pixels></Image></OME>'
    )


def test_each_file_of_a_set_gives_its_own_frames_and_follows_no_name(tmp_path: Path, planes: Film) -> None:
    film = planes[:, 0, 0]
    folder = tmp_path / "set"
    folder.mkdir()
    data = "".join(
        f'<TiffData IFD="{t % 2}" FirstT="{t}" PlaneCount="1"><UUID FileName="../part{t // 2}.tif">urn:{t // 2}</UUID>'
        "</TiffData>"
        for t in range(4)
    )
    for part in range(2):
        about = ome_xml(4, data, own=f'UUID="urn:{part}"')
        tifffile.imwrite(
            folder / f"part{part}.tif", film[2 * part : 2 * part + 2], description=about, metadata=None,
            photometric="minisblack",
        )  # fmt: skip
    with opened(folder) as frames:
        np.testing.assert_array_equal(list(frames), film)
        np.testing.assert_allclose(frames.times_s(), [0, 0.02, 0.04, 0.06])
    with opened(folder / "part1.tif") as frames:
        np.testing.assert_array_equal(list(frames), film[2:])
        (found,) = frames.findings()
        assert (found.code, found.n) == ("stack.frames_fewer", 2)


def test_a_film_that_was_stopped_early_gives_what_is_there_and_says_so(tmp_path: Path, planes: Film) -> None:
    path = tmp_path / "film.ome.tif"
    film = planes[:, 0, 0]
    tifffile.imwrite(path, film, description=ome_xml(9, "<TiffData/>"), metadata=None, photometric="minisblack")
    with opened(path) as frames:
        np.testing.assert_array_equal(list(frames), film)
        assert [found.code for found in frames.findings()] == ["stack.frames_fewer"]


@pytest.mark.parametrize(
    "about",
    [
        '<!DOCTYPE a [<!ENTITY b "bbbb">]>' + ome_xml(4, "<TiffData/>"),
        ome_xml(4, "<TiffData/>" * 3),
        ome_xml(0, "<TiffData/>"),
        ome_xml(10**9, '<TiffData PlaneCount="1000000000"/>'),
        ome_xml(4, '<TiffData IFD="-1"/>'),
        ome_xml(4, "<TiffData/>")[:-20] + "</OME>",
    ],
    ids=["entities", "pages twice", "no times", "endless", "page before the first", "cut off"],
)
def test_hostile_ome_xml_is_an_error(tmp_path: Path, planes: Film, about: str) -> None:
    path = tmp_path / "film.ome.tif"
    tifffile.imwrite(path, planes[:, 0, 0], description=about, metadata=None, photometric="minisblack")
    assert refusal(path).code in {"frames.truncated", "frames.too_large", "frames.empty"}


def test_an_imagej_stack_knows_channels_slices_and_its_interval(tmp_path: Path, planes: Film) -> None:
    path = tmp_path / "film.tif"
    tifffile.imwrite(path, planes, imagej=True, metadata={"axes": "TZCYX", "finterval": 0.25})
    assert "2 channels" in refusal(path).message
    with opened(path, channel=1, z_plane=0) as frames:
        np.testing.assert_array_equal(list(frames), planes[:, 0, 1])
        np.testing.assert_allclose(frames.times_s(), [0, 0.25, 0.5, 0.75])


def test_what_imagej_calls_slices_of_a_film_are_its_frames(tmp_path: Path, planes: Film) -> None:
    path = tmp_path / "film.tif"
    tifffile.imwrite(path, planes[0, :, 0], imagej=True, metadata={"axes": "ZYX"})
    with opened(path) as frames:
        np.testing.assert_array_equal(list(frames), planes[0, :, 0])
        assert frames.times_s() is None


def test_a_block_of_frames_behind_one_page_is_read_to_its_end_and_not_beyond(tmp_path: Path, planes: Film) -> None:
    film = planes[:, 0, 0]
    path = tmp_path / "film.tif"
    tifffile.imwrite(path, film, photometric="minisblack", truncate=True)
    with tifffile.TiffFile(path) as tiff:
        assert len(tiff.pages) == 1
        assert json.loads(tiff.pages[0].description)["truncated"]
    with opened(path) as frames:
        np.testing.assert_array_equal(list(frames), film)
    path.write_bytes(path.read_bytes()[:-10])
    with opened(path) as frames:
        np.testing.assert_array_equal(frames[2], film[2])
        with pytest.raises(FramesError) as raised:
            frames[3]
    assert (raised.value.code, raised.value.frame) == ("frames.truncated", 3)


def test_a_choice_that_a_file_has_no_word_for_is_an_error(tmp_path: Path, planes: Film) -> None:
    path = tmp_path / "film.tif"
    tifffile.imwrite(path, planes[:, 0, 0], photometric="minisblack")
    for choice in ({"channel": 1}, {"z_plane": 3}, {"position": 1}, {"dataset": "frames"}):
        assert refusal(path, **choice).code == "frames.choose"
    with opened(path, channel=0, z_plane=0, position=0) as frames:
        assert len(frames) == 4
