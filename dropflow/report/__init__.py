"""All figures and numbers of an analysis on one self-contained page."""
