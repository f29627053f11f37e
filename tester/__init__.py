"""Control and automation software for a multi-working-condition rubber friction tester."""

__version__ = "0.1.0"
