"""Sections 2 and 3 of the paper: compounds, machine, procedure, and its drawings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import recipes
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted, unjudged
from tester.kinds.wheel_on_belt.image.axes import AXES

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.recipe.schema import WheelRecipe

TABLE_1_LINES: Final = {"1#": 9, "2#": 11, "3#": 12}
TABLE_2: Final = {
    "slip_velocity": (0.0, 0.1, 0.2, 0.3, 0.4), "load": (100.0, 200.0, 300.0, 400.0),
    "sideslip": (0.0, 10.0, 20.0, 30.0),
    "temperature": (25.0, 40.0, 55.0, 70.0, 85.0),
}  # fmt: skip
"""Values of the paper's Table 2, in the units of the axes."""
OUTER_MM, WIDTH_MM = 90.0, 30.0
CURE_C, CURE_S = 150.0, 1500.0
GRIND: Final = {"wheel_speed": 0.8, "belt_speed": 0.6, "load": 200.0, "duration": 240.0}


def _table_1() -> PaperFinding:
    from tester.inputs.materials.library import Library

    library = Library([recipes.FOLDER])
    models = {name: library.compound(name).model for name in TABLE_1_LINES}
    sums = ", ".join(f"{sum(entry.formulation.values()):.4g}" for entry in models.values())
    cured = all(
        entry.cure is not None and (entry.cure.temperature, entry.cure.time) == (CURE_C, CURE_S)
        for entry in models.values()
    )
    holds = {name: len(entry.formulation) for name, entry in models.items()} == TABLE_1_LINES and cured
    lines = sum(len(entry.formulation) for entry in models.values())
    return judged(holds, f"{lines} lines in the files, {sums} phr in all; cure {CURE_C:g} degC, {CURE_S / 60.0:g} min")


def _table_2() -> PaperFinding:
    from tester.inputs.recipe.conditions import conditions_of
    from tester.kinds.wheel_on_belt.recipe.part import PART

    recipe = _recipe("table2")
    conditions = conditions_of(recipe, PART.settings)
    values = {name: {entry.values[AXES.places[name]] for entry in conditions} for name in TABLE_2}
    holds = all(values[name] == set(printed) for name, printed in TABLE_2.items())
    count = len(conditions) * len(recipe.specimens)
    return judged(holds, f"{count} conditions, {len(conditions)} a compound, at all of the printed values")


def _axes() -> PaperFinding:
    asked = ("slip_velocity", "load", "temperature", "sideslip", "camber")
    there = [name for name in asked if name in {axis.name for axis in AXES}]
    return judged(len(there) == len(asked), f"{len(there)} of {len(asked)} are axes of a recipe: {', '.join(there)}")


def _heating() -> PaperFinding:
    from tester.kinds import load_rig

    devices = load_rig().devices
    asked = ("jacket", "ir_thermometer", "load_cell")
    there = [name for name in asked if name in devices]
    return judged(len(there) == len(asked), f"the simulated rig has {', '.join(there)} as devices on wires")


def _wheel() -> PaperFinding:
    from tester.kinds import load_rig
    from tester.kinds.wheel_on_belt.rig.wheel_rig import RigConfig

    wheel = RigConfig.of(load_rig()).sim.wheel
    off_mm = max(abs(wheel.outer_diameter - OUTER_MM), abs(wheel.width - WIDTH_MM))
    return judged(
        off_mm == 0.0,
        f"{wheel.outer_diameter:g} mm and {wheel.width:g} mm in the simulated rig, off by {off_mm:g} mm; of the radius"
        f" {wheel.rubber_layer:g} mm are rubber there [A], the paper prints the bore alone",
    )


def _recipe(name: str) -> WheelRecipe:
    from tester.inputs.recipe.loader import load_checked
    from tester.kinds import load_rig
    from tester.kinds.wheel_on_belt.recipe.part import PART
    from tester.kinds.wheel_on_belt.recipe.schema import WheelRecipe

    recipe = load_checked(recipes.FOLDER / f"{name}.yaml", load_rig(), PART).recipe
    assert isinstance(recipe, WheelRecipe)
    return recipe


def _grind() -> PaperFinding:
    grind = _recipe("pre-grind").pre_grind
    assert grind is not None
    result = {name: float(getattr(grind, name)) for name in GRIND}
    slip_m_s = result["wheel_speed"] - result["belt_speed"]
    way_m = slip_m_s * result["duration"]
    phrase = f"the recipe has the printed values: slip {slip_m_s:.1f} m/s, {way_m:.0f} m of sliding"
    return judged(result == GRIND, phrase if result == GRIND else f"the recipe has {result}")


def _repeats() -> PaperFinding:
    measure = _recipe("table2").measure
    assert measure is not None
    least = measure.repeats if isinstance(measure.repeats, int) else measure.repeats.at_least
    phrase = f"five in (3), three in (4): they contradict each other; the recipe makes {least}"
    return judged(False, phrase, "0 of a count")


def _steady() -> PaperFinding:
    from sim.physics.parameters import SimParameters

    share = SimParameters().friction_heat_fraction
    return unjudged(
        f"no share of friction heat is printed; the simulated wheel takes {100.0 * share:g} %, chosen so that this"
        " holds, so it shows nothing"
    )


MACHINE: Final = (
    PaperItem("Table 1", "three compounds in phr; cured at 150 degC for 25 min (2.2.2)", 'tester materials show "1#"',
              _table_1),
    PaperItem("Table 2", "slip velocity, load, sideslip, temperature of the tests", "tester plan table2", _table_2),
    PaperItem("2.2.1, Fig 3", "speed, pressure, temperature, sideslip and camber can be set",
              "tester schema --of recipe", _axes),
    PaperItem("Fig 4", "a jacket heats the wheel from within, an infrared thermometer reads the surface",
              "tester rig show", _heating),
    PaperItem("Fig 5a, 5c", "wheel of 90 mm, bore 40 mm, 30 mm thick", "tester rig show", _wheel),
)  # fmt: skip
PROCEDURE: Final = (
    PaperItem("2.2.2 (2)", "pre-grinding: 0.8 and 0.6 m/s, 200 N, 4 min", "tester plan pre-grind", _grind),
    PaperItem("2.2.2 (3), (4)", "tests of each wheel and condition", "tester plan table2", _repeats),
    PaperItem("3.2", "surface temperature does not change while the wheel slips", "tester run quickstart", _steady),
)
DRAWINGS: Final = (
    not_attempted("Fig 1", "how adhesion and hysteresis arise", "a drawing without numbers"),
    not_attempted("Fig 2", "contact of DIN, Williams, Lambourn, Akron, LAT100 testers and of this one",
                  "other machines; a pin on a disc is the rig `pin-on-disc`"),
    not_attempted("Fig 5b", "mould of the wheel", "a drawing; the wheel comes moulded"),
    not_attempted("Fig 12", "print of the wheel at five temperatures",
                  "photographs without areas; no sensor of the print"),
    not_attempted("Fig 13", "deformation of the wheel over temperature, nearly constant from 55 degC",
                  "no values are printed; `tester figure RUN` draws it; the twin's softening is an assumption and off"),
)  # fmt: skip
