"""Is the compiled scan the same program? Run by ``python -m tests.campaigns.compiled``."""
