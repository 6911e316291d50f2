"""How heavy the page is: before the first plot, all of it together, whatever somebody opens."""

import gzip

from tests.services import ROOT

MOST_BYTES = 700_000
PLOTS = "plotly-"


def test_the_whole_page_is_light_before_the_first_plot() -> None:
    built = [*(ROOT / "frontend" / "dist" / "assets").iterdir(), ROOT / "frontend" / "dist" / "index.html"]
    plots = [path for path in built if path.name.startswith(PLOTS)]
    assert plots, "Plotly is a file of its own, which comes with the first plot"
    text = [path for path in built if path.suffix in (".js", ".css", ".html") and path not in plots]
    # Of the font a browser takes the parts whose letters it meets: here Latin, and one more.
    fonts = sorted((path.stat().st_size for path in built if path.suffix == ".woff2"), reverse=True)[:2]
    assert sum(len(gzip.compress(path.read_bytes())) for path in text) + sum(fonts) < MOST_BYTES
