"""The rig file that `tester rig init` writes: the simulated rig's, with what a real machine has in its place."""

from __future__ import annotations

from tester.rig.load import packaged_text

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
    ("rig: simulated rubber friction tester\n", "rig: rubber friction tester\n"),
    ("simulated: true\n", "simulated: false\n"),
    ("  interface: sim  ", "  interface: socketcan  "),
    ('  channel: ""  ', "  channel: can0  "),
    ("    port: sim                       # sim, a", "    port: /dev/ttyUSB0              # a"),
    ("    port: sim\n", "    port: /dev/ttyUSB1\n"),
    ("# sim, or a python-can interface", "# a python-can interface"),
    ("the estimates and the thermal interlocks believe of the wheel. The simulated wheel behaves by `sim`\n",
     "the estimates and the thermal interlocks believe of the wheel. All [A].\n"),
    ("# below, so a wrong belief can be tried out: --set observer.friction_heat_fraction=0.2. All [A].\n", ""),
    ("# air around a real rig; the simulated rig's is sim.ambient", "# air around the rig"),
)  # fmt: skip
"""(text of the packaged file, what stands there for a real machine); each must be there exactly once."""

FIRST_KEY = "rig: "
SIMULATION = "# The simulated rig's physics."
"""From here on the packaged file is about the simulation only."""


def hardware_text() -> str:
    """Return the commented file for a real machine; raises ValueError if the packaged file has lost a marked place."""
    text = packaged_text()
    text = HEADER + text[_place(text, "\n" + FIRST_KEY) + 1 :]
    text = text[: _place(text, SIMULATION)].rstrip() + "\n"
    for packaged, own in REPLACED:
        _place(text, packaged)
        text = text.replace(packaged, own)
    return text


def _place(text: str, marked: str) -> int:
    """Return where a text that must be there exactly once begins."""
    if text.count(marked) != 1:
        raise ValueError(f"the packaged rig file holds {marked!r} {text.count(marked)} times, not once")
    return text.index(marked)
