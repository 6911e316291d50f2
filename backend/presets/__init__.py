"""Parameters that a group keeps under a name."""
