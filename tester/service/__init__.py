"""The process that owns the rig, and its clients."""
