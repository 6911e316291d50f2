"""Run the benchmarks that need no data from outside, one after the other: `python -m benchmarks [NAME ...]`."""

import runpy
import sys

BENCHMARKS = ("analyse", "lists", "upload")


def main() -> None:
    """Run those named, or all."""
    names = sys.argv[1:] or BENCHMARKS
    unknown = sorted(set(names) - set(BENCHMARKS))
    if unknown:
        sys.exit(f"There is no benchmark {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}.")
    for name in names:
        print(f"\n== {name}\n", flush=True)
        sys.argv = [name]
        runpy.run_module(f"benchmarks.{name}", run_name="__main__")


if __name__ == "__main__":
    main()
