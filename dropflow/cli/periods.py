"""`dropflow periods`: periods of several experiments against their driving parameter."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dropflow.errors import ParametersError
from dropflow.statistics.oscillations import LATER_THEORY_EXPONENT, Signal

if TYPE_CHECKING:
    from dropflow.statistics.comparison import DrivenPeriods, LeftOut


def periods(
    results: Annotated[list[Path], typer.Argument(metavar="RESULTS...", help="Folders of analyses.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="HTML file to write the figure to.")] = Path(
        "periods.html"
    ),
    table: Annotated[Path | None, typer.Option("--table", help="CSV file for all periods.")] = None,
    xi: Annotated[
        list[float] | None, typer.Option("--xi", help="Driving parameter, 1/s: one for each folder, in their order.")
    ] = None,
    signal: Annotated[Signal, typer.Option("--signal", help="What to look for oscillations in.")] = Signal.N_DROPLETS,
) -> None:
    """Draw the periods of several experiments against xi, with the fitted exponent beside -3/7 (Fig. 15).

    The driving parameter is that of each experiment's temperature log and material, unless --xi gives it.

    Example: `dropflow periods slow/ middle/ fast/ --output periods.html`
    """
    if xi and len(xi) != len(results):
        raise ParametersError(f"Give --xi once for each folder: there are {len(results)}, and {len(xi)} values.")
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.figures.oscillations import periods_against_driving
    from dropflow.statistics.comparison import DrivenPeriods, LeftOut, law_of, table_of

    found = [_of(path, xi[i] if xi else None, signal) for i, path in enumerate(results)]
    used = [one for one in found if isinstance(one, DrivenPeriods)]
    for one in found:
        if isinstance(one, LeftOut):
            typer.echo(f"left out: {one.name}: {one.reason}", err=True)
    figure = periods_against_driving({one.name: (one.driving_per_s, one.period_s) for one in used}, law=law_of(used))
    output.parent.mkdir(parents=True, exist_ok=True)
    figure.write_html(output, include_plotlyjs=True)
    if table is not None:
        table_of(used).write_csv(table)
    law = law_of(used)
    typer.echo(
        f"{output}: {sum(len(one.period_s) for one in used)} periods of {len(used)} experiments, exponent "
        f"{law.exponent:.3f} ± {law.exponent_std:.3f} (later theory: {LATER_THEORY_EXPONENT:.3f})"
    )


def _of(path: Path, xi: float | None, signal: Signal) -> "DrivenPeriods | LeftOut":
    from dropflow.results import open_results
    from dropflow.statistics.comparison import driven_periods
    from dropflow.statistics.findings import Findings

    opened = open_results(path)
    findings = Findings(opened.facts, opened.condensed, signal=signal)
    return driven_periods(path.name or str(path), findings, driving_per_s=xi)
