"""Compounds and surfaces as files: read strictly, looked up by name, imported from what instruments write.

``schema`` says what a file may hold; ``compound`` and ``surface`` read one, with every problem and every doubt at its
line; ``dma`` and ``scan`` read what instruments write; ``library`` finds a name, and alone makes of a file what laws of
friction are told (``sim.physics.materials``).
"""
