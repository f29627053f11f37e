"""Outputs of a run: the paper's table, conditions, repeats, samples, and the manifest of its folder."""
