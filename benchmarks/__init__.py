"""Speed, memory and accuracy: each module is a program; `python -m benchmarks` runs those without arguments."""
