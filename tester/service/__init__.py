"""The process that owns the rig, and what talks to it."""
