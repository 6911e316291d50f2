"""Every knob of an analysis, once: the form on the page, the API, the command line and the docs are made from here.

Each field says its unit, its meaning (the docstring below it), the paper's value and section, and a sensible range.
"""

from enum import StrEnum
from pathlib import Path
from typing import Any

from pydantic import Field, model_validator

from dropflow import documents
from dropflow.documents import FieldError, StrictModel
from dropflow.errors import ParametersError


def knob(default: Any, *, unit: str, low: float, high: float, paper: Any = None, section: str = "") -> Any:
    """A numeric field between `low` and `high` that carries its unit, the paper's value and where the paper says it."""
    about = {"unit": unit, "paper_value": paper, "paper_section": section}
    return Field(default=default, ge=low, le=high, json_schema_extra=about)


class Method(StrEnum):
    """How droplets are found."""

    DEFAULT = "default"
    PAPER = "paper"


class PaperDetection(StrictModel):
    """The constants of sections 3.1.1 to 3.1.3. Grey levels are those of the prepared frame, 0 to 255.

    Where `paper_value` is none the paper is silent, and the docstring says how the value was chosen.
    """

    high_pass_x: float = knob(5.0, unit="Fourier index", low=0.1, high=1e4, paper=5.0, section="3.1.1")
    """Gaussian width of the high pass along x: with `high_pass_y`, removes what is long in x and of any height."""
    high_pass_y: float = knob(200.0, unit="Fourier index", low=0.1, high=1e4, paper=200.0, section="3.1.1")
    """Gaussian width of the high pass along y."""
    low_pass: float = knob(100.0, unit="Fourier index", low=1.0, high=1e5, paper=100.0, section="3.1.1")
    """Gaussian width of the low pass along both axes: a blur by side / (2 pi 100) px."""
    high_pass_radii: float = knob(1.2, unit="radii", low=0.0, high=100.0, section="3.1.1")
    """The high pass is at least this many largest radii wide along x, as it is for the paper's frames and radii: in a
    smaller frame index 5 alone would hollow out large droplets."""
    low_pass_radii: float = knob(0.61, unit="radii", low=0.01, high=100.0, section="3.1.1")
    """The low pass blurs by at most this many smallest radii, as it does for the paper's frames and radii: in a larger
    frame index 100 alone would wash out small droplets."""
    contrast_low_percent: float = knob(1.0, unit="%", low=0.0, high=50.0, section="3.1.1")
    """Percentile of the filtered frame that becomes level 0."""
    contrast_high_percent: float = knob(99.7, unit="%", low=50.0, high=100.0, section="3.1.1")
    """Percentile of the filtered frame that becomes level 255."""
    contrast_droplet_percent: float = knob(90.0, unit="%", low=0.0, high=100.0, section="3.1.1")
    """Level 255 is at least this percentile of what stands out of the noise: decides only where droplets cover less
    than some 3 % of the frame, for the paper's frames are full of them."""
    contrast_noise: float = knob(15.0, unit="1", low=0.0, high=1e3, section="3.1.1")
    """Level 255 is at least this many standard deviations of the noise above level 0: decides only where there is
    hardly anything but noise."""
    threshold_small: float = knob(0.2, unit="1", low=0.0, high=1.0, section="3.1.2")
    """Threshold for small, faint droplets: this part of the way from the background's level to 255."""
    threshold_big: float = knob(0.5, unit="1", low=0.0, high=1.0, section="3.1.2")
    """Threshold for big droplets (parts overlapping ones): this part of the way from the background's level to 255."""
    maxima_height: float = knob(10.0, unit="levels", low=0.5, high=255.0, section="3.1.2")
    """Extended maxima and minima of the watershed strategy are at least this high or deep (see also `noise_margin`)."""
    noise_margin: float = knob(6.0, unit="1", low=0.0, high=20.0, section="3.1.2")
    """Whatever stands out, does so by at least this many standard deviations of the noise: a threshold above the
    background, a maximum above its surroundings."""
    duplicate_distance: float = knob(1.0, unit="radii", low=0.0, high=5.0, paper=1.0, section="3.1.2")
    """Two detections nearer than this many radii (of the smaller one) may be one droplet."""
    similar_ratio_min: float = knob(0.7, unit="1", low=0.1, high=1.0, paper=0.7, section="3.1.2")
    """Radii with a ratio above this are similar: duplicates, and a search that has not left its prediction."""
    similar_ratio_max: float = knob(1.4, unit="1", low=1.0, high=10.0, paper=1.4, section="3.1.2")
    """Radii with a ratio below this are similar."""
    ring_width_px: float = knob(3.0, unit="px", low=1.0, high=50.0, paper=3.0, section="3.1.3")
    """Width of the ring around the droplet, whose mean is I_ring in eq. 3."""
    match_offset: float = knob(30.0, unit="px^match_exponent", low=0.0, high=1e4, paper=30.0, section="3.1.3")
    """The 30 of A(r) = 1 / (30 + r^1.3) in eq. 3."""
    match_exponent: float = knob(1.3, unit="1", low=0.0, high=4.0, paper=1.3, section="3.1.3")
    """The 1.3 of A(r) = 1 / (30 + r^1.3) in eq. 3."""
    match_asymmetry: float = knob(3.0, unit="1", low=0.0, high=1e3, paper=3.0, section="3.1.3")
    """The prefactor B of eq. 3, against small circles at the edge of big droplets."""
    minimum_match: float = knob(0.08, unit="levels/px^match_exponent", low=0.0, high=10.0, paper=0.08, section="3.1.3")
    """A droplet's match is bigger than this."""
    search_walk: float = knob(1.0, unit="radii", low=0.1, high=5.0, section="3.3.1")
    """A droplet looked for at a predicted place is it when found within this many predicted radii."""

    @model_validator(mode="after")
    def _thresholds_in_order(self) -> "PaperDetection":
        if self.threshold_small > self.threshold_big:
            raise ValueError("threshold_small must not be larger than threshold_big")
        return self


