"""Drives as data: the objects of each maker's drive, their units, and substitutes for missing objects."""
