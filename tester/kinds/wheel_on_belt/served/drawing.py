"""The drawing of this machine for screens: the wheel on its belt, from the side. Lengths are in pixels of a screen."""

from __future__ import annotations

from typing import Final

from tester.base.screen import Anchor, Drawing, Shape

DRAWING: Final = Drawing(
    480.0,
    346.0,
    "A press pushes a rubber wheel from above onto a belt that runs over two pulleys. The load cell is between press "
    "and wheel, the heated hub in the wheel, the infrared thermometer beside it.",
    (
        Shape("box", (196.0, 4.0, 88.0, 22.0, 3.0)),
        Shape("line", (240.0, 26.0, 240.0, 46.0)),
        Shape("box", (208.0, 46.0, 64.0, 20.0, 3.0)),
        Shape("line", (218.0, 66.0, 218.0, 138.0)),
        Shape("line", (262.0, 66.0, 262.0, 138.0)),
        Shape("circle", (240.0, 152.0, 72.0), "rubber"),
        Shape("circle", (240.0, 152.0, 52.0), "shell"),
        Shape("circle", (240.0, 152.0, 5.0)),
        Shape("box", (110.0, 226.0, 260.0, 60.0, 30.0), "surface"),
        Shape("circle", (140.0, 256.0, 22.0)),
        Shape("circle", (340.0, 256.0, 22.0)),
        Shape("line", (184.0, 96.0, 166.0, 118.0, 160.0, 146.0, 153.0, 134.0), "arrow"),
        Shape("line", (160.0, 146.0, 168.0, 135.0), "arrow"),
        Shape("line", (216.0, 256.0, 272.0, 256.0, 262.0, 249.0), "arrow"),
        Shape("line", (272.0, 256.0, 262.0, 263.0), "arrow"),
        Shape("box", (344.0, 172.0, 22.0, 16.0, 2.0)),
        Shape("line", (344.0, 180.0, 314.0, 174.0), "arrow"),
    ),
    (
        Anchor("load", 292.0, 56.0),
        Anchor("press", 186.0, 30.0, "end"),
        Anchor("hub", 240.0, 136.0, "middle"),
        Anchor("surface", 476.0, 148.0, "end"),
        Anchor("wheel_speed", 144.0, 104.0, "end"),
        Anchor("friction", 144.0, 188.0, "end"),
        Anchor("sideslip", 476.0, 56.0, "end"),
        Anchor("slip", 476.0, 214.0, "end"),
        Anchor("belt_speed", 240.0, 318.0, "middle"),
    ),
)
