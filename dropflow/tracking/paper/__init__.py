"""Tracking as the paper does it (sections 3.2 and 3.3)."""

from dropflow.tracking.paper.chain import PaperChain
from dropflow.tracking.paper.rules import PaperRules

__all__ = ["PaperChain", "PaperRules"]
