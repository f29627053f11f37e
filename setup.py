"""Compile the modules of the scan to machine code where that can be done; all others, and elsewhere all, stay Python.

A simulated campaign then takes a third of the time, with the same results to the last bit (docs/decisions/0019). Where
there is no compiler, or FRICTION_TESTER_COMPILE=0 is set, the same files run as they are.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HOT = (
    "drivers/axis_command.py",
    "drivers/canopen/heartbeat.py",
    "drivers/canopen/master.py",
    "drivers/cia402.py",
    "drivers/ir_thermometer.py",
    "drivers/jacket.py",
    "drivers/load_cell.py",
    "drivers/modbus/device.py",
    "drivers/modbus/link.py",
    "drivers/modbus/request.py",
    "drivers/modbus/schedule.py",
    "drivers/servo.py",
    "sim/can_traffic.py",
    "sim/can_wire.py",
    "sim/contact.py",
    "sim/faults/can.py",
    "sim/friction.py",
    "sim/heat_flow.py",
    "sim/modbus_wire.py",
    "sim/nodes/canopen_device.py",
    "sim/nodes/cell_slave.py",
    "sim/nodes/cia402_slave.py",
    "sim/nodes/dither.py",
    "sim/nodes/drive_modes.py",
    "sim/nodes/drive_positioning.py",
    "sim/nodes/drive_power.py",
    "sim/nodes/ir_slave.py",
    "sim/nodes/jacket_slave.py",
    "sim/nodes/modbus_slave.py",
    "sim/nodes/motion.py",
    "sim/nodes/pdo_channels.py",
    "sim/nodes/pdo_exchange.py",
    "sim/nodes/pid.py",
    "sim/nodes/safety_io.py",
    "sim/noise.py",
    "sim/plant.py",
    "sim/rig.py",
    "sim/sensors.py",
    "sim/slip.py",
    "sim/thermal.py",
    "sim/torque.py",
    "sim/wear.py",
    "tester/analysis/blocks.py",
    "tester/control/*.py",
    "tester/engine/attended.py",
    "tester/engine/bursts.py",
    "tester/engine/condition.py",
    "tester/engine/context.py",
    "tester/engine/devices.py",
    "tester/engine/engine.py",
    "tester/engine/executor.py",
    "tester/engine/gates.py",
    "tester/engine/inspection.py",
    "tester/engine/moves.py",
    "tester/engine/run.py",
    "tester/engine/sampler.py",
    "tester/engine/thermal_steps.py",
    "tester/engine/tickers.py",
    "tester/engine/wheel_steps.py",
    "tester/process.py",
    "tester/service/manual.py",
)
"""What runs in every scan, and nothing that reads its own annotations."""

NAME = "friction_tester"
"""Begins the name of the library that all of them share."""
OPTIONS = ("--ignore-missing-imports", "--follow-imports=silent")


def compiled_modules() -> list[Extension]:
    """Translate the modules to C and return what is to be compiled; raises ImportError without mypy."""
    from mypyc.build import mypycify

    here = Path(__file__).parent
    found = sorted(str(path.relative_to(here)) for pattern in HOT for path in here.glob(pattern))
    return mypycify([*OPTIONS, *found], opt_level="2", debug_level="0", multi_file=True, group_name=NAME)


class CompileWherePossible(build_ext):
    """Compiles at the last moment, and installs the Python files alone where that fails."""

    def run(self) -> None:
        """Compile, unless it is not wanted: by the environment, or because a checkout is installed to be edited."""
        if os.environ.get("FRICTION_TESTER_COMPILE") == "0" or self.editable_mode:
            self._take([])
            return
        try:
            self._take(compiled_modules())
            self.parallel = self.parallel or os.cpu_count() or 1
            super().run()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - a compiler, or none, raises what it likes
            print(f"warning: the scan stays Python, it could not be compiled: {error}", file=sys.stderr)
            for output in map(Path, self.get_outputs()):
                output.unlink(missing_ok=True)  # half of it would not work
            self._take([])

    def _take(self, extensions: list[Extension]) -> None:
        """Make these what is to be built."""
        self.distribution.ext_modules = extensions
        self.reinitialize_command(self, inplace=self.inplace, parallel=self.parallel)
        self.ensure_finalized()


setup(
    ext_modules=[Extension("tester.compiled", [])],  # says that there is something to compile; made at the last moment
    cmdclass={"build_ext": CompileWherePossible},
)
