"""Is a belt's loss of grip found, separately from the wheels' wear?"""
