"""State views of a run under way, for tests of their displays."""

from __future__ import annotations

from dataclasses import replace

from tester.base.screen import Check, Gate, SoakView, Value
from tester.kinds.wheel_on_belt.served.screen import MACHINE as MACHINE
from tester.service.state_view import (
    Alarm,
    BusView,
    ClientsView,
    DeviceView,
    DiskView,
    ManualView,
    PlanStep,
    PlanView,
    ProgressView,
    PromptView,
    RunView,
    StateView,
    TickView,
)

HOSTILE = "[/x] [bold]\x1b[31m\u202e$(rm) ' \" <b> \x00"
"""Text with a meaning for terminals, markup, shells, HTML: it must arrive and be shown unchanged."""


def value(key: str, label: str, unit: str, now: float | None, wanted: float | None, top: float) -> Value:
    """Return a value of good quality on a bar from 0 to ``top``."""
    return Value(key, label, unit, now, wanted, None, 0.9 * top, None, None, 0.0, top, 1, 0.05, "good")


def state(mode: str = "RUN") -> StateView:
    """Return the state of a run in its 17th condition of 55."""
    return StateView(
        mode=mode,
        mode_text="",
        mode_since_s=3600.0,
        t_s=7261.5,
        wall_s=7300.0,
        utc="2024-02-21T14:05:09.000Z",
        rig="sim",
        simulated=True,
        run=RunView(
            "2024-02-21T12-04-00-table-2", "runs/2024-02-21T12-04-00-table-2", "Table 2, compound 1#", "1#", "NR, N234",
            "A. Person", 1, True, 1.0, "2024-02-21T12:04:00.000Z", "running", "", None, (),
        ),
        progress=ProgressView(21, 60, "1#: 300 mm/s, 200 N, 40 degC", "measure", 17, 55, 3, 5, 19.0, 30.0, 4, 0.37,
                              7261.5, 22440.0, 300.0, "2024-02-21T20:19:09.000Z"),
        values=(
            value("friction", "Friction mu", "", 0.731, None, 2.0),
            value("load", "Load", "N", 199.6, 200.0, 500.0),
            value("slip", "Slip speed", "mm/s", 299.8, 300.0, 500.0),
            value("surface", "Surface temp", "°C", 40.4, 40.0, 100.0),
            value("hub", "Jacket", "°C", 118.2, None, 160.0),
            value("sideslip", "Sideslip", "°", 0.0, 0.0, 30.0),
        ),
        gates=tuple(Gate(key, True) for key in ("load", "speed", "slip", "temperature", "settling")),
        soak=SoakView(39.6, 40.0, 1.0, 190.0, 600.0, 300.0, 1800.0),
        alarms=(),
        prompt=None,
        manual=ManualView(None, ""),
        devices=(
            DeviceView("wheel", "drive", "can", 1, "operation enabled", True, 0.004, 0, 0, 0.0, ""),
            DeviceView("load cell", "load cell", "cell", 1, "", True, 0.012, 70000, 2, 1.0, ""),
        ),
        buses=(BusView("can", "can", 26.1, 0, "500 kbit/s"), BusView("cell", "modbus", 41.0, 2, "115200 baud")),
        disk=DiskView(50_000_000_000, 200_000_000, False),
        tick=TickView(100.0, 0.0009, 0),
        clients=ClientsView("", 0, 0),
        interrupted=(),
        preflight=(Check("guard closed", True, ""), Check("disk space", True, "50 GB free")),
    )  # fmt: skip


def with_alarm(view: StateView) -> StateView:
    """Return the state with an unacknowledged trip."""
    trip = Alarm(1, "overload", 1, "active", "normal force above the rig's limit", 461.0, 450.0, "N",
                 "the rig stands; nothing moves before it is acknowledged", "ack", True, 7261.5,
                 "2024-02-21T14:05:09.000Z")  # fmt: skip
    return replace(view, mode="LATCHED", mode_text="overload", alarms=(trip,))


def with_prompt(view: StateView, text: str = "install wheel 2: 1# (NR, N234)") -> StateView:
    """Return the state with a question that waits."""
    return replace(view, prompt=PromptView(1, text, 7261.5, "2024-02-21T14:05:09.000Z"))


def stale(view: StateView) -> StateView:
    """Return the state with every value ten seconds old."""
    return replace(view, values=tuple(replace(one, age_s=10.0, quality="stale") for one in view.values))


def hostile(view: StateView) -> StateView:
    """Return the state with hostile text wherever text comes from outside."""
    assert view.run is not None
    run = replace(view.run, recipe=HOSTILE, note=HOSTILE, operator=HOSTILE, compound=HOSTILE)
    return replace(with_prompt(view, HOSTILE), run=run, progress=replace(view.progress, title=HOSTILE, phase=HOSTILE))


def plan() -> PlanView:
    """Return four steps around the present one; their remaining time and the later steps' add up to ``state``'s."""
    return PlanView("Table 2, compound 1#", 60, 19, (
        PlanStep(19, "install", "install wheel 1 (1#)", "done", 60.0, 64.2, 60.0),
        PlanStep(20, "pre_grind", "pre-grind 4 min at 200 N", "done", 270.0, 268.8, 270.0),
        PlanStep(21, "heat", "heat to 40 degC", "now", 300.0, None, 310.0),
        PlanStep(22, "condition", "1#: 300 mm/s, 200 N, 40 degC", "later", 600.0, None, 600.0),
    ), 29700.0, 21540.0)  # fmt: skip
