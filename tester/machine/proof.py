"""The proof of every machine before a run: its drives follow commands, and stop without our heartbeat.

A drive watches a heartbeat only from the first one it receives (CiA 301), so a wrong parameter would show only when the
watchdog is needed. The proof therefore tests the watchdog, with nothing loaded: at standstill, or at creep speed if a
kind implements the creeping.
"""

from __future__ import annotations

from enum import Enum
from math import inf, nan

from drivers.canopen.objects import NmtState
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tester.machine.devices import DeviceList

ENABLE_S = 5.0
"""Time limit for brake release and power stage, s [A]."""
HEARTBEAT_LOST = 0x8130
"""EMCY code of a missing heartbeat (CiA 301, table 26)."""
STILL_S = 1.5
"""Longest time from the end of the withheld heartbeat to standstill [A]."""
RESTORE_S = 3.0
"""Time limit for resetting faults and switching every drive off, s [A]."""
RESET_EVERY_S = 0.2
STANDING_SHARE = 0.01
"""Speed below which a drive counts as at rest, as a share of its greatest speed [A]."""


class ProofStage(Enum):
    """Stage of a proof."""

    ENABLE = "enable the drives"
    MOVE = "let them creep"
    WITHHOLD = "withhold the heartbeat"
    STILL = "wait for standstill"
    RESTORE = "reset and switch off"
    DONE = "done"


