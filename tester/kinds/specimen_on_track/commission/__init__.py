"""Commissioning of a specimen on a track: its steps as data (``commission_steps``), a module for each procedure."""
