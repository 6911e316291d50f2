"""Accuracy and speed of detection beside its peers: `python -m benchmarks.detection`."""
