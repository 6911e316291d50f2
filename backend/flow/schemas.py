"""Maps of the flow as the API shows them."""

from pydantic import BaseModel

Map = list[list[float | None]]


class FlowMap(BaseModel):
    """The flow over the field of view, at one step or averaged over a range; arrays are [row][column]."""

    first_frame: int
    last_frame: int
    """The last step goes from this frame to the next."""
    from_s: float
    to_s: float
    n_steps: int
    """Steps in the range."""
    n_used: int
    """Steps that were averaged: long ranges are sampled evenly."""
    grid_x_px: list[float]
    grid_y_px: list[float]
    u_um_s: Map
    v_um_s: Map
    """Along y, which points down."""
    speed_um_s: Map
    """Of the mean velocity."""
    rms_um_s: Map
    """Root of the mean squared speed; of one step the speed itself."""
    vorticity_per_s: Map
    """Positive anticlockwise as the frame is seen."""
    divergence_per_s: Map
    computed_share: Map
    """Share of the steps in which the cell was computed from droplets."""
