"""`dropflow compile`: what is compiled at first use, compiled now."""

import os
import tempfile
from pathlib import Path

import typer

_KERNEL_FILES = "detection/default/__pycache__/*.nbi"


def compile() -> None:  # noqa: A001 - the command's name
    """Compile now what is otherwise compiled at first use, so that no first film waits a minute or two for it.

    It analyses a small simulated film by each method. What was compiled is kept beside the code, or in the folder that
    NUMBA_CACHE_DIR names, and used until the code or the processor changes.
    """
    import numpy as np

    from dropflow import analysis
    from dropflow.detection import make_detector
    from dropflow.detection.preview import preview
    from dropflow.experiment import load_experiment
    from dropflow.frames import Choice, open_frames
    from dropflow.parameters import Parameters, parse_parameters
    from dropflow.preprocess.stripes import Direction, Stripes, remove_stripes
    from dropflow.simulation.film import Film
    from dropflow.simulation.scenario import changed, named_scenario
    from dropflow.simulation.write import write_experiment
    from dropflow.suggest import suggest

    with tempfile.TemporaryDirectory(prefix="dropflow-compile-") as scratch:
        folder = Path(scratch)
        scenario = changed(named_scenario("easy"), {"height_px": 400, "width_px": 480})
        write_experiment(folder / "film", Film(scenario, 0), 6)
        experiment = load_experiment(folder / "film" / "experiment.yaml")
        for number, knobs in enumerate((Parameters(), parse_parameters({"detection": {"method": "paper"}}))):
            film = analysis.open_film(folder / "film" / "frames", experiment, knobs, beside=folder / "film")
            analysis.analyse(film, folder / f"results-{number}", n_processes=1)
            with open_frames(film.source, Choice.of(experiment)) as frames:
                preview(frames[0], make_detector(experiment, knobs, film.measured))
                suggest(frames, experiment)
    # The film has none.
    for direction in (Direction.ROWS, Direction.COLUMNS):
        remove_stripes(np.zeros((2048, 2048), np.float32), Stripes(direction, 1.0))
    typer.echo("Everything is compiled.")


def say_if_not_compiled() -> None:
    """Tell whoever waits why the first time takes longer."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    found = Path(folder).glob("**/*.nbi") if folder else Path(__file__).parents[1].glob(_KERNEL_FILES)
    if next(iter(found), None) is None:
        typer.echo("The first time, code is compiled for this processor: about a minute without progress.", err=True)
