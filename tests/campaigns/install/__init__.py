"""What the README's commands take on a fresh copy. Run by ``python -m tests.campaigns.install``."""
