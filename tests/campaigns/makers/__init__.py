"""Slaves built from makers' register tables, independently of the profiles, and our drivers connected to them."""
