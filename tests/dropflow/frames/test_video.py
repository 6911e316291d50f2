"""Videos of any codec: every frame exactly, from any place, with its time."""

import io
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
import numpy.typing as npt
import pytest

from dropflow.errors import FramesError
from dropflow.experiment import GreyFrom
from dropflow.frames import Choice, Frames, open_frames
from tests.dropflow.frames.conftest import MemoryFiles, encode

QUIET = {"x264-params": "log-level=none"}
N_FRAMES = 40
IN_COLOUR = Choice(grey_from=GreyFrom.LUMINANCE)


@pytest.fixture(scope="module")
def numbered() -> npt.NDArray[np.uint8]:
    """Frames that keep their number through any codec: 48 x 64, each with so many bright rows."""
    film = np.full((N_FRAMES, 48, 64), 30, np.uint8)
    for number, frame in enumerate(film):
        frame[: number + 1] = 220
    return film


def number_of(frame: npt.NDArray[Any]) -> int:
    """The number that a frame of `numbered` carries."""
    rows = frame.mean(axis=1)
    return int((rows > (rows.min() + rows.max()) / 2).sum()) - 1


def opened(content: bytes, choice: Choice | None = None) -> Frames:
    """The frames of a video."""
    return open_frames(MemoryFiles({"film": content}), choice)


