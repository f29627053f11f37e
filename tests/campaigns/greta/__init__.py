"""The recipe `greta` whole: shares against what was put in, trends against what the paper states."""