class WatchdogProof:
    """Passes through the stages, one call of ``step`` a scan. ``failure``: why the proof failed; "" if it has not."""

    emergency: int = HEARTBEAT_LOST
    """Code of the EMCY with which a drive reports the missing signal."""
    unloaded: tuple[str, ...] = ()
    """Facts proven before this proof began."""

    def __init__(self, devices: DeviceList, *, follow: bool, watchdog: bool, withhold_s: float) -> None:
        """Move nothing before the first ``step``.

        ``follow``: prove that drives follow commands; ``watchdog``: prove that they stop by themselves when our
        heartbeat is withheld for ``withhold_s``.
        """
        self.devices = devices
        self.follow, self.watchdog, self.withhold_s = follow, watchdog, withhold_s
        self.failure = ""
        self.stage = ProofStage.ENABLE if follow or watchdog else ProofStage.RESTORE
        self.since_s = nan
        self.reset_s = -inf
        self.reported: dict[str, float] = {}
        """Drives that reported the missing signal, and when the EMCY arrived, s after the last heartbeat sent."""
        self.withheld_s = nan
        self._asked: set[str] = set()
        self._ran_on: set[str] = set()

    # -- by a kind ------------------------------------------------------------------------------------------

    def begin(self, now: float) -> None:
        """Begin to creep; every drive is in operation."""

    def move(self, now: float, elapsed: float) -> bool:
        """Continue the motion for ``elapsed`` s since ``begin``; return whether the drives creep, and follow if
        required.
        """
        return True

    def stand(self) -> None:
        """Command zero to every drive that has a speed."""
        for drive in self.devices.drives:
            if drive.config.mode == "velocity":
                drive.target = 0.0

    def still(self) -> bool:
        """Return whether every drive is at rest."""
        return all(abs(drive.actual) <= STANDING_SHARE * drive.config.max_speed for drive in self.devices.drives)

    # -- withholding ----------------------------------------------------------------------------------------

    def withhold(self, withheld: bool) -> None:
        """Withhold the signal that the drives watch (our heartbeat), or send it again."""
        self.devices.master.withhold_heartbeat = withheld

    def watched(self) -> list[ServoDrive]:
        """Return the drives that must stop by themselves."""
        return [drive for drive in self.devices.drives if drive.config.proves_watchdog]

    def ran_on(self, name: str) -> str:
        """Return the failure text for a drive that did not stop."""
        return (
            f"the {name} drive did not stop with EMCY 0x8130 when our heartbeat was missing"
            f" for {self.withhold_s * 1000:g} ms (0x1016, 0x6007)"
        )

    # ---------------------------------------------------------------------------------------------------------

    @property
    def done(self) -> bool:
        """Whether the proof is over, successful or not."""
        return self.stage is ProofStage.DONE or bool(self.failure)

    @property
    def provokes(self) -> bool:
        """Whether the proof has made drives stop by themselves and has not yet reset them."""
        if self.stage is ProofStage.RESTORE:
            return self.watchdog
        return self.stage in (ProofStage.WITHHOLD, ProofStage.STILL)

    def proven(self) -> str:
        """Return a line for the journal: what is proven, and what the rig file excludes."""
        shown, left_out = list(self.unloaded), list[str]()
        self.watchdogs(shown, left_out)
        text = f"shown: {', '.join(shown) or 'nothing'}"
        return f"{text}; NOT shown: {', '.join(left_out)}" if left_out else text

    def watchdogs(self, shown: list[str], left_out: list[str]) -> None:
        """Add what the proof showed of the drives to ``shown``, and the rest to ``left_out``."""
        (shown if self.follow else left_out).append("drives follow")
        for drive in self.devices.drives:
            proven = drive.config.name in self.reported
            (shown if proven else left_out).append(f"{drive.config.name} stops without our heartbeat")

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""
        if self.since_s != self.since_s:
            self.since_s = now
        for drive in self.devices.drives:
            for emergency in drive.take_emergencies():
                if emergency.code == self.emergency and self.stage in (ProofStage.WITHHOLD, ProofStage.STILL):
                    self.reported.setdefault(drive.config.name, emergency.t - self.withheld_s)
        if not self.failure:
            self._stage(now, now - self.since_s)
        if self.failure:
            self.stop()

    def stop(self) -> None:
        """Bring every drive to standstill and power off; stop withholding."""
        self.withhold(False)
        for drive in self.devices.drives:
            drive.goal = Goal.DISABLED
        self.stand()

    def _stage(self, now: float, elapsed: float) -> None:
        stage = self.stage
        if stage is ProofStage.ENABLE:
            self._enable(now, elapsed)
        elif stage is ProofStage.MOVE:
            if self.move(now, elapsed) and not self.failure:
                self._moved(now)
        elif stage is ProofStage.WITHHOLD:
            self._withhold(now, elapsed)
        elif stage is ProofStage.STILL:
            if self.still():
                self.enter(ProofStage.RESTORE, now)
            elif elapsed > STILL_S:
                self.failure = "a drive still turns after it should have stopped by itself"
        elif stage is ProofStage.RESTORE:
            self._restore(now, elapsed)

    def enter(self, stage: ProofStage, now: float) -> None:
        """Enter a stage at ``now``; a kind enters ``MOVE`` again for each of its moves."""
        self.stage = stage
        self.since_s = now

    def _enable(self, now: float, elapsed: float) -> None:
        late: list[str] = []
        for drive in self.devices.drives:
            drive.goal = Goal.ENABLED
            if drive.state is not State.OPERATION_ENABLED:
                late.append(drive.config.name)
        if not late:
            self.enter(ProofStage.MOVE, now)
            self.begin(now)
        elif elapsed > ENABLE_S:
            self.failure = f"not enabled after {ENABLE_S:g} s: {', '.join(late)}"

    def _moved(self, now: float) -> None:
        if not self.watchdog:
            self.enter(ProofStage.RESTORE, now)
            return
        self.reported.clear()
        self.withheld_s = now
        self.withhold(True)
        self.enter(ProofStage.WITHHOLD, now)

    def _withhold(self, now: float, elapsed: float) -> None:
        self._bring_back()
        if elapsed < self.withhold_s or self.devices.busy():
            return
        self.withhold(False)
        for drive in self.watched():
            name = drive.config.name
            if name not in self.reported or name in self._ran_on or drive.state is State.OPERATION_ENABLED:
                self.failure = self.ran_on(name)
                return
        self.stop()
        self.enter(ProofStage.STILL, now)

    def _bring_back(self) -> None:
        """Read the state of a drive that has left OPERATIONAL (it lacks object 0x1029), and start it again, disabled.

        Until then the drive sends no process data: no speed, and no safety inputs.
        """
        master = self.devices.master
        for drive in self.devices.drives:
            if drive.nmt_state != NmtState.PRE_OPERATIONAL or master.busy(drive):
                continue
            if drive.config.name not in self._asked:
                self._asked.add(drive.config.name)
                drive.goal = Goal.DISABLED
                master.start(drive, drive.ask())
                continue
            if drive.state is State.OPERATION_ENABLED:
                self._ran_on.add(drive.config.name)
            master.start(drive, drive.start_again())

    def _restore(self, now: float, elapsed: float) -> None:
        self.stop()
        devices = self.devices
        waiting = [
            drive.config.name
            for drive in devices.drives
            if drive.emergency is not None or not drive.online or drive.state > State.READY_TO_SWITCH_ON
        ]
        if not waiting:
            self.enter(ProofStage.DONE, now)
        elif elapsed > RESTORE_S:
            self.failure = f"not reset after the proof: {', '.join(waiting)}"
        elif self.provokes and elapsed > RESET_EVERY_S and now - self.reset_s > RESET_EVERY_S:
            self.reset_s = now
            for drive in devices.drives:
                drive.reset_fault()
