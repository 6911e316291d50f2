"""The flow field between two frames as arrows, over the frame and its droplets (Fig. 6)."""

from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.figures.images import as_image_layer
from dropflow.figures.layout import ORANGE, SKY, VERMILION, new_figure, say_empty

Floats = npt.NDArray[np.floating[Any]]


def flow_field(
    velocity_um_s: Floats,
    is_interpolated: npt.NDArray[np.bool_],
    grid_x_px: Floats,
    grid_y_px: Floats,
    *,
    pixel_size_um: float,
    frame: int,
    droplets_px: tuple[Floats, Floats, Floats] | None = None,
    image: npt.NDArray[Any] | None = None,
    title: str | None = None,
    caption: str = "",
) -> go.Figure:
    """Arrows of one flow field; cells that no droplet gave are drawn apart.

    Parameters
    ----------
    velocity_um_s
        Shape (2, n_rows, n_columns): along x, along y (down).
    is_interpolated
        Shape (n_rows, n_columns).
    grid_x_px, grid_y_px
        Centres of the cells, shapes (n_columns,) and (n_rows,).
    pixel_size_um, frame
        Edge of a pixel in the sample; the flow is the one between this frame and the next.
    droplets_px
        x, y and r of droplets to draw as circles, each of shape (n,).
    image
        The frame itself, shape (rows, columns), as background.
    """
    figure = new_figure(title or f"Flow field, frame {frame}", caption)
    figure.update_xaxes(title_text="x (µm)")
    figure.update_yaxes(title_text="y (µm), down", autorange="reversed", scaleanchor="x", scaleratio=1)
    figure.update_layout(legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"})
    if image is not None:
        figure.add_layout_image(as_image_layer(image, pixel_size_um))
    _fit_axes(figure, grid_x_px * pixel_size_um, grid_y_px * pixel_size_um, image, pixel_size_um)
    if droplets_px is not None:
        figure.add_trace(
            circles(
                *(values * pixel_size_um for values in droplets_px), name=f"droplets, frame {frame}", colour=VERMILION
            )
        )
    speed_um_s = np.hypot(*velocity_um_s)
    is_known = np.isfinite(speed_um_s)
    if not is_known.any():
        return say_empty(figure, "no flow: no droplet was followed here")
    x_um, y_um = np.meshgrid(grid_x_px * pixel_size_um, grid_y_px * pixel_size_um)
    um_per_speed = _arrow_scale(grid_x_px, pixel_size_um, speed_um_s[is_known])
    for name, which, colour, is_faint in (
        ("flow, interpolated", is_known & is_interpolated, ORANGE, True),
        ("flow, from droplets", is_known & ~is_interpolated, SKY, False),
    ):
        arrows = _arrows(x_um, y_um, velocity_um_s, which, um_per_speed, name=name, colour=colour)
        figure.add_trace(arrows.update(opacity=0.55 if is_faint else 1))
    return figure


def circles(x: Floats, y: Floats, r: Floats, *, name: str, colour: str, n_corners: int = 24) -> go.Scatter:
    """Circles as one line trace, broken between circles: shapes would be slow past a hundred."""
    angle = np.append(np.linspace(0, 2 * np.pi, n_corners + 1), np.nan)
    return go.Scatter(
        x=(x[:, None] + r[:, None] * np.cos(angle)).ravel().astype(np.float32),
        y=(y[:, None] + r[:, None] * np.sin(angle)).ravel().astype(np.float32),
        mode="lines",
        line={"color": colour, "width": 1.5},
        name=name,
        hoverinfo="skip",
    )


def _fit_axes(
    figure: go.Figure, x_um: Floats, y_um: Floats, image: npt.NDArray[Any] | None, pixel_size_um: float
) -> None:
    if image is None:
        half_x, half_y = (float(np.diff(axis).mean()) / 2 if len(axis) > 1 else 1.0 for axis in (x_um, y_um))
        left, right = float(x_um[0]) - half_x, float(x_um[-1]) + half_x
        top, bottom = float(y_um[0]) - half_y, float(y_um[-1]) + half_y
    else:
        left = top = -pixel_size_um / 2
        bottom, right = (float(length) * pixel_size_um - pixel_size_um / 2 for length in image.shape[:2])
    figure.update_xaxes(range=[left, right], constrain="domain")
    figure.update_yaxes(range=[bottom, top], autorange=False, constrain="domain")


def _arrow_scale(grid_x_px: Floats, pixel_size_um: float, speed_um_s: Floats) -> float:
    """Micrometres of arrow per um/s: a fast arrow (95th percentile) is one and a half cells long."""
    cell_um = float(np.diff(grid_x_px).mean() if len(grid_x_px) > 1 else 50.0) * pixel_size_um
    fast = float(np.percentile(speed_um_s, 95))
    return 1.5 * cell_um / fast if fast > 0 else 1.0


def _arrows(
    x_um: Floats,
    y_um: Floats,
    velocity_um_s: Floats,
    which: npt.NDArray[np.bool_],
    um_per_speed: float,
    *,
    name: str,
    colour: str,
) -> go.Quiver:
    u, v = velocity_um_s[0][which], velocity_um_s[1][which]
    return go.Quiver(
        x=x_um[which].astype(np.float32),
        y=y_um[which].astype(np.float32),
        u=(u * um_per_speed).astype(np.float32),
        v=(v * um_per_speed).astype(np.float32),
        lengthmode="raw",
        anchor="tail",
        customdata=np.stack([u, v], axis=1).astype(np.float32),
        hovertemplate="u %{customdata[0]:.3g} µm/s<br>v %{customdata[1]:.3g} µm/s<extra>" + name + "</extra>",
        marker={"color": colour, "line": {"width": 1.3}, "arrowsize": 0.8},
        name=name,
        showlegend=True,
    )
