"""Speed, memory and accuracy: each module is a program; `python -m benchmarks --list` names them all."""
