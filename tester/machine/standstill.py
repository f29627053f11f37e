"""Control of a machine that is safe once its drives are at rest: no lift, no cool-down."""

from __future__ import annotations

from tester.base.deriving import mypyc_attr
from tester.inputs.rig import Rig
from tester.inputs.rig.parameter import Parameter
from tester.machine.control import Control
from tester.machine.drive_rows import ACK_WAIT_S
from tester.machine.interlock_table import InterlockTable
from tester.machine.mode_commands import DemandT, InputsT, ReadingsT, StateT, may_move
from tester.machine.state import Mode


@mypyc_attr(allow_interpreted_subclasses=True)
class StandstillControl(Control[StateT, ReadingsT, DemandT, InputsT]):
    """Outputs of every mode but RUN and HOLD. A kind implements ``stand``, ``motion_over`` and ``stop_ended``."""

    def __init__(
        self, rig: Rig, state: StateT, view: InputsT, table: InterlockTable, demands: tuple[DemandT, DemandT],
        hold_at_most: Parameter,
    ) -> None:  # fmt: skip
        """Read the bounds of the rows from the rig file.

        ``demands``: two fresh ones, for the modes that ignore the recipe's demand; ``hold_at_most``: the bound of a
        hold.
        """
        values = view.parameters = rig.values()
        view.note_further(rig)
        view.stop = state.stop
        withdrawn, held = demands  # named, not starred: mypyc loses starred arguments before keywords
        super().__init__(
            state, view, table, withdrawn, held,
            hold_at_most_s=values[hold_at_most], ack_wait_s=values[ACK_WAIT_S],
        )  # fmt: skip

    def enable(self, demand: DemandT, readings: ReadingsT) -> None:
        """Switch the drives' power on where it is demanded and they may move; end a quick stop."""
        out = self.state.setpoints
        out.enable, out.quick_stop = demand.enabled and may_move(readings), False

    def stand(self) -> None:
        """Command zero to every drive that has a speed, and standby to everything that heats or cools."""
        raise NotImplementedError

    def _command(self, *, quick_stop: bool, enable: bool) -> None:
        self.stand()
        out = self.state.setpoints
        out.quick_stop, out.enable = quick_stop, enable

    def stop_outputs(self) -> None:
        """Stop on the ramp or by quick stop; the drives lose their power at standstill, whatever else still ends."""
        enable = self.state.setpoints.enable and not self.motion_over()
        self._command(quick_stop=self.state.mode is not Mode.STOPPING, enable=enable)

    def safe_outputs(self) -> None:
        self._command(quick_stop=True, enable=self.state.setpoints.enable)

    def emergency_outputs(self) -> None:
        self._command(quick_stop=True, enable=False)

    def rest_outputs(self) -> None:
        self._command(quick_stop=False, enable=False)

    def cool_outputs(self) -> str:
        """End a cool-down at once: nothing on the machine is hot."""
        return "nothing to cool"
