"""Compounds and surfaces as files: read strictly, looked up by name, imported from instruments' files.

``material_schema`` defines the content of a file; ``compound`` and ``surface_file`` read one, with every problem and
every doubt at its line; ``dma`` and ``surface_scan`` read instruments' files; ``library`` finds a name, and alone turns
a file into the input of friction laws (``sim.physics.materials``).
"""
