"""Widgets of the screens: each shows a part of the scene, and is redrawn when the scene changes."""
