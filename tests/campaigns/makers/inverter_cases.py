"""Cases of the profile of frequency inverters with a slave built from makers' pages: read, write, refuse, fault."""

from __future__ import annotations

import math
import random

from drivers.axis import AxisConfig
from drivers.canopen.master import CanMaster
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tests.campaigns.makers.inverter import NODE, VENDOR, InverterSlave
from tests.campaigns.makers.seat import Tally

PROFILE = "cia402_inverter"
SCAN_S = 0.01
CONNECT_S = 20.0
NEEDED = (0x6007, 0x6042, 0x6044, 0x6048, 0x6049, 0x604A, 0x605A, 0x605E, 0x6077, 0x1016, 0x6060)
"""Mandatory objects of an inverter that turns an axis."""
RAMPS = ((0x6048, "acceleration"), (0x6049, "deceleration"), (0x604A, "quick_stop_deceleration"))


def drawn_axis(source: random.Random, profile: str) -> AxisConfig:
    """Return an axis with a profile, of a drawn gear and drawn ramps; the motor turns at 600 r/min or more."""
    gear = source.uniform(1.0, 30.0)
    counts = 30.0 / math.pi * gear
    most = source.uniform(600.0, 32000.0) / counts
    ramp = source.uniform(0.5, 4.0) * most
    return AxisConfig(
        name="belt", node_id=NODE, mode="velocity", unit="rad/s", velocity_increments=counts, position_increments=0.0,
        feedback="velocity", rated_torque_nm=source.uniform(1.0, 50.0), max_speed=most, acceleration=ramp,
        deceleration=source.uniform(0.5, 4.0) * most, quick_stop_deceleration=source.uniform(4.0, 9.0) * most,
        gear=gear, vendor_id=VENDOR, product_code=0, profile=profile,
    )  # fmt: skip


class _Seat:
    """Our driver and a slave on one bus, scanned every 10 ms."""

    def __init__(self, config: AxisConfig, slave: InverterSlave) -> None:
        """Connect, or be refused."""
        self.slave, self.now = slave, 0.0
        self.master, self.drive = CanMaster(), ServoDrive(config)
        self.master.add(self.drive)
        self.master.start(self.drive, self.drive.connect())
        while self.master.busy(self.drive) and self.now < CONNECT_S:
            self._pass(0.001)
            self.master.service(slave, self.now)

    def _pass(self, seconds: float) -> None:
        self.now += seconds
        self.master.feed(self.slave.receive(self.now), self.now)

    def run(self, seconds: float) -> None:
        """Scan for a time."""
        end_s = self.now + seconds
        while self.now < end_s:
            self.master.scan(self.slave, self.now)
            self._pass(0.5 * SCAN_S)
            self._pass(0.5 * SCAN_S)

    def turn(self, target: float) -> None:
        """Enable and run to a speed; the least ramp takes two seconds."""
        self.drive.goal = Goal.DISABLED
        self.drive.goal = Goal.ENABLED
        self.drive.target = target
        self.run(4.5)


class InverterCases:
    """The cases, with drawn numbers."""

    def __init__(self, source: random.Random, tally: Tally, profile: str = PROFILE) -> None:
        """Judge into ``tally``; ``profile``: a name, or a path."""
        self.source, self.tally, self.profile = source, tally, profile

    def conduct(self, rounds: int) -> None:
        """Conduct every kind of case ``rounds`` times."""
        for number in range(rounds):
            self._writes_and_reads()
            self._refusals(NEEDED[number % len(NEEDED)])
            self._faults()

    def _judge(self, kind: str, right: bool, text: str) -> None:
        self.tally.judge(kind, right, f"{PROFILE}: {text}")

    def _writes_and_reads(self) -> None:
        config = drawn_axis(self.source, self.profile)
        seat = _Seat(config, InverterSlave())
        drive, slave, counts = seat.drive, seat.slave, config.velocity_increments
        self._judge("write", drive.refused is None, f"is refused: {drive.refused}")
        for index, key in RAMPS:
            rate = slave.values[index, 1] / slave.values[index, 2] / counts
            asked = float(getattr(config, key))
            self._judge("write", abs(rate - asked) <= 0.51 / counts, f"0x{index:X} is {rate:g}, {asked:g} was asked")
        target = self.source.uniform(-1.0, 1.0) * config.max_speed
        seat.turn(target)
        received, most = slave.values[0x6042, 0], slave.values[0x6046, 2]
        self._judge("write", abs(received - target * counts) <= 0.51,
                    f"0x6042 is {received}, {target * counts:.1f} was asked")
        self._judge("write", most == round(config.max_speed * counts), f"0x6046:02 is {most}")
        self._judge("read", abs(drive.actual - target) <= 1.01 / counts, f"{drive.actual} is shown at {target}")
        for _ in range(4):
            slave.mille = self.source.uniform(-3000.0, 3000.0)
            seat.run(0.03)
            shown = 1000.0 * drive.torque_nm / config.rated_torque_nm
            self.tally.counts["numbers"] += 1
            self._judge("read", abs(shown - slave.mille) <= 0.51, f"{shown:g} per mille at {slave.mille:g}")

    def _refusals(self, absent: int) -> None:
        config = drawn_axis(self.source, self.profile)
        drive = _Seat(config, InverterSlave(without={absent})).drive
        named = f"0x{absent:04X}" in (drive.refused or "") or f"0x{absent:04X}" in str(drive.plan.refused)
        self._judge("refuse", not drive.online and named, f"without 0x{absent:X}: {drive.refused}")
        index, key = self.source.choice(RAMPS)
        taken = round(float(getattr(config, key)) * config.velocity_increments) - 1
        drive = _Seat(config, InverterSlave(most={(index, 1): taken})).drive
        self._judge("refuse", f"0x{index:X}:01" in (drive.refused or ""), f"0x{index:X} too great: {drive.refused}")

    def _faults(self) -> None:
        config = drawn_axis(self.source, self.profile)
        seat = _Seat(config, InverterSlave())
        drive, slave = seat.drive, seat.slave
        target = self.source.uniform(0.3, 1.0) * config.max_speed
        seat.turn(target)
        slave.fail(0x2310, seat.now)
        seat.run(0.1)
        reported = drive.emergency is not None and drive.emergency.code == 0x2310
        self._judge("fault", drive.state is State.FAULT and reported, f"{drive.state.name} after EMCY 0x2310")
        seat.run(1.0)
        self._judge("fault", slave.values[0x6042, 0] == 0 or slave.state == "fault", "it is enabled again by itself")
        drive.reset_fault()
        seat.run(0.1)
        seat.turn(target)       # the target is cleared at enabling
        self._judge("fault", abs(drive.actual - target) * config.velocity_increments <= 1.01, "no speed after a reset")
        before = drive.actual, drive.stamp_s
        slave.sends = self.source.choice((4, 8))
        seat.run(0.1)
        self._judge("fault", (drive.actual, drive.stamp_s) == before, f"TPDO1 of {slave.sends} bytes is believed")
        slave.sends = 0
        seat.master.withhold_heartbeat = True
        seat.run(1.0)
        self._judge("fault", slave.rpm == 0.0, f"{slave.rpm:g} r/min a second after our last heartbeat")
        slave.silent = True
        seat.run(1.0)
        self._judge("fault", drive.lost and seat.now - drive.stamp_s > 0.9, "a silent inverter is believed")
