"""How a droplet is found, on a piece of a user's own frame (sections 3.1.2 and 3.1.3, Figs. 4 and 5, the match)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.detection.paper.circles import Circles
from dropflow.detection.paper.extended import extended_maxima
from dropflow.detection.paper.match import match as match_of
from dropflow.detection.paper.thresholding import find_by_threshold
from dropflow.detection.paper.watershed import BACKGROUND, droplet_markers, find_by_watershed, flood, gradient
from dropflow.figures.flow_field import circles
from dropflow.figures.layout import BLACK, BLUE, SEQUENTIAL, VERMILION, new_figure
from dropflow.parameters import PaperDetection

Image = npt.NDArray[np.float32]

_TWO_COLOURS = [[0.0, "#ffffff"], [0.5, "#ffffff"], [0.5, "#f5b7b1"], [1.0, "#f5b7b1"]]
_THREE_COLOURS = [
    [0.0, "#ffffff"],
    [0.33, "#ffffff"],
    [0.34, "#a9cce3"],
    [0.66, "#a9cce3"],
    [0.67, "#f5b7b1"],
    [1, "#f5b7b1"],
]


@dataclass(frozen=True)
class _Panel:
    """One of four pictures: values as a heat map, circles on it."""

    name: str
    values: npt.NDArray[Any]
    colours: Any = SEQUENTIAL
    found: Circles = field(default_factory=Circles.none)
    colour: str = BLACK


def thresholding(
    image: Image,
    level: float,
    *,
    r_min_px: float,
    r_max_px: float,
    title: str = "Detection by threshold and distance",
    caption: str = "",
) -> go.Figure:
    """Frame, thresholded frame, distance from the background, and droplets at its maxima (Fig. 4 a to d).

    Parameters
    ----------
    image
        Piece of a prepared frame, shape (rows, columns), levels 0 to 255.
    level
        Pixels darker than this are background.
    r_min_px, r_max_px
        Radii looked for.
    """
    is_droplet = (image >= level).astype(np.uint8)
    distance = cv2.distanceTransform(is_droplet, cv2.DIST_L2, cv2.DIST_MASK_5)
    found = find_by_threshold(image, level, r_min_px=r_min_px, r_max_px=r_max_px)
    return _four(
        [
            _Panel("a", image),
            _Panel("b", is_droplet, _TWO_COLOURS),
            _Panel("c", distance),
            _Panel("d", image, "Greys_r", found, VERMILION),
        ],
        title,
        f"(a) prepared frame, (b) brighter than {level:.3g}, (c) distance to the background, (d) droplets. {caption}",
    )


def watershed(
    image: Image,
    *,
    maxima_height: float,
    r_min_px: float,
    r_max_px: float,
    title: str = "Detection by watershed",
    caption: str = "",
) -> go.Figure:
    """Frame, markers of droplets and background, gradient with watershed lines, and droplets (Fig. 5 a to d)."""
    levels = np.rint(image).astype(np.uint8)
    height = max(1, round(maxima_height))
    maxima, n_maxima = extended_maxima(levels, height)
    markers = droplet_markers(levels, maxima, height)
    slope = gradient(image)
    drawn = slope.astype(np.float32)
    if n_maxima:
        regions = flood(slope, markers)
        drawn[_borders(regions)] = np.nan
    kinds = np.where(markers > BACKGROUND, 2, np.where(markers == BACKGROUND, 1, 0))
    found = find_by_watershed(image, maxima_height=maxima_height, r_min_px=r_min_px, r_max_px=r_max_px)
    return _four(
        [
            _Panel("a", image),
            _Panel("b", kinds, _THREE_COLOURS),
            _Panel("c", drawn),
            _Panel("d", image, "Greys_r", found, VERMILION),
        ],
        title,
        "(a) prepared frame, (b) markers of droplets (red) and background (blue), (c) gradient with watershed lines "
        f"(white), (d) droplets. {caption}",
    )


def match(
    image: Image,
    x_px: float,
    y_px: float,
    r_px: float,
    *,
    knobs: PaperDetection,
    title: str = "Match of a droplet",
    caption: str = "",
) -> go.Figure:
    """Disk and ring on the frame, and the match against radius, x and y around the droplet (eq. 3, section 3.1.3)."""
    scale = np.linspace(0.6, 1.5, 91)
    shift = np.linspace(-0.6, 0.6, 91)
    one = np.ones_like(scale)
    curves = [
        ("radius", scale * r_px, (x_px * one, y_px * one, scale * r_px)),
        ("x", x_px + shift * r_px, (x_px + shift * r_px, y_px * one, r_px * one)),
        ("y", y_px + shift * r_px, (x_px * one, y_px + shift * r_px, r_px * one)),
    ]
    disk = Circles(*(np.array([value]) for value in (x_px, y_px, r_px)))
    ring = Circles(disk.x_px, disk.y_px, disk.r_px + knobs.ring_width_px)
    figure = _four(
        [_Panel("a", image, "Greys_r", disk, VERMILION)],
        title,
        f"(a) disk (red) and ring (blue); match against (b) radius, (c) x and (d) y; dashed: the droplet. {caption}",
    )
    figure.add_trace(circles(ring.x_px, ring.y_px, ring.r_px, name="ring", colour=BLUE))
    for number, (name, at, places) in enumerate(curves, start=2):
        values = match_of(np.ascontiguousarray(image, np.float32), *map(np.ascontiguousarray, places), knobs=knobs)
        line = {"color": BLUE, "width": 1.5}
        figure.add_scatter(x=at, y=values, mode="lines", line=line, xaxis=f"x{number}", yaxis=f"y{number}")
        figure.update_layout({f"xaxis{number}": {"title": {"text": f"{name} (px)"}}})
        figure.update_layout({f"yaxis{number}": {"title": {"text": "match m"}}})
        here = {"radius": r_px, "x": x_px, "y": y_px}[name]
        figure.add_scatter(
            x=[here, here],
            y=[float(values[np.isfinite(values)].min(initial=0)), float(values.max())],
            mode="lines",
            line={"color": "#999", "dash": "dash"},
            xaxis=f"x{number}",
            yaxis=f"y{number}",
        )
    return figure


_PLACES = (
    ("x", "y", (0, 0.44), (0.56, 1)),
    ("x2", "y2", (0.56, 1), (0.56, 1)),
    ("x3", "y3", (0, 0.44), (0, 0.44)),
    ("x4", "y4", (0.56, 1), (0, 0.44)),
)


def _four(panels: Sequence[_Panel], title: str, caption: str) -> go.Figure:
    """A figure with four panels, a to d; pictures in pixels with y down, square."""
    figure = new_figure(title, caption, width_px=780, height_px=760)
    look_x, look_y = figure.layout.xaxis.to_plotly_json(), figure.layout.yaxis.to_plotly_json()
    for number, (x, y, across, down) in enumerate(_PLACES):
        suffix = x[1:]
        figure.update_layout(
            {
                f"xaxis{suffix}": {**look_x, "domain": across, "anchor": y},
                f"yaxis{suffix}": {**look_y, "domain": down, "anchor": x},
            }
        )
        figure.add_annotation(
            text=f"({'abcd'[number]})",
            x=across[0],
            y=down[1],
            xref="paper",
            yref="paper",
            xanchor="right",
            yanchor="bottom",
            showarrow=False,
        )
        if number < len(panels):
            _draw(figure, panels[number], x, y)
    return figure.update_layout(showlegend=False)


def _draw(figure: go.Figure, panel: _Panel, x: str, y: str) -> None:
    figure.add_heatmap(
        z=panel.values.astype(np.float32),
        colorscale=panel.colours,
        showscale=False,
        xaxis=x,
        yaxis=y,
        hoverinfo="x+y+z",
    )
    suffix = x[1:]
    rows, columns = panel.values.shape
    figure.update_layout(
        {
            f"yaxis{suffix}": {"range": [rows - 0.5, -0.5], "scaleanchor": x, "constrain": "domain"},
            f"xaxis{suffix}": {"range": [-0.5, columns - 0.5], "constrain": "domain"},
        }
    )
    if len(panel.found):
        drawn = circles(panel.found.x_px, panel.found.y_px, panel.found.r_px, name="droplets", colour=panel.colour)
        figure.add_trace(drawn.update(xaxis=x, yaxis=y, line={"width": 2}))


def _borders(regions: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
    """Pixels whose right or lower neighbour belongs to another region."""
    is_border = np.zeros(regions.shape, bool)
    is_border[:, :-1] |= regions[:, :-1] != regions[:, 1:]
    is_border[:-1] |= regions[:-1] != regions[1:]
    return is_border