@pytest.mark.parametrize(
    ("container", "codec", "stored", "options"),
    [
        ("mp4", "libx264", "yuv420p", {"g": "12", "bf": "3", **QUIET}),
        ("mp4", "libx264", "yuv420p", {"g": "12", "bf": "2", "x264-params": "log-level=none:open-gop=1"}),
        ("mp4", "mpeg4", "yuv420p", {"g": "12", "bf": "2"}),
        ("matroska", "libx264", "yuv420p", {"g": "15", "bf": "3", **QUIET}),
        ("matroska", "libx265", "yuv420p", {"x265-params": "log-level=none:keyint=12"}),
        ("webm", "libvpx", "yuv420p", {"g": "9", "auto-alt-ref": "1", "lag-in-frames": "10"}),
        ("webm", "libvpx-vp9", "yuv420p", {"g": "9", "lag-in-frames": "10"}),
        ("avi", "libx264", "yuv420p", {"g": "12", "bf": "3", **QUIET}),
        ("avi", "mpeg4", "yuv420p", {"g": "12", "bf": "2"}),
        ("avi", "mjpeg", "yuvj420p", {}),
        ("avi", "huffyuv", "yuv422p", {}),
        ("mov", "prores", "yuv422p10le", {}),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_every_frame_is_the_one_asked_for_in_any_order(
    numbered: npt.NDArray[np.uint8], container: str, codec: str, stored: str, options: dict[str, str]
) -> None:
    content = encode(numbered, container=container, codec=codec, stored=stored, given="gray", options=options)
    with opened(content, IN_COLOUR) as frames:
        assert len(frames) == N_FRAMES
        assert [number_of(frame) for frame in frames] == list(range(N_FRAMES))
        for index in np.random.default_rng(6).permutation(N_FRAMES).tolist():
            assert number_of(frames[index]) == index


def test_a_grey_film_stored_in_colour_is_colour_until_the_experiment_says(numbered: npt.NDArray[np.uint8]) -> None:
    content = encode(numbered, container="mp4", codec="libx264", stored="yuv420p", given="gray", options=QUIET)
    with pytest.raises(FramesError) as raised:
        opened(content)
    assert raised.value.code == "frames.colour"
    for grey_from in GreyFrom:
        with opened(content, Choice(grey_from=grey_from)) as frames:
            assert abs(float(frames[20][:10].mean()) - 220) < 3
            assert abs(float(frames[20][-10:].mean()) - 30) < 3


def test_colours_become_grey_as_the_experiment_says() -> None:
    film = np.zeros((3, 16, 16, 3), np.uint8)
    film[..., 1] = 200
    content = encode(film, container="avi", codec="rawvideo", stored="bgr24", given="rgb24")
    for grey_from, level in ((GreyFrom.RED, 0), (GreyFrom.GREEN, 200), (GreyFrom.LUMINANCE, 117)):
        with opened(content, Choice(grey_from=grey_from)) as frames:
            np.testing.assert_array_equal(frames[1], np.full((16, 16), level))


def test_more_than_eight_bits_stay() -> None:
    film = np.random.default_rng(7).integers(0, 4096, (3, 16, 18), dtype=np.uint16)
    content = encode(film, container="matroska", codec="ffv1", stored="gray12le", given="gray12le")
    with opened(content) as frames:
        assert frames.dtype == np.uint16
        np.testing.assert_array_equal(list(frames), film)


def test_raw_grey_quicktime_whose_greys_are_a_palette(numbered: npt.NDArray[np.uint8]) -> None:
    content = encode(numbered, container="mov", codec="rawvideo", stored="gray", given="gray")
    with opened(content) as frames:
        assert frames.dtype == np.uint8
        for index in (20, 0, 5):
            np.testing.assert_array_equal(frames[index], numbered[index])


def test_times_are_those_of_the_file_even_if_the_camera_paused(numbered: npt.NDArray[np.uint8]) -> None:
    stamps = [0, 1, 2, 3, 4, 25, 26, 27, 28, 40]
    for container in ("matroska", "mp4"):
        content = encode(
            numbered[:10], container=container, codec="libx264", stored="yuv420p", given="gray", options=QUIET,
            stamps=stamps,
        )  # fmt: skip
        with opened(content, IN_COLOUR) as frames:
            np.testing.assert_allclose(frames.times_s(), np.array(stamps) / 10, atol=1e-3)
            assert [number_of(frames[index]) for index in (9, 5, 0)] == [9, 5, 0]


def test_the_rate_of_an_avi_gives_its_times(numbered: npt.NDArray[np.uint8]) -> None:
    content = encode(numbered, container="avi", codec="libx264", stored="yuv420p", given="gray", options=QUIET)
    with opened(content, IN_COLOUR) as frames:
        np.testing.assert_allclose(frames.times_s(), np.arange(N_FRAMES) / 10)


def sound(container: str) -> bytes:
    """A file with sound and no picture."""
    file = io.BytesIO()
    with av.open(file, "w", format=container) as output:
        stream = output.add_stream("pcm_s16le", rate=8000, layout="mono")
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        frame.rate, frame.pts, frame.time_base = 8000, 0, Fraction(1, 8000)
        for packet in [*stream.encode(frame), *stream.encode(None)]:
            output.mux(packet)
    return file.getvalue()


@pytest.mark.parametrize("container", ["avi", "matroska", "mov"])
def test_a_video_without_frames(container: str) -> None:
    with pytest.raises(FramesError) as raised:
        opened(sound(container))
    assert raised.value.code == "frames.empty"


@pytest.mark.parametrize("container", ["avi", "matroska", "mov"])
def test_a_video_that_ends_before_its_first_frame(container: str) -> None:
    file = io.BytesIO()
    with av.open(file, "w", format=container) as output:
        stream = output.add_stream("rawvideo" if container != "matroska" else "ffv1", rate=10)
        stream.height, stream.width, stream.pix_fmt = 12, 16, "gray"
        output.start_encoding()
    with pytest.raises(FramesError) as raised:
        opened(file.getvalue())
    assert raised.value.code in {"frames.empty", "frames.no_pixels", "frames.truncated"}


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_a_video_cut_off_gives_its_first_frames_or_an_error(numbered: npt.NDArray[np.uint8], share: float) -> None:
    content = encode(numbered, container="matroska", codec="ffv1", stored="gray", given="gray")
    with opened(content[: int(share * len(content))]) as frames:
        assert 0 < len(frames) < N_FRAMES
        assert [number_of(frames[index]) for index in range(len(frames) - 1)] == list(range(len(frames) - 1))


def test_a_list_of_other_files_is_no_video(tmp_path: Path) -> None:
    for text in ("ffconcat version 1.0\nfile /etc/passwd\n", "#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:9/a.ts\n"):
        path = tmp_path / "film.mp4"
        path.write_text(text)
        with pytest.raises(FramesError) as raised:
            open_frames(path)
        assert raised.value.code == "frames.not_an_image"


def test_the_parts_of_a_split_film_follow_each_other(tmp_path: Path, numbered: npt.NDArray[np.uint8]) -> None:
    for part, start in ((1, 0), (2, 15), (10, 30)):
        content = encode(numbered[start : start + 15], container="avi", codec="ffv1", stored="gray", given="gray")
        (tmp_path / f"film_{part}.avi").write_bytes(content)
    (tmp_path / "experiment.yaml").write_text("name: beside")
    with open_frames(tmp_path) as frames:
        assert [number_of(frames[index]) for index in (39, 0, 29, 15, 14)] == [39, 0, 29, 15, 14]
        assert frames.times_s() is None
        assert frames.label(30) == "film_10.avi, frame 0"
