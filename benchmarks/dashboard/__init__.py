"""How quickly the page shows a run of 20,000 frames."""
