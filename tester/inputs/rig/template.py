"""The rig file that `tester rig init` writes: a packaged one with a real machine's wires in place of simulated ones."""

from __future__ import annotations

import re

from tester.inputs.rig.config import Rig
from tester.inputs.rig.packaged import packaged_text

HEADER = """\
# A rig: the machine's sizes, limits, buses, devices, loops and interlocks. No number of a test is here.
#
# Every number below is the simulated rig's. Go through all of them before the first run: [A] marks an engineering
# assumption, the axes' increments and the devices' profiles are those of your drives and transmitters. Limits and
# interlocks are operational; what must hold when this software fails is up to the drives, the jacket controller's own
# limit and the machine's hard-wired emergency stop.
#
# A number may stand bare: it then counts in the unit that the comment names. With a unit (1100 mm/s) it is converted.
# An unknown key is an error. `tester rig show --rig THIS_FILE` checks the file and prints it with everything resolved.
#
# Sources: "paper" is Polymers 2024, 16(5), 596, doi 10.3390/polym16050596; "CiA 301/402" are the CANopen and drive
# profiles.

"""

REPLACED = (
    (r"^rig: simulated ", "rig: "),
    (r"^simulated: true$", "simulated: false"),
    (r"^  interface: sim  ", "  interface: socketcan  "),
    (r'^  channel: ""  ', "  channel: can0  "),
    (r"# sim, or a python-can interface", "# a python-can interface"),
)
"""(what the packaged file says, what stands there for a real machine); each must be there exactly once."""
PORT = re.compile(r"^    port: sim( *# sim, )?", re.MULTILINE)
"""A line's port in the packaged file, the first with a comment that names the simulation."""

FIRST_KEY = "rig: "
SIMULATION = "# The simulated rig's physics."
"""From here on the packaged file is about the simulation only."""


def hardware_text(kind: type[Rig], like: str = "") -> str:
    """Return the commented file for a real machine; raises ValueError if the packaged file has lost a marked place."""
    text = packaged_text(kind, like)
    text = HEADER + text[_place(text, "\n" + re.escape(FIRST_KEY)) + 1 :]
    text = text[: _place(text, re.escape(SIMULATION))].rstrip() + "\n"
    for packaged, own in (*REPLACED, *((re.escape(before), after) for before, after in kind.real)):
        _place(text, packaged)
        text = re.sub(packaged, lambda _, own=own: own, text, count=1, flags=re.MULTILINE)
    ports = iter(range(len(text)))
    return PORT.sub(lambda found: _port(next(ports), found[1]), text)


def _port(number: int, comment: str | None) -> str:
    """Return the line of a real port; the comment behind it stays in its column."""
    named = f"    port: /dev/ttyUSB{number}"
    return named + (" " * (len("    port: sim") + len(comment) - len(named) - len("# sim, ")) + "# " if comment else "")


def _place(text: str, marked: str) -> int:
    """Return where a pattern that must be there exactly once begins."""
    found = [match.start() for match in re.finditer(marked, text, re.MULTILINE)]
    if len(found) != 1:
        raise ValueError(f"the packaged rig file holds {marked!r} {len(found)} times, not once")
    return found[0]
