"""Mistakes detectable without motion: the doctor examines a twin that differs from its rig file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import drivers.profiles
from drivers.canopen.node_config import NodeChannel, NodeConfig
from tester.doctor.finding import Severity
from tests.campaigns.mistakes.mistake import Mistake
from tests.campaigns.mistakes.written import Case, Rebuilt, Written, disagreement, printed, read_list

LIST: Final = Path(__file__).with_name("doctor.yaml")
DRIVES: Final = ("wheel", "belt", "press", "sideslip", "camber")


def _drives_of(profile: str, vendor: str) -> list[str]:
    return [f"axes.{axis}.{key}" for axis in DRIVES for key in (f"profile={profile}", f"vendor_id={vendor}")]


def _lines_of(setting: str) -> list[str]:
    return [f"lines.{line}.{setting}" for line in ("load_cell", "heat")]


CLEAN: Final[tuple[Written, ...]] = (
    *(
        Written(name, "", kind, keys, keys)
        for name, kind, keys in (
            ("sim", "sim", ()),
            ("grosch", "grosch", ()),
            ("pin-on-disc", "pin-on-disc", ()),
            ("drives of another make", "sim", _drives_of("nanotec", "0x26C")),
            ("drives of a third make", "sim", _drives_of("elmo_gold", "0x9A")),
            ("adapters at 8N2", "sim", _lines_of("stop_bits=2")),
            ("adapters that RTS switches", "sim", _lines_of("rts=high")),
        )
    ),
    Written("adapters that hear themselves", "", echo=True),
)
"""Rigs that match their files."""


@cache
def _looked(name: str, seed: int) -> tuple[list[str], str]:
    """Return the doctor's findings about a mistake's rig, and how its exit code contradicts the following run."""
    written, rebuilt = _BY_NAME[name]
    case = Case(written, seed, rebuilt)
    findings = case.findings()
    return printed(findings, Severity.NOTE), disagreement(findings, case.run())


def clean(seed: int) -> list[str]:
    """Return the warnings and faults found on a rig that matches its file, and a wrong exit code."""
    written = CLEAN[seed % len(CLEAN)]
    case = Case(written, seed)
    findings = case.findings()
    wrong = disagreement(findings, case.run())
    return printed(findings) + ([wrong] if wrong else [])


def mistakes_of(entries: Sequence[Written], rebuilt: dict[str, Rebuilt] | None = None) -> tuple[Mistake, ...]:
    """Return the mistakes of a list; ``rebuilt``: by name, further changes to their machines."""
    for entry in entries:
        _BY_NAME[entry.mistake] = entry, (rebuilt or {}).get(entry.mistake)
    return tuple(
        Mistake(
            entry.mistake, entry.named,
            lambda seed, name=entry.mistake: _looked(name, seed)[0],
            lambda seed, name=entry.mistake: _looked(name, seed)[1],
        )
        for entry in entries
    )  # fmt: skip


_BY_NAME: dict[str, tuple[Written, Rebuilt | None]] = {}


# -- machines that no key can describe
# --------------------------------------------------------------------------------------


def _a_stranger(rig: Any) -> Any:
    node = NodeConfig("stranger", 9, {"pressure": NodeChannel(0, "u16", 1.0, "Pa")})
    return replace(rig, can=replace(rig.can, nodes={"stranger": node}))


def _exchanged_lines(rig: Any) -> Any:
    """Each line's adapter leads to the other's devices, at the other's settings."""
    other = {"load_cell": "heat", "heat": "load_cell"}
    lines = {name: rig.lines[other[name]] for name in rig.lines}
    devices = {key: replace(device, line=other[device.line]) for key, device in rig.devices.items()}
    return replace(rig, lines=lines, devices=devices)


def _turned(folder: Path, rig: Any) -> Any:
    """The load cell sends the words of its numbers in the other order."""
    text = (Path(drivers.profiles.__file__).parent / "four_axis_transmitter.toml").read_text(encoding="utf-8")
    path = folder / "turned.toml"
    path.write_text('word_order = "low_first"\n' + text, encoding="utf-8")
    cell = replace(rig.devices["load_cell"], profile=str(path))
    return replace(rig, devices={**rig.devices, "load_cell": cell})


_FOLDER: Final = TemporaryDirectory()
_REBUILT: Final[dict[str, Rebuilt]] = {
    "a node that is not in the rig file": _a_stranger,
    "adapters of two lines exchanged": _exchanged_lines,
    "word order of the load cell": partial(_turned, Path(_FOLDER.name)),
}
MISTAKES: Final[tuple[Mistake, ...]] = mistakes_of(read_list(LIST), _REBUILT)
