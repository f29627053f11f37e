"""How often the rule for repeats errs, measured; `python -m tests.campaigns.repeats`."""
