"""Dialogs: they leave lines 1, 2 and the last visible, and STOP works in every one of them."""
