"""How well a run did."""
