"""Campaign: is a coefficient from both directions of slip free of what a session is off by?"""
