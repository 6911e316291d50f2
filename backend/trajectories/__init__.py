"""Single droplets over time."""
