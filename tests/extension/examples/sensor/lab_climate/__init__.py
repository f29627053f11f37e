"""Profiles of the sensors of a laboratory, each a TOML file of this package."""
