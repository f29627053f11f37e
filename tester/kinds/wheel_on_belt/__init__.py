"""A rubber wheel that rolls and slips on a belt: the machine of Polymers 2024, 16(5), 596."""

from __future__ import annotations

from typing import Final

from tester.kinds.kind import Kind, found_at

KIND: Final = Kind(
    name="wheel_on_belt",
    title="rubber wheel on a belt",
    measurand="the friction coefficient of a rubber wheel that turns against an abrasive belt and slips on it: "
    "horizontal force at the contact over the load, mean of the repeats of each condition",
    rigs={"sim": "sim:rig.yaml"},
    rig=found_at("tester.kinds.wheel_on_belt.rig.wheel_rig:RigConfig"),
    interlocks=found_at("tester.kinds.wheel_on_belt.interlocks.table:SHEET"),
    page="docs/kinds/wheel-on-belt.md",
    recipe=found_at("tester.kinds.wheel_on_belt.recipe.part:PART"),
    runs=found_at("tester.kinds.wheel_on_belt.run.runs:RUNS"),
    served=found_at("tester.kinds.wheel_on_belt.served.served:SERVED"),
    fits=found_at("tester.kinds.wheel_on_belt.fit.fits:FITS"),
    papers=found_at("tester.kinds.wheel_on_belt.papers:PAPERS"),
    masters=found_at("tester.kinds.wheel_on_belt.fit.master_conditions:MASTERS"),
    commissions=found_at("tester.kinds.wheel_on_belt.commission.commission_steps:COMMISSIONS"),
    ring=found_at("tester.kinds.wheel_on_belt.run.past_runs:RING"),
)
