"""Compile the modules of the scan to machine code where that is asked for; by default everything stays Python.

    pip install "mypy[mypyc]>=1.15" "setuptools>=77"
    FRICTION_TESTER_COMPILE=1 pip install --no-build-isolation .

The results are the same to the last bit, a simulated campaign takes less than half the time (docs/performance.md).
"""

from __future__ import annotations

import os
from pathlib import Path

from setuptools import setup

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
    "sim/can_wire.py",
    "sim/contact.py",
    "sim/friction.py",
    "sim/heat_flow.py",
    "sim/modbus_wire.py",
    "sim/nodes/canopen_device.py",
    "sim/nodes/cell_slave.py",
    "sim/nodes/cia402_slave.py",
    "sim/nodes/dither.py",
    "sim/nodes/drive_modes.py",
    "sim/nodes/drive_power.py",
    "sim/nodes/ir_slave.py",
    "sim/nodes/jacket_slave.py",
    "sim/nodes/modbus_slave.py",
    "sim/nodes/motion.py",
    "sim/nodes/pdo_channels.py",
    "sim/nodes/pdo_exchange.py",
    "sim/nodes/pid.py",
    "sim/noise.py",
    "sim/plant.py",
    "sim/rig.py",
    "sim/sensors.py",
    "sim/slip.py",
    "sim/thermal.py",
    "sim/wear.py",
    "tester/analysis/blocks.py",
    "tester/control/*.py",
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
)
"""What runs in every scan, and nothing that reads its own annotations."""

here = Path(__file__).parent
modules = []
if os.environ.get("FRICTION_TESTER_COMPILE") == "1":
    from mypyc.build import mypycify

    found = sorted(str(path.relative_to(here)) for pattern in HOT for path in here.glob(pattern))
    options = ["--ignore-missing-imports", "--follow-imports=silent"]
    modules = mypycify([*options, *found], opt_level="2", debug_level="0", multi_file=True)

setup(ext_modules=modules)
