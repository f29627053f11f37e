"""Crashes: killed processes and power cuts, and the state of a run after them."""
