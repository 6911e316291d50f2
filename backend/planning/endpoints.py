"""/materials: what is known of them, and the ramps that drive their separation."""

from typing import Annotated

from fastapi import APIRouter, Depends, Path, Query
from fastapi.responses import StreamingResponse

from backend.planning import service
from backend.planning.errors import NoSuchMaterial
from backend.planning.schemas import MaterialProperties, Materials, Ramp
from backend.planning.service import RampWish
from backend.platform.dependencies import ViewerDependency
from backend.platform.problems import InvalidRequest, responses
from backend.results.schemas import Figure
from dropflow.physics.ramp import LONGEST_S

router = APIRouter(prefix="/materials", tags=["planning"])

Name = Annotated[str, Path(max_length=100)]
Temperature = Annotated[float, Query(ge=-50, le=200)]


def _wish(
    start_c: Temperature = 25.8,
    end_c: Temperature = 50.0,
    driving_per_s: Annotated[float | None, Query(ge=1e-9, le=1, description="xi. Give this or the duration.")] = None,
    duration_s: Annotated[float | None, Query(ge=1, le=LONGEST_S, description="How long the ramp takes.")] = None,
    has_protocol: Annotated[bool, Query(description="Begin with an hour of mixing and four of equilibration.")] = False,
) -> RampWish:
    return RampWish(start_c, end_c, driving_per_s, duration_s, has_protocol)


Wish = Annotated[RampWish, Depends(_wish)]


@router.get("", responses=responses(InvalidRequest))
def materials_list(_: ViewerDependency) -> Materials:
    """List the materials that come with the software."""
    return service.materials()


@router.get("/{name}", responses=responses(NoSuchMaterial, InvalidRequest))
def materials_get(
    _: ViewerDependency, name: Name, temperature_c: Annotated[float | None, Query(ge=-50, le=200)] = None
) -> MaterialProperties:
    """Get every property of a material at a temperature, and how fast droplets move in it."""
    return service.properties(name, temperature_c)


@router.get("/{name}/phase_diagram", responses=responses(NoSuchMaterial, InvalidRequest))
def materials_get_phase_diagram(_: ViewerDependency, name: Name) -> Figure:
    """Get the phase diagram of a mixture, as Plotly draws it."""
    return Figure(**service.phase_diagram(name))


@router.get("/{name}/viscosity", responses=responses(NoSuchMaterial, InvalidRequest))
def materials_get_viscosity(_: ViewerDependency, name: Name) -> Figure:
    """Get the viscosities of a mixture against temperature, as Plotly draws them."""
    return Figure(**service.viscosity(name))


@router.get("/{name}/ramp", responses=responses(NoSuchMaterial, InvalidRequest))
def ramps_get(_: ViewerDependency, name: Name, wish: Wish) -> Ramp:
    """Compute the temperature ramp that keeps the driving parameter constant."""
    return service.ramp(name, wish)


@router.get(
    "/{name}/ramp.csv",
    response_class=StreamingResponse,
    responses={
        200: {"content": {"text/csv": {}}, "description": "Set points, one a second."},
        **responses(NoSuchMaterial, InvalidRequest),
    },
)
def ramps_download(_: ViewerDependency, name: Name, wish: Wish) -> StreamingResponse:
    """Download the set points of a ramp: `time_s`, `temperature_c` and `stage`, one row a second."""
    headers = {"Content-Disposition": f'attachment; filename="ramp-{name}.csv"'}
    return StreamingResponse(service.ramp_rows(name, wish), media_type="text/csv", headers=headers)
