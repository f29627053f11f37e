"""Recipes that the checks run: short, near ambient temperature, without pre-grinding."""

SHORT = """\
recipe: short
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, min_valid: 1, window: 14 rev, soak: {within: 2 degC, for: 2 s}}
grids:
  - {name: one, slip_velocity: 300 mm/s, load: [100 N, 200 N], temperature: 25 degC}
"""
"""Two rows of three repeats."""

SLIDING = """\
recipe: sliding
specimens: [{compound: "1#"}]
measure:
  wheel_speed: 0.8 m/s
  repeats: 50
  min_valid: 1
  window: 2000 rev
  temperature_band: 20 K
  soak: {within: 5 degC, for: 1 s}
  max_bursts: 1000
grids:
  - {name: sliding, slip_velocity: 100 mm/s, load: 100 N, temperature: 24.2 degC}
wheel: {replace_after: 15 mm}
"""
"""Slides some 20 s after its start, for many minutes, with the heat on."""

MISTAKEN = SHORT.replace("load: [100 N, 200 N]", "load: 100")
"""A load without a unit: column 48 of line 5."""
