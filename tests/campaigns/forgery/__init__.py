"""Forges a finished run in 15 ways and checks whether `tester verify` detects it: ``python -m
tests.campaigns.forgery``."""
