"""Is what a belt loses found, apart from what wheels do?"""
