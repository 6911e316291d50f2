"""Train the model of the `default` detection and store it in the package."""

import sys
from argparse import ArgumentParser
from pathlib import Path

from dropflow.detection.default.model import MODEL_FILE
from dropflow.detection.default.training.course import Syllabus, train


def main() -> None:
    """Read the arguments, train, store."""
    parser = ArgumentParser(prog="python -m dropflow.detection.default.training", description=__doc__)
    parser.add_argument("--films", type=int, default=Syllabus.films, help="scenes of simulated films")
    parser.add_argument("--backlit", type=int, default=Syllabus.backlit, help="scenes of bubbles lit from behind")
    parser.add_argument("--discs", type=int, default=Syllabus.discs, help="scenes of plain discs")
    parser.add_argument("--empty", type=int, default=Syllabus.empty, help="scenes without droplets")
    parser.add_argument("--output", type=Path, default=MODEL_FILE, help="where the model goes")
    given = parser.parse_args()
    syllabus = Syllabus(given.films, given.backlit, given.discs, given.empty)
    model = train(syllabus, lambda text: print(text, file=sys.stderr, flush=True))  # noqa: T201
    model.save(given.output)


if __name__ == "__main__":
    main()
