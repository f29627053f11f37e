"""Spoiled frames on every wire: no value that a receiver could tell from a right one, and no exception."""
