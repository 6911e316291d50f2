"""Accuracy and speed of tracking and of the flow, beside trackpy, laptrack and the paper's mode."""
