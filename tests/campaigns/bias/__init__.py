"""Campaign: is a coefficient from both directions of slip free of the session's errors?"""
