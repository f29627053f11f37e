"""Frame logs of a run: CAN as a candump log, Modbus with one line for each frame.

``can.log`` is written by python-can's own candump writer, so any CAN tool reads it. ``modbus-<line>.log`` holds ``(time
in s) direction bytes``; ``axes.json`` holds the factors from a drive's counts to engineering units.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

import can

from drivers.ports import CanPort, LinePort
from drivers.process_data import actual_of, target_of
from tester.inputs.rig import Rig

CHANNEL = "can0"
"""Name of the bus in the log."""


class CanLog:
    """Writes CAN frames to a log."""

    def __init__(self, path: Path) -> None:
        """Create the file."""
        self._writer = can.CanutilsLogWriter(path, channel=CHANNEL)

    def frame(self, t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        """Write a frame that was complete at ``t`` s of the run."""
        self._writer.on_message_received(
            can.Message(
                timestamp=t,
                arbitration_id=can_id,
                data=data,
                is_extended_id=False,
                is_rx=not from_pc,
                channel=CHANNEL,
            )
        )

    def close(self) -> None:
        """Flush and close the file."""
        self._writer.stop()


class LineLog:
    """Writes the Modbus frames of one line."""

    def __init__(self, path: Path) -> None:
        """Create the file."""
        self._file: TextIO = path.open("w", encoding="utf-8", newline="\n")

    def frame(self, t: float, data: bytes, from_pc: bool) -> None:
        """Write a frame that was complete at ``t`` s of the run."""
        self._file.write(f"({t:.6f}) {'TX' if from_pc else 'RX'} {data.hex(' ')}\n")

    def close(self) -> None:
        """Flush and close the file."""
        self._file.close()


class BusLog:
    """All logs of a run in one folder."""

    def __init__(self, folder: Path, rig: Rig) -> None:
        """Create the folder and its files."""
        folder.mkdir(parents=True, exist_ok=True)
        self.can = CanLog(folder / "can.log")
        self.lines = {name: LineLog(folder / f"modbus-{name}.log") for name in rig.lines}
        (folder / "axes.json").write_text(json.dumps(_axes(rig), indent=2) + "\n", encoding="utf-8")

    def watch(self, can: CanPort, lines: Mapping[str, LinePort]) -> None:
        """Log the traffic of these ports; ``lines`` by their names in the rig file."""
        can.watch(self.can.frame)
        for name, line in lines.items():
            line.watch(self.lines[name].frame)

    def close(self) -> None:
        """Flush and close every file."""
        self.can.close()
        for line in self.lines.values():
            line.close()


def _axes(rig: Rig) -> dict[str, dict[str, object]]:
    """Return each drive's PDO contents and counts per unit."""
    return {
        name: {
            "node": axis.node_id,
            "unit": axis.unit,
            "mode": axis.mode,
            "velocity_counts_per_unit": axis.velocity_increments,
            "position_counts_per_unit": axis.position_increments,
            "tpdo1": [
                "6041 statusword", f"{actual_of(axis)[0]:04X} {axis.feedback}", *["6077 torque"] * axis.drive.torque,
            ],
            "rpdo1": ["6040 controlword", f"{target_of(axis)[0]:04X} {axis.mode}"],
        }
        for name, axis in rig.drives().items()
    }  # fmt: skip
