"""One row of a table: the scores of one linker on one film."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from scipy.interpolate import RegularGridInterpolator

from benchmarks.tracking import peers
from benchmarks.tracking.given import Given
from dropflow.frames import Frames
from dropflow.parameters import Parameters, parse_parameters
from dropflow.progress import silent
from dropflow.scoring import (
    FlowScore,
    IsbiScore,
    LinkScore,
    SizeScore,
    read_flow,
    score_flow,
    score_isbi,
    score_links,
    score_size_distribution,
)
from dropflow.scoring.report import counted_of
from dropflow.simulation.truth import Visibility
from dropflow.tracking.film import Film
from dropflow.tracking.track import track_film

HEAD = (
    f"{'film':<22} {'linker':<26} {'links':>13} {'flow':>6} {'alpha':>6} {'beta':>6} {'JSC':>6} {'JSCth':>6} "
    f"{'RMSE':>6} {'L1 before':>9} {'after':>6}"
)
DEFAULT = Parameters()
PAPER = parse_parameters({"tracking": {"method": "paper"}})


@dataclass(frozen=True)
class Scores:
    """Of one linker on one film."""

    links: LinkScore
    isbi: IsbiScore
    flow: FlowScore | None
    before: SizeScore
    after: SizeScore

    @property
    def f1(self) -> float:
        """Of the links."""
        precision, recall = self.links.precision or 0.0, self.links.recall or 0.0
        return 2 * precision * recall / max(precision + recall, 1e-9)

    def row(self, film: str, linker: str) -> str:
        """As a line under `HEAD`."""
        flow = _number(self.flow.error_over_rms if self.flow else None)
        isbi = " ".join(
            _number(value, 6)
            for value in (self.isbi.alpha, self.isbi.beta, self.isbi.jsc, self.isbi.jsc_theta, self.isbi.rmse_px)
        )
        links = f"{_number(self.links.precision)} /{_number(self.links.recall)}"
        before, after = _number(self.before.l1, 9), _number(self.after.l1)
        return f"{film:<22} {linker:<26} {links} {flow} {isbi} {before} {after}"


def _number(value: float | None, width: int = 6) -> str:
    return f"{value:>{width}.3f}" if value is not None else f"{'-':>{width}}"


def score(given: Given, trajectories: pa.Table, results: Path | None = None) -> Scores:
    """All scores of a table of trajectories; from the folder of Dropflow's `results` also of flow and counts."""
    matching = given.matched(trajectories)
    flow = results / "flow.zarr" if results else None
    counted = given.matched(counted_of(results, given.truth)) if results else matching
    true_flow = given.film / "truth_flow.zarr"
    return Scores(
        score_links(matching, given.products),
        score_isbi(matching),
        score_flow(read_flow(flow), read_flow(true_flow)) if flow and true_flow.exists() else None,
        score_size_distribution(given.matched(given.table())),
        score_size_distribution(counted),
    )


def dropflow_scores(
    given: Given, parameters: Parameters, folder: Path, *, frames: Frames | None = None, detector: object = None
) -> Scores:
    """Of Dropflow's own tracking; with images where they are given."""
    film = Film(given.times_s, lambda frame: given.droplets[frame], frames, detector)  # type: ignore[arg-type]
    result = track_film(film, given.shape, given.experiment, parameters, folder, {}, silent)
    return score(given, pq.read_table(result.trajectories), folder)


def error_at_droplets(given: Given, results: Path) -> float:
    """Error of the flow over its rms where visible droplets are, whose fluid velocity is known exactly."""
    steps = read_flow(results / "flow.zarr")
    truth = given.truth.filter(pc.field("visibility") == str(Visibility.VISIBLE))
    frame, x, y, u, v = (truth[name].to_numpy() for name in ("frame", "x_px", "y_px", "flow_u_um_s", "flow_v_um_s"))
    interpolate = RegularGridInterpolator(
        (np.arange(len(steps.velocity_um_s)), steps.grid_y_px, steps.grid_x_px),
        np.moveaxis(steps.velocity_um_s, 1, -1),
        bounds_error=False,
        fill_value=None,
    )
    is_step = frame < len(steps.velocity_um_s)
    found = interpolate(np.column_stack([frame, y, x])[is_step])
    true = np.column_stack([u, v])[is_step]
    return float(np.sqrt(np.square(found - true).mean() / np.square(true).mean()))


def error_of_velocities(given: Given, results: Path) -> float:
    """Error over rms of the fluid's velocity that each droplet itself shows: its own, less its sedimentation."""
    found = pq.read_table(results / "trajectories.parquet")
    matching = given.matched(found)
    is_matched = (matching.truth_row >= 0) & np.isfinite(found["u_um_s"].to_numpy())
    truth = matching.truth.take(pa.array(matching.truth_row[is_matched]))
    own = np.stack([found[name].to_numpy()[is_matched] for name in ("u_um_s", "v_um_s")])
    sunk = np.outer(given.experiment.up, found["sedimentation_um_s"].to_numpy()[is_matched])
    true = np.stack([truth[name].to_numpy() for name in ("flow_u_um_s", "flow_v_um_s")])
    return float(np.sqrt(np.square(own - sunk - true).mean() / np.square(true).mean()))


def peer_scores(given: Given, link: peers.Linker) -> tuple[str, Scores] | None:
    """With the search range that is best by the truth, and that range; None if it can do none."""
    best: tuple[str, Scores] | None = None
    for share, table in peers.tables_of(given, link):
        scores = score(given, table)
        if best is None or scores.f1 > best[1].f1:
            best = (f"{share:g} spacings", scores)
    return best


def print_all(given: Given, name: str, folder: Path) -> None:
    """Rows of both methods without images, and of the peers."""
    print(dropflow_scores(given, DEFAULT, folder / "default").row(name, "dropflow"), flush=True)
    print(dropflow_scores(given, PAPER, folder / "paper").row(name, "paper's mode"), flush=True)
    print_peers(given, name)


def print_peers(given: Given, name: str) -> None:
    """Rows of the peers."""
    for label, link in (("trackpy", peers.trackpy_velocity), ("laptrack", peers.laptrack_nearest)):
        best = peer_scores(given, link)
        if best is None:
            print(f"{name:<22} {label:<26} gives up or stalls with every search range", flush=True)
        else:
            print(best[1].row(name, f"{label}, {best[0]}"), flush=True)
