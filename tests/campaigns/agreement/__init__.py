"""Whether a run's outputs agree on every number, flag and count; `python -m tests.campaigns.agreement`."""
