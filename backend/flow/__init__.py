"""The flow field as maps."""
