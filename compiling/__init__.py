"""How the package is built: plain Python, or with the scan compiled (docs/decisions/0019). Not installed."""
