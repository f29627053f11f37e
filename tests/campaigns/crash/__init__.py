"""Crashes: killed processes and power cuts, and what is left of a run after them."""