class DetectionParameters(StrictModel):
    """How droplets are found in one frame."""

    method: Method = Method.DEFAULT
    """`default` fits circles to edges and accepts what a trained model takes for droplets: nothing but the radius range
    need be given. `paper` follows sections 3.1.1 to 3.1.3."""
    radius_min_um: float = knob(4.0, unit="um", low=1e-3, high=1e5, paper=4.0, section="3.2.1")
    """Smallest droplet radius looked for. A droplet measured smaller by no more than its uncertainty is kept."""
    radius_max_um: float = knob(40.0, unit="um", low=1e-3, high=1e5, paper=40.0, section="3.2.1")
    """Largest droplet radius looked for, with the same allowance."""
    paper: PaperDetection = PaperDetection()
    """The constants of the method `paper`."""

    @model_validator(mode="after")
    def _radii_in_order(self) -> "DetectionParameters":
        if self.radius_min_um >= self.radius_max_um:
            raise FieldError("radius_min_um", "must be smaller than radius_max_um")
        return self


class TrackingMethod(StrEnum):
    """Whose chain follows droplets and computes the flow."""

    DEFAULT = "default"
    PAPER = "paper"


class PaperTracking(StrictModel):
    """The constants of sections 3.2.1 and 3.3. Where `paper_value` is none the paper is silent."""

    similar_ratio_min: float = knob(0.7, unit="1", low=0.1, high=1.0, paper=0.7, section="3.1.2, 3.2.1")
    """A droplet and its image in the next frame have radii with a ratio above this (the paper's "similar radii")."""
    similar_ratio_max: float = knob(1.4, unit="1", low=1.0, high=10.0, paper=1.4, section="3.1.2, 3.2.1")
    """A droplet and its image in the next frame have radii with a ratio below this."""
    reach_spacings: float = knob(0.5, unit="mean droplet spacings", low=0.01, high=5.0, section="3.2.1")
    """A droplet is looked for up to this far from its predicted place (or one radius, if that is more). Half of the
    mean spacing sqrt(frame area / droplets) is where another droplet becomes as likely as the right one."""
    stationary_fraction: float = knob(0.5, unit="1", low=0.0, high=1.0, paper=0.5, section="3.3.3")
    """Trajectories that moved less than this part of what flow and sedimentation predict for their place, size and
    time are taken for dirt."""

    @model_validator(mode="after")
    def _ratios_in_order(self) -> "PaperTracking":
        if self.similar_ratio_min >= self.similar_ratio_max:
            raise ValueError("similar_ratio_min must be smaller than similar_ratio_max")
        return self


