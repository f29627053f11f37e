"""Fitting friction laws of a wheel on a belt: the paper's form, a better form, and the paper's own data."""
