"""Does a run report sudden changes of friction and stick-slip, and nothing where friction is steady?"""
