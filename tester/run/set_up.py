"""What devices were set to, as runs have it on record: what a connect writes, what differs from the last good run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.scan import Key
from drivers.drive_settings import plan
from tester.base.source import load_tree
from tester.inputs.rig import Rig
from tester.run.kept import IDENTITY, KEPT, object_key
from tester.store.catalogue import WENT_THROUGH, run_folders
from tester.store.reader import RunReader
from tester.store.records import StoredParameter
from tester.store.schema import StoreError

NAMED = 8
"""So many differences are told one by one at a run's start; of more the number is."""


def written(config: AxisConfig) -> dict[Key, int]:
    """Return what every connect writes into an axis' drive but for its process data, by object.

    What stands in for an object that the maker's drive lacks has another value, which follows from the drive: it is
    left out, as are homing parameters of an axis that is not homed.
    """
    made = plan(config)
    settings = [*made.settings, *made.homing] if config.mode == "position" else made.settings
    found = {one.key: one.value for one in settings if one.substitute is None}
    return found | {(o.PRODUCER_HEARTBEAT, 0): round(config.heartbeat_s * 1000)}


def mapped(config: AxisConfig) -> dict[Key, int]:
    """Return what every connect writes into the objects of an axis' process data, by object."""
    found: dict[Key, int] = {}
    for one in plan(config).pdos:
        if one.mapped is None:
            continue
        found[one.communication, 1] = one.cob_id
        found[one.communication, 2] = one.kind
        entries = one.mapped.parameters()
        found[one.mapping, 0] = len(entries)
        found |= {(one.mapping, sub): entry for sub, entry in enumerate(entries, start=1)}
    return found


@dataclass(frozen=True, slots=True)
class DeviceParameter:
    """One parameter as it was read."""

    value: str
    name: str = ""
    """What it is, in words."""
    written: bool = False
    """A connect writes it: where it differs before one, nothing is wrong."""


Parameters = Mapping[str, Mapping[str, DeviceParameter]]
"""By device, then by object (``0x6076:00``) or register (``0x0064``)."""


@dataclass(frozen=True, slots=True)
class ParameterDifference:
    """A parameter that is not what it was; ``str`` gives its line. ``was`` or ``found`` is None where it is missing."""

    device: str
    key: str
    name: str
    was: str | None
    found: str | None
    written: bool = field(default=False)
    """A connect writes it, so that it does not matter before one."""

    def __str__(self) -> str:
        """Return the line that is printed."""
        named = f" ({self.name})" if self.name else ""
        was = "missing" if self.was is None else self.was
        found = "missing" if self.found is None else self.found
        return f"{self.device} {self.key}{named}: was {was}, is {found}"


def stored(rig: Rig, rows: Iterable[StoredParameter]) -> Parameters:
    """Return what a run has stored of its devices, as far as a dump has it; the last value of each counts.

    Commands that a connect reads back are no set-up, and are left out.
    """
    written = {name: written_at_connect(config) for name, config in rig.drives().items()}
    kept = {object_key(key) for key in (*IDENTITY, *KEPT)}
    found: dict[str, dict[str, DeviceParameter]] = {}
    for row in rows:
        by_connect = row.device in written and row.parameter in written[row.device]
        if row.device not in written or by_connect or row.parameter in kept:
            found.setdefault(row.device, {})[row.parameter] = DeviceParameter(row.value, row.name, by_connect)
    return found


def written_at_connect(config: AxisConfig) -> set[str]:
    return {object_key(key) for key in (*written(config), *mapped(config))}


def last_good(rig: Rig, runs: Path) -> Path | None:
    """Return the folder of the newest run on a rig of this name that went through its plan; None: there is none."""
    for folder in sorted(run_folders(runs), key=lambda path: path.name, reverse=True):
        try:
            with RunReader(folder) as reader:
                run = reader.run()
        except StoreError:
            continue
        tree = load_tree(run.info.rig_text).data
        name = cast("dict[str, object]", tree).get("rig") if isinstance(tree, dict) else None
        if run.status == WENT_THROUGH and name == rig.name:
            return folder
    return None


def differences(before: Parameters, now: Parameters) -> list[ParameterDifference]:
    """Return what differs, of parameters that ``before`` has; by device, in its order."""
    found: list[ParameterDifference] = []
    for device, parameters in before.items():
        present = now.get(device, {})
        for key, one in parameters.items():
            other = present.get(key)
            if other is None or other.value != one.value:
                name = (other.name if other is not None else "") or one.name
                written = one.written or (other is not None and other.written)
                value = None if other is None else other.value
                found.append(ParameterDifference(device, key, name, one.value, value, written))
    return found


@dataclass(frozen=True, slots=True)
class GoodRun:
    """What the devices were set to in the last good run, and which that was: plain data."""

    name: str
    devices: Parameters

    def told(self, rig: Rig, rows: Iterable[StoredParameter]) -> str:
        """Return what of ``rows``, read while connecting, is not as it was then; "" where all is."""
        now = stored(rig, rows)
        before = {
            device: {key: one for key, one in parameters.items() if key in now[device]}
            for device, parameters in self.devices.items() if device in now
        }  # fmt: skip
        found = [str(one) for one in differences(before, now)]
        more = f"; and {len(found) - NAMED} more" if len(found) > NAMED else ""
        return f"not as in the last good run {self.name}: {'; '.join(found[:NAMED])}{more}" if found else ""


def last_good_run(rig: Rig, runs: Path) -> GoodRun | None:
    """Return the newest run on a rig of this name that went through its plan; None where none can be read."""
    folder = last_good(rig, runs)
    if folder is None:
        return None
    try:
        with RunReader(folder) as reader:
            return GoodRun(folder.name, stored(rig, reader.parameters()))
    except StoreError:
        return None
