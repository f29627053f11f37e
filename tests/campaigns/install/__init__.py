"""Time and CPU of the README's commands on a fresh copy. Run by ``python -m tests.campaigns.install``."""
