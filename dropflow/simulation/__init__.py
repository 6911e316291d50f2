"""Synthetic films with ground truth: `film` is what happens, `render` how it looks, `write` the folder."""
