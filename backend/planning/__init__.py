"""Planning of experiments: materials, phase diagrams, temperature ramps."""
