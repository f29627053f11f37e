"""The drawing of this machine for screens: the arm on its track, from the side. Lengths are in pixels of a screen."""

from __future__ import annotations

from typing import Final

from tester.base.screen import Anchor, Drawing, Shape

DRAWING: Final = Drawing(
    480.0,
    340.0,
    "An arm with weights presses a rubber specimen onto a track that moves to and fro, inside a tempered chamber. The "
    "load cell at the arm's end measures the friction force.",
    (
        Shape("box", (10.0, 24.0, 460.0, 262.0, 8.0), "shell"),
        Shape("box", (60.0, 228.0, 360.0, 24.0, 2.0), "surface"),
        Shape("line", (40.0, 268.0, 440.0, 268.0)),
        Shape("circle", (110.0, 260.0, 8.0)),
        Shape("circle", (370.0, 260.0, 8.0)),
        Shape("box", (222.0, 200.0, 36.0, 28.0, 3.0), "rubber"),
        Shape("box", (212.0, 182.0, 56.0, 18.0, 2.0)),
        Shape("line", (240.0, 182.0, 240.0, 152.0)),
        Shape("box", (204.0, 100.0, 72.0, 16.0, 2.0)),
        Shape("box", (204.0, 118.0, 72.0, 16.0, 2.0)),
        Shape("box", (204.0, 136.0, 72.0, 16.0, 2.0)),
        Shape("line", (268.0, 191.0, 330.0, 191.0)),
        Shape("box", (330.0, 182.0, 40.0, 18.0, 3.0)),
        Shape("line", (370.0, 191.0, 430.0, 191.0, 430.0, 268.0)),
        Shape("line", (88.0, 240.0, 148.0, 240.0, 138.0, 233.0), "arrow"),
        Shape("line", (148.0, 240.0, 138.0, 247.0), "arrow"),
    ),
    (
        Anchor("load", 288.0, 122.0),
        Anchor("lift", 192.0, 122.0, "end"),
        Anchor("force", 350.0, 166.0, "middle"),
        Anchor("friction", 196.0, 206.0, "end"),
        Anchor("contact", 192.0, 166.0, "end"),
        Anchor("air", 26.0, 56.0),
        Anchor("chamber", 454.0, 56.0, "end"),
        Anchor("track", 240.0, 312.0, "middle"),
    ),
)
