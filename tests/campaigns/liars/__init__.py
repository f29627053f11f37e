"""Temperature sensors that drift or read low, and honest heats: ``python -m tests.campaigns.liars``."""
