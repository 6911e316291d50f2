"""The HTTP service: one folder a noun, in it endpoints -> service -> repository -> models."""
