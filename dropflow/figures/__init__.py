"""One Plotly figure per figure of the paper, named after what it shows and fit to print."""

from dropflow.figures.flow_field import flow_field
from dropflow.figures.flow_moments import flow_moments
from dropflow.figures.layout import caption_of
from dropflow.figures.moments import moments
from dropflow.figures.size_distribution import size_distribution

__all__ = ["caption_of", "flow_field", "flow_moments", "moments", "size_distribution"]
