"""One SQLite file per run: everything that was asked, done and measured."""
