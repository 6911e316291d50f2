"""What can be done at an address, whichever of its calls the router met first."""

from typing import Any

from starlette.routing import compile_path


def allowed_methods(document: dict[str, Any], path: str) -> str:
    """The value of `Allow` for an address of the API; empty if it is none."""
    methods: set[str] = set()
    for template, operations in document["paths"].items():
        if compile_path(template)[0].match(path):
            methods |= {method.upper() for method in operations}
    return ", ".join(sorted(methods))
