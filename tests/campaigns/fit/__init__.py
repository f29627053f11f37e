"""Fits: does what was put in come back, do intervals hold it, and is a law refused that is not the fitted one?"""
