"""What can be wrong about plans."""

from backend.platform.problems import NotFound
from dropflow.physics.material_files import known_names


class NoSuchMaterial(NotFound):
    """No material of this name comes with the software."""

    def __init__(self) -> None:
        super().__init__(
            "There is no material of this name.",
            code="not_found.material",
            hint=f"Known are {', '.join(known_names())}.",
        )
