"""The recipe `greta` whole: shares against the truth, trends against the paper's statements."""
