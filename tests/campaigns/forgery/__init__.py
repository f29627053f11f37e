"""Forges a finished run in 15 ways and looks whether `tester verify` tells: ``python -m tests.campaigns.forgery``."""
