"""Nonsense for every key of a rig file: is it refused, or harmless?"""
