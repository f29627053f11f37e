"""Nonsense for every key of a rig file: is it refused, or does no harm follow from it?"""
