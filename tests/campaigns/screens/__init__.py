"""The operator's screen and the service behind it, measured and driven from outside, in real terminals."""
