"""How well a run knows where it is: time left, the list of steps, finished conditions."""
