"""Tracking by probability: predictions with their errors, one assignment a frame, the flow by regression."""

from dropflow.tracking.probable.chain import ProbableChain

__all__ = ["ProbableChain"]
