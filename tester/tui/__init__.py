"""The operator's screen: a client of the service that owns nothing. Closing it, or losing it, touches no run."""
