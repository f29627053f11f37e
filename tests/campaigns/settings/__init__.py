"""One setting that a recipe measures several times: does the run say rightly whether it has changed?"""
