"""The recipes of the figures, besides the packaged ones."""

from __future__ import annotations

import recipes

_HEAD = """\
recipe: {name}
specimens: [{specimens}]
pre_grind: {{wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}}
rest: {{at_least: 20 min, until: 25 degC, within: 2 degC}}
measure:
  wheel_speed: 0.8 m/s
  repeats: {repeats}
  window: 30 rev
  temperature_band: 2 degC
  soak: {{within: 1 degC, for: 60 s}}
grids:
"""


def recipe(name: str, compounds: tuple[str, ...], grids: str, repeats: int = 3) -> str:
    """Return a recipe's text: the quickstart's procedure with other compounds and grids."""
    specimens = ", ".join(f'{{compound: "{compound}"}}' for compound in compounds)
    return _HEAD.format(name=name, specimens=specimens, repeats=repeats) + grids


LOADS = recipe(
    "loads, compounds, two temperatures",
    ("1#", "2#", "3#"),
    """\
  - name: load
    slip_velocity: 300 mm/s
    load: [100 N, 200 N, 300 N, 400 N]
    temperature: [40 degC, 55 degC]
""",
)
"""Every load and compound at 40 and 55 degC: 24 conditions."""

FOUR = recipe(
    "four conditions",
    ("1#",),
    """\
  - name: load and temperature
    slip_velocity: 300 mm/s
    load: [200 N, 400 N]
    temperature: [25 degC, 55 degC]
""",
)

STICKY = recipe(
    "much friction",
    ("3#",),
    """\
  - name: slip
    slip_velocity: [100 mm/s, 300 mm/s]
    load: [200 N, 300 N]
    temperature: 55 degC
""",
    repeats=5,
)

ANGLES = recipe(
    "angles",
    ("2#",),
    """\
  - name: sideslip
    slip_velocity: 300 mm/s
    load: 200 N
    sideslip: [0 deg, 10 deg, 20 deg]
    temperature: 40 degC
""",
)

ROLLING = recipe(
    "rolling and sliding",
    ("1#",),
    """\
  - name: slip
    slip_velocity: [0 mm/s, 200 mm/s, 400 mm/s]
    load: 200 N
    temperature: [40 degC, 70 degC]
""",
    repeats=5,
)

RUBBER = recipe(
    "what rubber does",
    ("1#",),
    """\
  - name: load
    slip_velocity: 300 mm/s
    load: [100 N, 200 N, 300 N, 400 N]
    temperature: 25 degC
  - name: temperature
    slip_velocity: 300 mm/s
    load: 400 N
    temperature: [40 degC, 55 degC, 70 degC, 85 degC]
""",
    repeats=1,
).replace("repeats: 1", "repeats: 1\n  min_valid: 1")
"""Loads on cold rubber, then the greatest load up to the hottest: 8 conditions of one repeat."""


def table2_short() -> str:
    """Return the shipped Table 2 with every axis cut short: nine conditions, three repeats."""
    text = recipes.find("table2").read_text(encoding="utf-8")
    for whole, cut in (
        ("repeats: 5", "repeats: 3"),
        ("[25 degC, 40 degC, 55 degC, 70 degC, 85 degC]", "[40 degC]"),
        ("[100 N, 200 N, 300 N, 400 N]", "[200 N, 400 N]"),
        ("[0 mm/s, 100 mm/s, 200 mm/s, 300 mm/s, 400 mm/s]", "[300 mm/s]"),
        ("[0 deg, 10 deg, 20 deg, 30 deg]", "[0 deg, 20 deg]"),
    ):
        if whole not in text:
            raise ValueError(f"recipes/table2.yaml has no {whole}")
        text = text.replace(whole, cut)
    return text
