"""What an analysis would do, seen before it is started."""
