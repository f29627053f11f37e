"""The sledge, for a run and for a service."""

from math import copysign

from lab_sledge.image import QUANTITIES, SledgeReadings
from lab_sledge.recipe import AXES, PART
from lab_sledge.rig import TABLE, SledgeRig
from tester.base.axes import Setpoint
from tester.base.screen import PlotView
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.plain.image import PlainReadings
from tester.machine.plain.runs import PlainRuns
from tester.machine.plain.served import PlainServed


class SledgeRuns(PlainRuns):
    """Pulls the sledge back and forth: each repeat goes the way that brings it nearer to where it was put down."""

    plant = "lab_sledge.twin:MACHINE"
    part = PART
    table = TABLE

    def readings(self, rig: PlainRig) -> SledgeReadings:
        """Return readings that know the weight."""
        return SledgeReadings(load_n=SledgeRig.of(rig).sledge.weight_n)

    def speeds(self, setpoint: Setpoint, readings: PlainReadings) -> dict[str, float]:
        """Return the speed of the pull."""
        assert isinstance(readings, SledgeReadings)
        return {"pull": -copysign(setpoint.number("speed"), readings.place_mm)}


RUNS = SledgeRuns()
SERVED = PlainServed("sledge", RUNS, AXES, QUANTITIES, {"pull": "Pull"}, (PlotView("friction", "friction", 0.1),))
