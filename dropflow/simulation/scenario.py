"""Every constant of a simulated experiment, once. The scenarios of the docs are instances; `vary` draws others."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, model_validator

from dropflow import documents
from dropflow.documents import StrictModel
from dropflow.errors import FieldProblem, ParametersError
from dropflow.experiment import DropletTone, Experiment, FixedMaterial, Phase

if TYPE_CHECKING:
    from dropflow.tracking.grid import Grid

FULL_HEIGHT_PX = 2058
FULL_WIDTH_PX = 2448

Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Share = Annotated[float, Field(ge=0, le=1)]


class Scenario(StrictModel):
    """A simulated experiment without its seed and its number of frames.

    Grey values ("levels") are on a scale of 0 to 255 whatever the bit depth. Image axes: x right, y down.
    """

    name: str
    """What this scenario is called."""

    # The film
    height_px: Annotated[int, Field(ge=16, le=20_000)] = FULL_HEIGHT_PX
    """Rows of a frame."""
    width_px: Annotated[int, Field(ge=16, le=20_000)] = FULL_WIDTH_PX
    """Columns of a frame."""
    pixel_size_um: Positive = 0.625
    """Edge of a pixel in the sample (the paper's 1.6 px/um, section 2.2)."""
    frame_interval_s: Positive = 1.0
    """Time between frames."""
    bit_depth: Literal[8, 12, 16] = 8
    """Bits of a grey value; 12 bits are stored in 16, from 0 to 4095."""

    # Droplets and fluid
    droplets: DropletTone = DropletTone.BRIGHT
    """Bright droplets on a dark ground (the paper's bottom phase), or dark ones on a bright ground (top phase)."""
    n_droplets: NotNegative = 500.0
    """Visible droplets expected in a frame of 2058 x 2448 px; other frames hold as many per area."""
    delta_density_kg_m3: float = -30.0
    """Density of the droplets minus that of the fluid: negative rises, positive sinks."""
    viscosity_pa_s: Positive = 1e-3
    """Dynamic viscosity of the fluid."""
    radius_min_um: Positive = 4.0
    """Smallest radius; new droplets nucleate with it."""
    radius_max_um: Positive = 40.0
    """Largest radius at the start and of droplets that come in."""
    radius_median_um: Positive = 7.0
    """Median radius per volume, before the cuts (log-normal). The median of what is seen is larger."""
    radius_spread: Positive = 0.55
    """Standard deviation of ln(radius), before the cuts."""
    growth_um_s: float = 0.02
    """Growth dr/dt of a droplet of 10 um."""
    growth_exponent: float = 0.0
    """dr/dt grows as radius to this power: 0 for equal growth, -1 for diffusion to single droplets."""
    nucleation_per_s: NotNegative = 2.0
    """Droplets nucleated per second in the volume of a frame of 2058 x 2448 px."""
    collision_efficiency: Share = 0.02
    """Share of the pairs which touch in space that coalesce; the others pass (section 5)."""
    wake_strength: NotNegative = 0.0
    """Flow that a droplet drags along by its own drag (Stokeslet), times this: 0 for none, 1 for Stokes' value."""
    wake_range_um: Positive = 150.0
    """Beyond this distance a droplet is not felt by others."""

    # Flow
    flow_rms_um_s: NotNegative = 8.0
    """Root mean square of each in-plane component of the flow, without drift."""
    flow_depth_rms_um_s: NotNegative = 0.5
    """Root mean square of the flow through the focal plane."""
    flow_length_um: Positive = 200.0
    """Correlation length: the stream function correlates as exp(-d^2 / (2 length^2))."""
    flow_time_s: Positive = 30.0
    """Correlation time, in the same sense, at a fixed place."""
    kspread: NotNegative = 0.0
    """Broadens the flow's spectrum: wave numbers are multiplied by exp(kspread * N(0, 1)), energies kept."""
    n_flow_modes: Annotated[int, Field(ge=8, le=1024)] = 64
    """Waves that the flow is made of."""
    drift_x_um_s: float = 0.0
    """Mean flow to the right."""
    drift_y_um_s: float = 2.0
    """Mean flow down the image (section 4.6 finds the fluid moving against the droplets)."""

    # Light
    sheet_sigma_um: Positive = 25.0
    """Thickness of the light sheet: its profile in depth is a Gaussian of this standard deviation."""
    point_spread_px: Annotated[float, Field(ge=0.5)] = 1.0
    """Standard deviation of the point spread in the focal plane."""
    defocus_px_per_um: NotNegative = 0.2
    """Blur gained per um from the focal plane; it adds to the point spread in squares."""
    contrast_levels: Positive = 170.0
    """Levels that droplet liquid filling the sheet adds to (or takes from) the background."""
    background_levels: NotNegative = 30.0
    """Levels of the fluid alone."""
    offset_levels: NotNegative = 4.0
    """Levels without light."""
    opacity: Share = 0.5
    """Share of the light of farther droplets that a thick droplet takes away."""
    opacity_depth_um: Positive = 30.0
    """Path inside a droplet over which it becomes opaque (1 - 1/e of `opacity`)."""
    gradient: Annotated[float, Field(ge=-1.5, le=1.5)] = 0.35
    """Light at the bottom row minus light at the top row, over that in the middle."""
    flicker: Annotated[float, Field(ge=0, le=0.3)] = 0.005
    """Relative standard deviation of the lamp's light from frame to frame."""
    streak_amplitude: Annotated[float, Field(ge=0, le=1)] = 0.06
    """Relative change of the light behind a droplet, as seen from the lamp on the right."""
    streak_length_um: Positive = 500.0
    """Distance over which a streak fades."""
    streak_spread_px2: Annotated[float, Field(ge=0, le=0.25)] = 0.03
    """Widening of streaks with distance (half the gain of variance per pixel)."""
    streak_upstream: NotNegative = 0.5
    """Streaks that come from droplets outside the frame, as a share of `streak_amplitude`."""

    # Camera
    n_dirt: NotNegative = 20.0
    """Spots of dirt on the chip of 2058 x 2448 px; in the frames and in the flat field."""
    dirt_radius_px: Positive = 5.0
    """Median radius of a spot."""
    dirt_depth: Share = 0.35
    """Largest share of light that a spot takes."""
    vignette: Share = 0.05
    """Share of light missing in the corners; in the frames and in the flat field."""
    electrons_per_level: Positive = 40.0
    """Electrons behind one level: shot noise is sqrt(level / this)."""
    read_noise_levels: NotNegative = 0.8
    """Standard deviation of the camera's own noise."""
    n_flat_field_frames: Annotated[int, Field(ge=1)] = 50
    """Frames averaged in the flat field."""

    # Numerics
    n_columns: Annotated[int, Field(ge=2, le=1000)] = 25
    """Cells of the flow's grid along x."""
    n_rows: Annotated[int, Field(ge=2, le=1000)] = 20
    """Cells of the flow's grid along y."""
    margin_um: Positive = 100.0
    """The simulated volume is larger than the frame by this on each side."""
    max_step_um: Positive = 15.0
    """No droplet moves farther than about this in one sub-step."""

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        if self.radius_min_um >= self.radius_max_um:
            raise ValueError("radius_min_um must be smaller than radius_max_um")
        if self.margin_um < 1.5 * self.radius_max_um:
            raise ValueError("margin_um must be at least 1.5 times radius_max_um, or droplets would appear at once")
        return self

    @property
    def area_share(self) -> float:
        """Area of a frame over that of 2058 x 2448 px: what is given per full frame is multiplied by it."""
        return self.height_px * self.width_px / (FULL_HEIGHT_PX * FULL_WIDTH_PX)

    @property
    def is_dark(self) -> bool:
        """Whether droplets are darker than the fluid."""
        return self.droplets is DropletTone.DARK

    @property
    def grid(self) -> "Grid":
        """Where the true flow is written down."""
        # Imported here, for tracking takes seconds to load and the constants are read without it.
        from dropflow.tracking.grid import Grid

        return Grid(self.height_px, self.width_px, self.n_rows, self.n_columns)

    def experiment(self, *, seed: int, is_with_flat_field: bool = True) -> Experiment:
        """What ``experiment.yaml`` says of this film."""
        return Experiment(
            name=f"simulated {self.name}, seed {seed}",
            pixel_size_um=self.pixel_size_um,
            frame_interval_s=self.frame_interval_s,
            droplets=self.droplets,
            phase=Phase.TOP if self.is_dark else Phase.BOTTOM,
            material=FixedMaterial(delta_density_kg_m3=self.delta_density_kg_m3, viscosity_pa_s=self.viscosity_pa_s),
            flat_field="flat_field.tif" if is_with_flat_field else None,
            notes="Made by `dropflow simulate`; every constant is in scenario.yaml.",
            tags=("simulated", self.name),
        )


EASY = Scenario(name="easy", frame_interval_s=0.5, n_droplets=200, delta_density_kg_m3=-20, flow_rms_um_s=6)
FAST = Scenario(
    name="fast", frame_interval_s=0.5, delta_density_kg_m3=-100, flow_rms_um_s=40, flow_depth_rms_um_s=2, drift_y_um_s=8
)
DENSE = Scenario(name="dense", n_droplets=1000)
DIRTY = Scenario(
    name="dirty",
    contrast_levels=115,
    electrons_per_level=10,
    read_noise_levels=2.0,
    n_dirt=120,
    dirt_radius_px=7,
    dirt_depth=0.6,
    streak_amplitude=0.16,
    gradient=0.6,
    flicker=0.02,
)
DARK = Scenario(
    name="dark",
    droplets=DropletTone.DARK,
    delta_density_kg_m3=30,
    drift_y_um_s=-2,
    background_levels=165,
    contrast_levels=140,
)
SCENARIOS: Mapping[str, Scenario] = {scenario.name: scenario for scenario in (EASY, DENSE, FAST, DARK, DIRTY)}


def named_scenario(name: str) -> Scenario:
    """One of `SCENARIOS`; an unknown name is an error that lists them."""
    if name not in SCENARIOS:
        problem = FieldProblem("scenario", f"there is no {name!r}; choose one of {', '.join(SCENARIOS)}")
        raise ParametersError("Please correct:", code="simulation.scenario", fields=[problem])
    return SCENARIOS[name]


def changed(scenario: Scenario, changes: Mapping[str, Any]) -> Scenario:
    """`scenario` with other constants; unknown names and impossible values are errors that name the field."""
    try:
        return Scenario.model_validate(scenario.model_dump() | dict(changes))
    except ValidationError as problem:
        fields = documents.field_problems(problem)
        raise ParametersError("Please correct:", code="simulation.constant", fields=fields) from None


def vary(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    """`scenario` with its optics, camera and density drawn anew around plausible values.

    What works for one opacity or point spread only is not finished: films for training and for tests are drawn with
    this, from generators of different seeds. Motion and material stay, they are what a scenario is about.
    """

    def around(value: float, factor: float) -> float:
        return float(value * np.exp(rng.uniform(-np.log(factor), np.log(factor))))

    return changed(
        scenario,
        {
            "n_droplets": around(scenario.n_droplets, 1.5),
            "radius_median_um": around(scenario.radius_median_um, 1.3),
            "radius_spread": float(rng.uniform(0.4, 0.7)),
            "opacity": float(rng.uniform(0.1, 0.95)),
            "opacity_depth_um": around(scenario.opacity_depth_um, 2.0),
            "sheet_sigma_um": around(scenario.sheet_sigma_um, 1.7),
            "point_spread_px": float(rng.uniform(0.7, 2.0)),
            "defocus_px_per_um": around(scenario.defocus_px_per_um, 1.6),
            "contrast_levels": around(scenario.contrast_levels, 1.3 if scenario.is_dark else 1.5),
            "background_levels": around(scenario.background_levels, 1.15 if scenario.is_dark else 2.0),
            "offset_levels": float(rng.uniform(0, 10)),
            "gradient": float(rng.uniform(-0.8, 0.8)),
            "flicker": around(scenario.flicker, 3.0),
            "streak_amplitude": around(scenario.streak_amplitude, 2.0),
            "streak_length_um": around(scenario.streak_length_um, 2.5),
            "n_dirt": around(scenario.n_dirt, 3.0),
            "dirt_depth": float(min(0.9, around(scenario.dirt_depth, 1.6))),
            "vignette": float(rng.uniform(0, 0.2)),
            "electrons_per_level": around(scenario.electrons_per_level, 2.5),
            "read_noise_levels": around(scenario.read_noise_levels, 2.5),
            "bit_depth": int(rng.choice([8, 8, 12, 16])),
        },
    )
