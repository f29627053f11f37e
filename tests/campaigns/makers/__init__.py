"""Slaves built from makers' register tables, by another hand than the profiles', and our drivers beside them."""
