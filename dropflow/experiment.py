"""What was filmed: optics, timing, phase and fluid. The one schema of ``experiment.yaml``."""

from datetime import datetime
from enum import StrEnum
from math import hypot
from pathlib import Path
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from dropflow import documents
from dropflow.documents import FieldError, StrictModel
from dropflow.errors import ExperimentError


def called(label: str) -> Any:
    """What people read where the name of a field does not say it."""
    return Field(json_schema_extra={"label": label})


class DropletTone(StrEnum):
    """How droplets look against the fluid around them."""

    BRIGHT = "bright"
    DARK = "dark"


class Phase(StrEnum):
    """Which phase was filmed. In the paper, bright droplets rise in the bottom one, dark ones sink in the top one."""

    BOTTOM = "bottom"
    TOP = "top"


class GreyFrom(StrEnum):
    """How a colour frame becomes grey: one channel, or luminance 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601)."""

    LUMINANCE = "luminance"
    RED = "red"
    GREEN = "green"
    BLUE = "blue"


class FixedMaterial(StrictModel):
    """Density difference and viscosity, constant over the film."""

    delta_density_kg_m3: float
    """The droplet's density minus that of the fluid around it, kg/m3. Negative rises along `up`, positive sinks."""
    viscosity_pa_s: Annotated[float, Field(gt=0)]
    """Dynamic viscosity of the fluid around the droplet, Pa s."""


class Experiment(StrictModel):
    """One film and everything that must be known to read it in physical units."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    """What people call this experiment."""
    pixel_size_um: Annotated[float, Field(gt=0, le=1e4)]
    """Edge of one pixel in the sample, micrometres."""
    frame_interval_s: Annotated[float, Field(gt=0, le=1e6)] | None = None
    """Time between frames, seconds. Give this, or `timestamps`, or `times_from_frames`."""
    timestamps: Annotated[str | None, called("File of times")] = None
    """CSV file beside experiment.yaml with one time per frame (column `time_s`), instead of `frame_interval_s`."""
    times_from_frames: Annotated[bool, called("Times from the frames' own file")] = False
    """The frames' own file says when each was taken (OME-TIFF, ND2, video): use that, instead of `frame_interval_s`."""
    droplets: DropletTone
    """`bright` on a dark ground, or `dark` on a bright one. `dark` inverts the image and nothing else."""
    up: Annotated[tuple[float, float], called("Up, against gravity")] = (0.0, -1.0)
    """Direction against gravity in image axes (x right, y down)."""
    phase: Phase | None = None
    """Which phase was filmed: `bottom` or `top`."""
    material: Annotated[
        Annotated[FixedMaterial, Tag("Fixed")] | Annotated[str, Field(min_length=1, max_length=100), Tag("Name")],
        Discriminator(lambda material: "Name" if isinstance(material, str) else "Fixed"),
    ]
    """Density difference and viscosity, or the name of a material file."""
    flat_field: str | None = None
    """Image of the empty field of view, beside experiment.yaml: frames are divided by it."""
    temperature_log: str | None = None
    """CSV file with columns `time_s` and `temperature_c`, beside experiment.yaml."""
    observation_depth_um: Annotated[float, Field(gt=0)] | None = None
    """Depth over which droplets are seen, micrometres; without it densities are per area."""
    grey_from: Annotated[GreyFrom | None, called("Colour to grey by")] = None
    """How colour frames become grey. Without it a colour frame is an error."""
    dataset: Annotated[Annotated[str, Field(min_length=1, max_length=1000)] | None, called("Array inside the file")] = (
        None
    )
    """Path of the frames inside an HDF5 or Zarr file that holds more than one array."""
    channel: Annotated[int, Field(ge=0)] | None = None
    """Which channel of a microscope's file (OME-TIFF, OME-Zarr, ND2, ImageJ) is the film, counted from 0."""
    z_plane: Annotated[Annotated[int, Field(ge=0)] | None, called("Z-plane")] = None
    """Which z-plane of a microscope's file is the film, counted from 0."""
    is_z_time: Annotated[bool, called("Z-planes are the frames")] = False
    """What the file calls z-planes are the frames of the film."""
    position: Annotated[Annotated[int, Field(ge=0)] | None, called("Position of the stage")] = None
    """Which position of the stage, or image of a set, is the film, counted from 0."""
    max_failed_frame_share: Annotated[float, Field(ge=0, lt=1), called("Share of frames that may be unreadable")] = 0.0
    """Up to this share of the frames may be unreadable: they are left out as gaps in time, and results say so. With 0 a
    single one is an error."""
    recorded_at: datetime | None = None
    """When the film began."""
    notes: Annotated[str, Field(max_length=20_000)] = ""
    """Free text."""
    tags: tuple[Annotated[str, Field(min_length=1, max_length=100)], ...] = ()
    """Free words to find the experiment by."""

    @field_validator("up")
    @classmethod
    def _up_is_a_direction(cls, up: tuple[float, float]) -> tuple[float, float]:
        length = hypot(*up)
        if length == 0:
            raise ValueError("must not be (0, 0): give the direction against gravity, e.g. [0, -1]")
        return (up[0] / length, up[1] / length)

    @model_validator(mode="after")
    def _one_source_of_time(self) -> "Experiment":
        if (self.frame_interval_s is not None) + (self.timestamps is not None) + self.times_from_frames != 1:
            raise FieldError(
                "frame_interval_s",
                "give one of frame_interval_s (seconds between frames), timestamps (a CSV file) "
                "and times_from_frames (the frames' file knows)",
            )
        return self


def parse_experiment(content: Any, *, file: str | None = None) -> Experiment:
    """Validate a document that was read from YAML or JSON; raise `ExperimentError` naming each wrong field."""
    return documents.parse(Experiment, content, ExperimentError, file=file)


def load_experiment(path: Path) -> Experiment:
    """Read ``experiment.yaml``. Files it names are looked up beside it by whoever needs them."""
    return documents.load(Experiment, path, ExperimentError)
