"""How well a run reports its progress: time left, the list of steps, finished conditions."""
