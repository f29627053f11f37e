"""Campaign: does an uncertainty have its stated coverage, and does a test fail when one of its terms is wrong."""
