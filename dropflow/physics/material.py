"""From what an experiment says of its fluids to the numbers that Stokes' law needs."""

from dropflow.experiment import Experiment, FixedMaterial
from dropflow.physics.material_files import find_material


def resolve(experiment: Experiment) -> FixedMaterial:
    """Density difference (kg/m3, droplet minus fluid) and viscosity (Pa s) of an experiment.

    Fixed values pass through, a name is looked up among the material files.

    Raises
    ------
    ExperimentError
        Field ``material``: no material has this name. Nothing is ever assumed in its place.
    """
    if isinstance(experiment.material, FixedMaterial):
        return experiment.material
    fixed = find_material(experiment.material).fixed
    return FixedMaterial(delta_density_kg_m3=fixed.delta_density_kg_m3, viscosity_pa_s=fixed.viscosity_pa_s)
