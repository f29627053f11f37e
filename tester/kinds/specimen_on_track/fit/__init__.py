"""Measured conditions of a specimen on a track, for laws and master curves."""
