"""The operator's screen: a client of the service that owns nothing. Closing or losing it does not affect a run."""
