"""/compare: runs beside each other."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse

from backend.comparisons import service
from backend.comparisons.schemas import (
    Comparison,
    ComparisonFigureName,
    ComparisonFigureQuery,
    ComparisonQuery,
)
from backend.platform import downloads
from backend.platform.dependencies import PlatformDependency, SessionDependency, ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results.schemas import Figure
from backend.runs.errors import NoSuchRun

router = APIRouter(prefix="/compare", tags=["comparison"])


@router.get("", responses=responses(NoSuchRun, InvalidRequest))
def comparison_get(
    session: SessionDependency, viewer: ViewerDependency, query: Annotated[ComparisonQuery, Query()]
) -> Comparison:
    """Compare runs: their numbers, in what their parameters and experiments differ, and which figures there are."""
    return service.comparison(service.askers(session, viewer, query.run))


@router.get("/figures/{name}", response_model=Figure, responses=responses(NoSuchRun, InvalidRequest))
def comparison_figures_get(
    platform: PlatformDependency,
    session: SessionDependency,
    viewer: ViewerDependency,
    name: ComparisonFigureName,
    query: Annotated[ComparisonFigureQuery, Query()],
) -> Response:
    """Get a figure of several runs as Plotly draws it; see `layout.meta.left_out` for those that have none."""
    drawn = service.figure(service.askers(session, viewer, query.run), platform.store, name, query)
    return Response(drawn, media_type="application/json")


@router.get(
    "/figures/{name}/table.csv",
    response_class=StreamingResponse,
    responses={
        200: {"content": {"text/csv": {}}, "description": "The table; its first line is a comment."},
        **responses(NoSuchRun, InvalidRequest),
    },
)
def comparison_figures_table(
    platform: PlatformDependency,
    session: SessionDependency,
    viewer: ViewerDependency,
    name: ComparisonFigureName,
    query: Annotated[ComparisonFigureQuery, Query()],
) -> StreamingResponse:
    """Download the numbers of a figure of several runs; the column `run` says of which each row is."""
    content = service.table(service.askers(session, viewer, query.run), platform.store, name, query)
    headers = {
        "Content-Disposition": downloads.content_disposition(f"compared_{name}.csv"),
        "X-Content-Type-Options": "nosniff",
    }
    return StreamingResponse(content, media_type="text/csv", headers=headers)
