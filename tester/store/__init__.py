"""One SQLite file per run: the plan, the journal and the measurements."""
