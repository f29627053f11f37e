"""Control of a machine that is safe once its drives are at rest: no lift, no cool-down."""

from __future__ import annotations

from tester.machine.control import Control, DemandT, InputsT, ReadingsT, StateT
from tester.machine.state import Mode


class StandstillControl(Control[StateT, ReadingsT, DemandT, InputsT]):
    """Outputs of every mode but RUN and HOLD. A kind implements ``stand``."""

    def stand(self) -> None:
        """Command zero to every drive that has a speed, and standby to everything that heats or cools."""
        raise NotImplementedError

    def _command(self, *, quick_stop: bool, enable: bool) -> None:
        self.stand()
        out = self.state.setpoints
        out.quick_stop, out.enable = quick_stop, enable

    def stop_outputs(self) -> None:
        self._command(quick_stop=self.state.mode is not Mode.STOPPING, enable=self.state.setpoints.enable)

    def safe_outputs(self) -> None:
        self._command(quick_stop=True, enable=self.state.setpoints.enable)

    def emergency_outputs(self) -> None:
        self._command(quick_stop=True, enable=False)

    def rest_outputs(self) -> None:
        self._command(quick_stop=False, enable=False)

    def cool_outputs(self) -> str:
        """End a cool-down at once: nothing on the machine is hot."""
        return "nothing to cool"
