"""The commands of `tester`, in sections by what a person wants, as text: listing them imports none of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class CommandEntry(NamedTuple):
    """Where a command is defined (a module of tester.cli and its name there), and its line in the help page."""

    module: str
    attribute: str
    help: str


class CommandGroup(NamedTuple):
    """Rarely used commands under one name: `tester bus sdo`."""

    help: str
    commands: Mapping[str, CommandEntry]


Listed = CommandEntry | CommandGroup

BUS = CommandGroup(
    "Bus tools: record, sdo, params, eds.",
    {
        "record": CommandEntry("record_command", "record", "Record the frames of a live bus and its lines."),
        "sdo": CommandEntry("device_commands", "sdo", "Read or write an object of a CANopen node."),
        "params": CommandEntry("device_commands", "params", "Dump or compare the settings of all devices."),
        "eds": CommandEntry("eds_command", "eds", "Check a drive's data sheet against an axis."),
    },
)
NOTICES = CommandGroup(
    "Notices to people: check, test, list.",
    {
        "check": CommandEntry("notices_commands", "check", "Validate the settings; which cause goes where."),
        "test": CommandEntry("notices_commands", "trial", "Send a test by every channel."),
        "list": CommandEntry("notices_commands", "list_", "List the notices that wait."),
    },
)
RESULTS = CommandGroup(
    "Stored results: exclude, include, note, slip-ring.",
    {
        "exclude": CommandEntry("results_group", "exclude", "Leave a repeat out of the means."),
        "include": CommandEntry("results_group", "include", "Take an excluded repeat back into the means."),
        "note": CommandEntry("results_group", "note", "Write a note or tags on a run."),
        "slip-ring": CommandEntry("results_group", "slip_ring", "Analyse the slip ring's errors."),
    },
)
QUEUE = CommandGroup(
    "Recipes: add, list, move, skip, drop, start, stand, check, key.",
    {
        "add": CommandEntry("queue_group", "add", "Check a recipe and add it to the queue."),
        "list": CommandEntry("queue_group", "list_", "List the items and what the queue waits for."),
        "move": CommandEntry("queue_group", "move", "Move an item."),
        "skip": CommandEntry("queue_group", "skip", "Pass over an item, also the one that runs."),
        "drop": CommandEntry("queue_group", "drop", "Remove an item."),
        "start": CommandEntry("queue_group", "start", "Start the queue."),
        "stand": CommandEntry("queue_group", "stand", "Begin no further item."),
        "check": CommandEntry("queue_group", "check", "Until when the queue runs alone."),
        "key": CommandEntry("queue_group", "key", "Make or revoke a key for the queue's calendar."),
    },
)
SECTIONS: Mapping[str, Mapping[str, Listed]] = {
    "Try without a rig": {
        "new": CommandEntry("new_command", "new", "Write a recipe by answering five questions."),
        "check": CommandEntry("recipe_commands", "check", "Validate a recipe; every problem at once."),
        "plan": CommandEntry("plan_command", "plan", "List the steps of a recipe and how long they take."),
        "predict": CommandEntry("predict_command", "predict", "Compute a friction law for one condition."),
        "sweep": CommandEntry("sweep_command", "sweep", "Simulate a recipe for many seeds and rig keys."),
    },
    "Test": {
        "run": CommandEntry("run_command", "run", "Run a recipe on a rig, by default the simulated one."),
        "resume": CommandEntry("run_command", "resume", "Resume an interrupted run."),
        "queue": QUEUE,
        "tui": CommandEntry("tui_command", "tui", "Open the operator's screen."),
    },
    "Look at runs": {
        "runs": CommandEntry("runs_command", "runs", "List the stored runs."),
        "show": CommandEntry("result_commands", "show", "Show a run's results."),
        "replay": CommandEntry("tui_command", "replay", "Replay a stored run on the operator's screen."),
        "verify": CommandEntry("verify_command", "verify", "Check a run's files against its record."),
        "results": RESULTS,
    },
    "Analyse": {
        "compare": CommandEntry("compare_command", "compare", "Compare compounds or runs statistically."),
        "figure": CommandEntry("figure_command", "figure", "Draw a run's results."),
        "report": CommandEntry("report_command", "report", "Write a run's report as one HTML page."),
        "fit": CommandEntry("fit_command", "fit", "Fit a friction law to measured conditions."),
        "components": CommandEntry("components_command", "components", "Split adhesion and hysteresis."),
        "master": CommandEntry("master_command", "master", "Build a master curve over aT v, if there is one."),
        "paper": CommandEntry("paper_command", "paper", "Check the papers against their own data."),
    },
    "Set up a rig": {
        "rig": CommandEntry("rig_commands", "rig", "Write, show or upgrade a rig file."),
        "doctor": CommandEntry("doctor_command", "doctor", "Diagnose a rig without moving it."),
        "commission": CommandEntry("commission_command", "commission", "Commission a new rig step by step."),
        "bus": BUS,
        "sim": CommandEntry("sim_command", "sim", "Simulate a rig in real time on CAN and Modbus."),
    },
    "Serve": {
        "serve": CommandEntry("service_commands", "serve", "Run the service that owns the rig."),
        "page": CommandEntry("page_command", "page", "Open the rig's page for browsers."),
        "status": CommandEntry("service_commands", "status", "Print what the rig is doing."),
        "hold": CommandEntry("service_commands", "hold", "HOLD: lift, wait, keep the temperature."),
        "release": CommandEntry("service_commands", "release", "End a HOLD."),
        "ack": CommandEntry("service_commands", "ack", "Acknowledge alarms; this moves nothing."),
        "notices": NOTICES,
        "stop": CommandEntry("stop_command", "stop", "STOP the rig."),
    },
    "Files": {
        "export": CommandEntry("result_commands", "export", "Write a run's results as a table."),
        "materials": CommandEntry("materials_commands", "materials", "Import and check compounds, surfaces."),
        "schema": CommandEntry("recipe_commands", "schema", "Print a JSON Schema for your editor."),
    },
}
"""The commands by section, in the order of the help page. A test checks every entry against its module."""
COMMANDS: Mapping[str, Listed] = {name: entry for listed in SECTIONS.values() for name, entry in listed.items()}
"""The words that follow `tester`."""
