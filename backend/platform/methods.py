"""What can be done at an address, whichever of its calls the router met first."""

from typing import Any

from starlette.routing import compile_path


def allowed_methods(document: dict[str, Any], path: str) -> str:
    """The value of `Allow` for an address of the API; empty if it is none."""
    matching = [template for template in document["paths"] if compile_path(template)[0].match(path)]
    fewest = min((template.count("{") for template in matching), default=0)
    # `/uploads/plan` is a call of its own, and no upload of the id "plan".
    own = [template for template in matching if template.count("{") == fewest]
    return ", ".join(sorted({method.upper() for template in own for method in document["paths"][template]}))
