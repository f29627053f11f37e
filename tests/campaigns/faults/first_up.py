"""For every row of the interlock table: a fault of the catalogue that trips it first, or the reason why none can.

The judge requires a trip in time, by any row, and rows overlap: without one, another may be as quick. Here each row
must be the first cause of some trip.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tests.campaigns.faults.late_scans import PATIENT
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.recipes import language_of
from tests.campaigns.faults.stage import Stage

SLIDE, ROLL, HEAT, WARM = ("short", "measure"), ("short", "wait"), ("heated", "heat"), ("heated", "soak")
"""(recipe, phase): sliding at 0.3 m/s under 200 N; rolling; heating up, lifted; rolling with the hub at 64 degC."""
LONGEST_S = 20.0
UNWITNESSED = ("interlocks.force_step=1000 N", "interlocks.press_torque_margin=1000 N")
"""The witnesses of the force are earlier than the rows that look at the force alone."""
UNGRIPPED = ("interlocks.belt_pull=100 N m", "interlocks.belt_torque=100 N m")
"""The belt drive's torque denies a direction sooner than friction and power do."""
UNHIDDEN = ("interlocks.hidden_model=100 K",)
"""While the hub heats, "hub hotter than shown" is earlier than the row that looks at the surface alone."""


@dataclass(frozen=True, slots=True)
class First:
    """A row, the faults that trip it (fault script lines, times from the beginning), and where that begins.

    ``overrides``: settings that delay another row that would trip earlier on the packaged rig.
    """

    interlock: str
    faults: tuple[str, ...]
    where: tuple[str, str] = SLIDE
    within_s: float = LONGEST_S
    overrides: tuple[str, ...] = ()


FIRST: tuple[First, ...] = (
    First("safety chain", ("t=0 s: safety chain opened",)),
    First("drive fault", ("t=0 s: belt drive fault",)),
    First("bus lost", ("t=0 s: CAN adapter gone",)),
    First("second master", ("t=0 s: second master SYNC",)),
    First("scan late", ("t=0 s: scan stalled while sliding",), overrides=PATIENT),
    First("guard open", ("t=0 s: guard opened",)),
    First("drive data stale", ("t=0 s: wheel drive data lost",)),
    First("inputs stale", ("t=0 s: press drive inputs lost",)),
    First("drive dropped out", ("t=0 s: belt drive torque off",)),
    First("overspeed", ("t=0 s: wheel runs away 27 rad/s", "t=0.1 s: operator stop"), HEAT),
    First("wheel speed", ("t=0 s: wheel runs away",)),
    First("belt speed", ("t=0 s: belt runs away",)),
    First("press speed", ("t=0 s: press runs away",)),
    First("drive standing under load", ("t=0 s: belt jammed",)),
    First("belt torn", ("t=0 s: belt torn",)),
    First("CAN silent", ("t=0 s: CAN bus off",)),
    First("load cell silent", ("t=0 s: load cell silent",)),
    First("load cell saturated", ("t=0 s: load cell half updated",)),
    First("load cell frozen", ("t=0 s: load cell frozen",)),
    First("overload", ("t=0 s: load cell jumps 300 N",)),
    First("load overshoot", ("t=0 s: load cell jumps",), overrides=UNWITNESSED),
    First("contact too deep", ("t=0 s: load cell reads low",), overrides=UNWITNESSED),
    First("force step", ("t=0 s: load cell offset -30 N",)),
    First("force step", ("t=0 s: load cell offset 30 N",)),
    First("press torque", ("t=0 s: load cell drift -3 N/s",), within_s=60.0),
    First("press torque", ("t=0 s: load cell drift 3 N/s",), within_s=60.0),
    First("press spring", ("t=0 s: common force supply gain 85 %",), ("short", "tare")),
    First("friction sign", ("t=0 s: load cell Fx reversed",), overrides=UNGRIPPED),
    First("shaft power", ("t=0 s: belt drive reversed",), overrides=UNGRIPPED),
    First("belt caught", ("t=0 s: belt slips on its roller 10 %",)),
    First("belt torque", ("t=0 s: belt slips on its roller 3 %",), ("short", "roll")),
    First("contact lost", ("t=0 s: press runs away -5 mm/s",)),
    First("surface hot", ("t=0 s: thermometer drift 0.4 K/s",), WARM, 60.0, ("limits.surface=42 degC", *UNHIDDEN)),
    First("jacket hot", ("t=0 s: jacket output stuck on",), WARM, 120.0,
          ("limits.jacket=75 degC", "loops.heat.hub_max=75 degC", "interlocks.runaway=100 K")),
    First("jacket runaway", ("t=0 s: jacket output stuck on",), WARM, 120.0),
    First("heater stuck", ("t=0 s: jacket relay shorted",), WARM),
    First("heater line open", ("t=0 s: heater line open",), HEAT, 120.0),
    First("hub sensor jump", ("t=0 s: hub sensor jumps",)),
    First("hub sensor frozen", ("t=0 s: hub sensor frozen", "t=0 s: thermometer offset -4.5 K"), WARM, 240.0,
          ("interlocks.frozen_hub_share=0.01", "interlocks.frozen_hub=0.5 K", *UNHIDDEN)),
    First("surface sensor jump", ("t=0 s: thermometer jumps",)),
    First("thermometer frozen", ("t=0 s: thermometer frozen",), WARM, 80.0),
    First("surface off model", ("t=0 s: thermometer drift",), WARM, 120.0, UNHIDDEN),
    First("surface off model", ("t=0 s: thermometer reads low 50 %",), HEAT, 400.0, UNHIDDEN),
    First("hub hotter than shown", ("t=0 s: common temperature supply drift -6 %/min",), HEAT, 120.0),
    First("heat not given", ("t=0 s: hub sensor drift 0.15 K/s",), WARM, 120.0,
          ("interlocks.stuck_rate=1 K/s", "interlocks.runaway=15 K")),
    First("heat not shown", ("t=0 s: hub sensor delay 30 s",), HEAT, 60.0),
    First("thermometer silent", ("t=0 s: thermometer silent",)),
    First("surface not valid", ("t=0 s: thermometer open",)),
    First("jacket silent", ("t=0 s: jacket silent",)),
    First("hub sensor broken", ("t=0 s: hub sensor open",)),
    First("device refused", ("t=0 s: thermometer exception 2",)),
    First("line noisy", ("t=0 s: load cell garbage",)),
    First("not lifted", ("t=0 s: press runs away 0 mm/s", "t=0.2 s: operator stop")),
    First("lift failed", ("t=0 s: operator stop", "t=0.01 s: press runs away")),
    First("not stopping", ("t=0 s: operator stop", "t=0.1 s: wheel runs away")),
    First("quick stop failed", ("t=0 s: operator fast stop", "t=0.02 s: wheel runs away")),
    First("output not off", ("t=0 s: jacket output stuck on", "t=0.1 s: operator stop"), WARM),
    First("lift failed", ("t=0 s: press drive feedback frozen", "t=0.1 s: operator stop")),
    First("wheel frozen", ("t=0 s: operator stop", "t=6 s: wheel drive feedback frozen"), WARM,
          overrides=("interlocks.cooldown_hub=35 degC",)),
    First("contactor welded", ("t=0 s: contactor welded", "t=0.1 s: operator stop"), WARM),
    First("scan delayed", ("t=0 s: scan stalled 80 ms",), ROLL),
)  # fmt: skip

