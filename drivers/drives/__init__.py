"""Drives as data: what a maker's drive has, in which units, and what stands in for what it lacks."""
