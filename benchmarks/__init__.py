"""Speed, memory and accuracy: each module is a program; `python -m benchmarks --list` names them all."""

import os

# One thread of linear algebra, as the command and the workers set it: threads that wait for each other would be counted
# as work. Read when NumPy is loaded, which is after this.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")
