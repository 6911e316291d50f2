"""Which of the images in a file are the frames of the film, where a file holds more than that."""

from dataclasses import dataclass
from typing import Literal

from dropflow.errors import FramesError
from dropflow.experiment import Experiment, GreyFrom


@dataclass(frozen=True)
class Choice:
    """What an experiment says about its files. Nothing is ever chosen where it says nothing and there is a choice."""

    grey_from: GreyFrom | None = None
    dataset: str | None = None
    channel: int | None = None
    z_plane: int | None = None
    is_z_time: bool = False
    position: int | None = None
    left_out: tuple[int, ...] = ()
    """Frames that cannot be read and may be missing."""

    @classmethod
    def of(cls, experiment: Experiment, left_out: tuple[int, ...] = ()) -> "Choice":
        """The choice that `experiment` makes, without the frames that were found broken."""
        return cls(
            grey_from=experiment.grey_from,
            dataset=experiment.dataset,
            channel=experiment.channel,
            z_plane=experiment.z_plane,
            is_z_time=experiment.is_z_time,
            position=experiment.position,
            left_out=left_out,
        )


@dataclass(frozen=True)
class Axes:
    """How many times, z-planes, channels and positions a file says it holds."""

    n_times: int = 1
    n_z_planes: int = 1
    n_channels: int = 1
    channel_names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Selection:
    """One channel, and the axis along which the film runs."""

    channel: int
    along: Literal["time", "z"]
    fixed: int
    """Index on the axis along which it does not run."""
    n: int

    def place(self, index: int) -> tuple[int, int]:
        """Time and z-plane of frame `index`."""
        return (index, self.fixed) if self.along == "time" else (self.fixed, index)


def select(axes: Axes, choice: Choice, *, file: str) -> Selection:
    """Say which images are the frames.

    Raises
    ------
    FramesError
        ``frames.choose`` where there are several channels or z-planes and none is chosen, or one that is not there.
    """
    channel = pick("channel", axes.n_channels, choice.channel, file=file, names=axes.channel_names)
    if not choice.is_z_time:
        z_plane = pick("z_plane", axes.n_z_planes, choice.z_plane, file=file)
        return Selection(channel, "time", z_plane, axes.n_times)
    if axes.n_times > 1 and axes.n_z_planes > 1:
        raise FramesError(
            f"The file has {axes.n_times} times and {axes.n_z_planes} z-planes: its z-planes cannot be times, too.",
            code="frames.choose",
            file=file,
            hint="Take is_z_time out of the experiment, or choose a z_plane.",
        )
    if axes.n_times > 1:
        return Selection(channel, "time", 0, axes.n_times)
    return Selection(channel, "z", 0, axes.n_z_planes)


def check_single(choice: Choice, *, file: str) -> None:
    """Refuse a choice among channels, z-planes or positions that a kind of file has no word for."""
    pick("position", 1, choice.position, file=file)
    select(Axes(), choice, file=file)


_WORDS = {"channel": "channels", "z_plane": "z-planes", "position": "positions"}


def pick(
    field: Literal["channel", "z_plane", "position"],
    n: int,
    chosen: int | None,
    *,
    file: str,
    names: tuple[str, ...] = (),
) -> int:
    """The chosen one of `n`, or the only one."""
    called = f" ({', '.join(names[:8])})" if any(names) else ""
    if chosen is None:
        if n == 1:
            return 0
        also = " Set is_z_time if its z-planes are times." if field == "z_plane" else ""
        raise FramesError(
            f"The file holds {n} {_WORDS[field]}{called}.",
            code="frames.choose",
            file=file,
            hint=f"Set {field} in the experiment to one of 0 to {n - 1}.{also}",
        )
    if chosen >= n:
        raise FramesError(
            f"The experiment says {field} {chosen}, but the file holds {n} {_WORDS[field]}{called}.",
            code="frames.choose",
            file=file,
            hint=f"They count from 0: set {field} to one of 0 to {n - 1}." if n > 1 else f"Take {field} out.",
        )
    return chosen
