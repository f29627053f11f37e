"""Notices to people who are not at the machine: by mail, ntfy, Apprise or a command, from an outbox on disk."""
