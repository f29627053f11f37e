"""Dialogs: they leave lines 1, 2 and the last alone, and STOP works in every one of them."""
