"""Spoiled frames on every wire: no detectably wrong value is accepted, and no exception is raised."""
