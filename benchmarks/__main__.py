"""`python -m benchmarks --list` names all benchmarks, `python -m benchmarks NAME ARGUMENT...` runs one of them.

Without a name those run that need no data from outside and end within minutes.
"""

import ast
import runpy
import sys
from pathlib import Path

USUAL = ("analyse", "lists", "upload", "statistics_speed")
"""What runs without a name."""


def programs() -> dict[str, str]:
    """First line of what each program says of itself, by its name."""
    folder = Path(__file__).parent
    found = {}
    for path in sorted([*folder.rglob("*.py")]):
        name = ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix("__main__").rstrip(".")
        content = path.read_text(encoding="utf-8")
        if name and 'if __name__ == "__main__"' in content:
            found[name] = (ast.get_docstring(ast.parse(content)) or "").partition("\n")[0]
    return found


def run(name: str, arguments: list[str]) -> None:
    """Run a program as if it had been called by itself."""
    print(f"\n== {name}\n", flush=True)
    sys.argv = [name, *arguments]
    runpy.run_module(f"benchmarks.{name}", run_name="__main__")


def main() -> None:
    """List, run one, or run the usual ones."""
    known, words = programs(), sys.argv[1:]
    if words == ["--list"]:
        print("\n".join(f"{name:<20} {about}" for name, about in known.items()))
    elif words and words[0] not in known:
        sys.exit(f"There is no benchmark {words[0]}; there are {', '.join(known)}.")
    elif words:
        run(words[0], words[1:])
    else:
        for name in USUAL:
            run(name, [])


if __name__ == "__main__":
    main()
