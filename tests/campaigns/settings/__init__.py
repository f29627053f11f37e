"""One setting that a recipe measures several times: does the run report correctly whether it has changed?"""
