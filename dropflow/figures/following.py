"""How droplets are followed: displacement between two frames (Fig. 6), and one step of tracking (Figs. 7 and 8)."""

from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.flow_field import circles, flow_field
from dropflow.figures.images import as_image_layer
from dropflow.figures.layout import BLACK, BLUE, GREEN, VERMILION, new_figure, say_empty

Floats = npt.NDArray[np.floating[Any]]
Places = tuple[Floats, Floats, Floats]
"""x, y and r of droplets, px, each of shape (n,)."""


def displacement(
    velocity_um_s: Floats,
    is_interpolated: npt.NDArray[np.bool_],
    grid_x_px: Floats,
    grid_y_px: Floats,
    *,
    here_px: Places,
    next_px: Places,
    pixel_size_um: float,
    frame: int,
    image: npt.NDArray[Any] | None = None,
    title: str | None = None,
    caption: str = "",
) -> go.Figure:
    """Droplets of a frame (red), where they are in the next (green), and the flow (arrows), over the frame (Fig. 6)."""
    figure = flow_field(
        velocity_um_s,
        is_interpolated,
        grid_x_px,
        grid_y_px,
        pixel_size_um=pixel_size_um,
        frame=frame,
        droplets_px=here_px,
        image=image,
        title=title or f"Displacement, frames {frame} and {frame + 1}",
        caption=caption,
    )
    later = circles(*(values * pixel_size_um for values in next_px), name=f"droplets, frame {frame + 1}", colour=GREEN)
    return figure.add_trace(later)


class Direction(StrEnum):
    """Which way a step of tracking goes."""

    FORWARD = "forward"
    BACKWARD = "backward"


def tracking_step(
    trajectory_px: Places,
    number: int,
    *,
    velocity_um_s: tuple[float, float],
    sedimentation_um_s: tuple[float, float],
    interval_s: float,
    pixel_size_um: float,
    direction: Direction = Direction.FORWARD,
    image: npt.NDArray[Any] | None = None,
    title: str | None = None,
    caption: str = "",
) -> go.Figure:
    """Sedimentation and advection of a droplet, where they predict it, where it was found, and its trajectory.

    The four panels of Fig. 7 (forward) or Fig. 8 (backward) in one.

    Parameters
    ----------
    trajectory_px
        x, y and r of the droplet in its frames, in order.
    number
        Index into it of the droplet that is followed; the one found is its successor (or predecessor).
    velocity_um_s
        Flow at the droplet, along x and y of the image.
    sedimentation_um_s
        Its Stokes velocity, along x and y of the image.
    interval_s
        Time between the frames.
    image
        The frame in which it is looked for, as background.
    """
    x, y, r = (np.asarray(values) * pixel_size_um for values in trajectory_px)
    step = 1 if direction is Direction.FORWARD else -1
    figure = new_figure(title or f"{direction.capitalize()} tracking", caption, width_px=640, height_px=600)
    figure.update_xaxes(title_text="x (µm)")
    figure.update_yaxes(title_text="y (µm), down", autorange="reversed", scaleanchor="x")
    if not 0 <= number < len(x) or not 0 <= number + step < len(x):
        return say_empty(figure, f"the trajectory has no frame to go {direction} to")
    if image is not None:
        figure.add_layout_image(as_image_layer(image, pixel_size_um))
    sinking, advection = (step * interval_s * np.array(part) for part in (sedimentation_um_s, velocity_um_s))
    here = np.array([x[number], y[number]])
    middle, predicted = here + sinking, here + sinking + advection
    figure.add_scatter(x=x, y=y, mode="lines+markers", line={"color": BLACK}, marker={"size": 4}, name="trajectory")
    for start, end, colour, name in (
        (here, middle, BLUE, "sedimentation"),
        (middle, predicted, GREEN, "advection"),
    ):
        figure.add_scatter(
            x=[start[0], end[0]],
            y=[start[1], end[1]],
            mode="lines+markers",
            line={"color": colour, "width": 2},
            marker={"symbol": "arrow", "angleref": "previous", "size": [0, 10]},
            name=name,
        )
    for place, radius, dash, name in (
        (here, r[number], "dot", "droplet"),
        (predicted, r[number], "dash", "predicted"),
        (np.array([x[number + step], y[number + step]]), r[number + step], "solid", "found"),
    ):
        circle = circles(place[:1], place[1:], np.array([radius]), name=name, colour=VERMILION)
        figure.add_trace(circle.update(line={"dash": dash, "width": 2}))
    reach = 3 * float(r[number]) + float(np.abs(predicted - here).max())
    figure.update_xaxes(range=[here[0] - reach, here[0] + reach])
    return figure.update_yaxes(range=[here[1] + reach, here[1] - reach], autorange=False)