NEVER_FIRST: dict[str, str] = {
    "friction beyond load": "channels that are crossed step, or deny the press's torque, before they show so much",
    "clock jump": "a scan waits for its time on the same clock: one that goes back delays it, and that shows first",
    "press travel": "a wheel is pressed flat long before 20 mm: force and press speed come first",
    "slip power": "the speeds' own rows are as quick, and friction alone cannot reach 350 W at the speeds of the rig",
    "heating at standstill": "a wheel that stands against its command trips its own row in the same time",
    "heat not off": "needs contactor and output stuck together: the contactor's row sees them half a second sooner",
    "moving at rest": "the catalogue's drives that obey nothing turn only with power, and at rest none has any",
    "stop not ended": "drives, press and heat each have a row that knows of their own times before",
    "loaded at rest": "it stops nothing: it refuses to arm and to acknowledge",
    "wheel worn": "no fault wears a wheel: the diameter is counted down over hours, and the wheel is changed before",
}
"""Rows without a fault that trips them first; their levels and delays are shown in tests/tester/kinds."""


def left_out() -> list[str]:
    """Return the rows that are in neither list."""
    known = {row.interlock for row in FIRST} | NEVER_FIRST.keys()
    return [row.name for row in TABLE.rows if row.name not in known]


def conduct(rows: Iterable[First] = FIRST) -> dict[First, str]:
    """Start the faults of each row; return the first cause ("" if nothing tripped)."""
    rows = tuple(rows)
    found: dict[First, str] = {}
    groups: dict[tuple[str, tuple[str, ...]], list[First]] = {}
    for row in rows:
        groups.setdefault((row.where[0], row.overrides), []).append(row)
    for (recipe, overrides), mine in groups.items():
        by_moment: dict[Moment, list[First]] = {}
        for row in mine:
            by_moment.setdefault(_moment(row, rehearse(recipe, overrides)[0]), []).append(row)

        def look(moment: Moment, twins: Twins, here: dict[Moment, list[First]] = by_moment) -> None:
            for row in here[moment]:
                found[row] = twins.do(lambda twin, row=row: first_cause(twin, row))

        visit(recipe, by_moment, look, overrides)
    return {row: found[row] for row in rows}


def first_cause(stage: Stage, row: First) -> str:
    """Start a row's faults; return the first trip, or the first warning if the row only warns."""
    began_s = stage.next_s
    for text in row.faults:
        injection = language_of(row.where[0]).parse(text)
        stage.inject(injection.shifted(began_s))
    while stage.next_s < began_s + row.within_s and not stage.run.finished:
        stage.tick()
        if stage.trip:
            return stage.trip
        if row.interlock in stage.ledger.warned:
            return row.interlock
    return ""


def _moment(row: First, moments: Iterable[Moment]) -> Moment:
    """Return the middle of the first step with the row's phase."""
    return next(m for m in moments if m.step.endswith(f" {row.where[1]}") and m.phase == "middle")
