"""Does a run say so where friction changes at once, or sticks and slips, and is it silent where it does not?"""
