"""Fits: do they return the true parameters, do intervals contain these, and are wrong laws refused?"""
