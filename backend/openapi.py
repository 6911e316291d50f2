"""`python -m backend.openapi > frontend/openapi.json`: the document that the page's client is made from."""

import json
import sys

from backend.app import bare_app


def main() -> None:
    """Write the document, the same bytes for the same code."""
    sys.stdout.write(json.dumps(bare_app().openapi(), indent=1, sort_keys=True, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main()
