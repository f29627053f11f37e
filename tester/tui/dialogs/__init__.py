"""Dialogs. They leave lines 1, 2 and the last line visible, and STOP works in every dialog."""
