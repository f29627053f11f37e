"""The operator's screen: a client of the service. It owns no part of the rig, so its end does not affect a run."""