class TrackingParameters(StrictModel):
    """How droplets are followed from frame to frame (sections 3.2.1 and 3.3)."""

    method: TrackingMethod = TrackingMethod.DEFAULT
    """`default` weighs all pairs of a frame by the errors of prediction and detection and computes the flow by
    regression; `paper` follows sections 3.2 and 3.3."""
    shortest_trajectory_frames: int = knob(3, unit="frames", low=1, high=1000, paper=3, section="3.3.3")
    """Trajectories of fewer frames are removed. The method `default` makes one exception where this is 3 or less: two
    frames will do where chance is out of the question."""
    count_out_of_focus: bool = False
    """Count droplets that are out of focus in the size distribution as well. They are followed and stay in the table of
    trajectories either way; a droplet is out of focus where its match is less than half of that of the sharp ones."""
    paper: PaperTracking = PaperTracking()
    """The constants of the method `paper`."""


class Divergence(StrEnum):
    """Whether the flow in the plane of the image may have sources and sinks, as where fluid rises out of it."""

    ESTIMATED = "estimated"
    NEVER = "never"
    ALWAYS = "always"


class PaperFlow(StrictModel):
    """The constants of sections 3.2.2 and 3.2.3."""

    neighbour_weight: float = knob(0.5, unit="1", low=0.0, high=1.0, paper=0.5, section="3.2.2")
    """Weight of a droplet in the averages of the four cells beside its own."""
    n_smoothings: int = knob(1, unit="times", low=0, high=20, paper=1, section="3.2.3")
    """How often the grid is smoothed with weights 1/4 (itself), 1/8 (beside it), 1/16 (diagonal)."""


class FlowParameters(StrictModel):
    """How the flow field is computed from droplets (sections 3.2.2 and 3.2.3)."""

    n_columns: int = knob(25, unit="cells", low=2, high=1000, paper=25, section="3.2.2")
    """Cells of the grid along x."""
    n_rows: int = knob(20, unit="cells", low=2, high=1000, paper=20, section="3.2.2")
    """Cells of the grid along y."""
    divergence: Divergence = Divergence.ESTIMATED
    """Method `default`: `estimated` looks in the first frames for a part of the flow that has a divergence in the plane
    and leaves it out where there is none; `never` leaves it out; `always` keeps it, at up to eight times the work."""
    paper: PaperFlow = PaperFlow()
    """The constants of the paper's average over cells (tracking method `paper`)."""


class Parameters(StrictModel):
    """All knobs of one run."""

    detection: DetectionParameters = DetectionParameters()
    """Finding droplets in single frames."""
    tracking: TrackingParameters = TrackingParameters()
    """Following droplets through frames."""
    flow: FlowParameters = FlowParameters()
    """The flow field between frames."""


def parse_parameters(content: Any, *, file: str | None = None) -> Parameters:
    """Validate a document that was read from YAML or JSON; raise `ParametersError` naming each wrong field."""
    return documents.parse(Parameters, content, ParametersError, file=file)


def load_parameters(path: Path) -> Parameters:
    """Read a parameters file (YAML or JSON)."""
    return documents.load(Parameters, path, ParametersError)
