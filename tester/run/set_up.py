"""Device settings in stored runs: what each connection writes, and what differs from the last good run."""

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
from tester.store.journal_records import StoredParameter
from tester.store.record_schema import StoreError
from tester.store.run_folders import WENT_THROUGH, run_folders
from tester.store.run_reader import RunReader

NAMED = 8
"""Greatest number of differences listed at a run's start; further ones are only counted."""


def written(config: AxisConfig) -> dict[Key, int]:
    """Return what every connection writes into an axis' drive, by object, except for its process data.

    Left out are substitutes for objects that the drive lacks, because their values come from the drive, and the homing
    parameters of an axis that is not homed.
    """
    settings_plan = plan(config)
    settings = [*settings_plan.settings, *settings_plan.homing] if config.mode == "position" else settings_plan.settings
    values = {setting.key: setting.value for setting in settings if setting.substitute is None}
    return values | {(o.PRODUCER_HEARTBEAT, 0): round(config.heartbeat_s * 1000)}


def mapped(config: AxisConfig) -> dict[Key, int]:
    """Return what every connection writes into the objects of an axis' process data, by object."""
    values: dict[Key, int] = {}
    for pdo in plan(config).pdos:
        if pdo.mapped is None:
            continue
        values[pdo.communication, 1] = pdo.cob_id
        values[pdo.communication, 2] = pdo.kind
        entries = pdo.mapped.parameters()
        values[pdo.mapping, 0] = len(entries)
        values |= {(pdo.mapping, sub): entry for sub, entry in enumerate(entries, start=1)}
    return values


@dataclass(frozen=True, slots=True)
class DeviceParameter:
    """One parameter, as read from a device."""

    value: str
    name: str = ""
    """The parameter's name in words."""
    written: bool = False
    """Whether every connection writes the parameter, so that a difference before connecting is no fault."""


Parameters = Mapping[str, Mapping[str, DeviceParameter]]
"""Parameters by device, then by object (``0x6076:00``) or register (``0x0064``)."""


@dataclass(frozen=True, slots=True)
class ParameterDifference:
    """A changed parameter; ``str`` returns its printed line. ``was`` or ``found`` is None if that value is missing."""

    device: str
    key: str
    name: str
    was: str | None
    found: str | None
    written: bool = field(default=False)
    """Whether every connection writes the parameter, so that the difference does not matter before connecting."""

    def __str__(self) -> str:
        """Return the difference as the line to print."""
        named = f" ({self.name})" if self.name else ""
        was = "missing" if self.was is None else self.was
        now = "missing" if self.found is None else self.found
        return f"{self.device} {self.key}{named}: was {was}, is {now}"


def stored(rig: Rig, rows: Iterable[StoredParameter]) -> Parameters:
    """Return a run's stored device parameters, as far as a dump contains them; the last value of each counts.

    Leaves out commands that are read back while connecting, because they are not settings.
    """
    written = {name: written_at_connect(config) for name, config in rig.drives().items()}
    kept = {object_key(key) for key in (*IDENTITY, *KEPT)}
    parameters: dict[str, dict[str, DeviceParameter]] = {}
    for row in rows:
        by_connect = row.device in written and row.parameter in written[row.device]
        if row.device not in written or by_connect or row.parameter in kept:
            parameters.setdefault(row.device, {})[row.parameter] = DeviceParameter(row.value, row.name, by_connect)
    return parameters


def written_at_connect(config: AxisConfig) -> set[str]:
    return {object_key(key) for key in (*written(config), *mapped(config))}


def last_good(rig: Rig, runs: Path) -> Path | None:
    """Return the folder of the newest run that completed its plan on a rig of this name; None if there is none."""
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
    """Return the parameters of ``before`` that now differ, by device, in the order of ``before``."""
    changes: list[ParameterDifference] = []
    for device, parameters in before.items():
        present = now.get(device, {})
        for key, earlier in parameters.items():
            other = present.get(key)
            if other is None or other.value != earlier.value:
                name = (other.name if other is not None else "") or earlier.name
                written = earlier.written or (other is not None and other.written)
                value = None if other is None else other.value
                changes.append(ParameterDifference(device, key, name, earlier.value, value, written))
    return changes


@dataclass(frozen=True, slots=True)
class GoodRun:
    """The device settings of the last good run, and its name: plain data."""

    name: str
    devices: Parameters

    def differences(self, rig: Rig, rows: Iterable[StoredParameter]) -> str:
        """Return the differences between ``rows``, read while connecting, and the good run; "" if there are none."""
        now = stored(rig, rows)
        before = {
            device: {key: value for key, value in parameters.items() if key in now[device]}
            for device, parameters in self.devices.items() if device in now
        }  # fmt: skip
        lines = [str(difference) for difference in differences(before, now)]
        more = f"; and {len(lines) - NAMED} more" if len(lines) > NAMED else ""
        return f"differs from the last good run {self.name}: {'; '.join(lines[:NAMED])}{more}" if lines else ""


def last_good_run(rig: Rig, runs: Path) -> GoodRun | None:
    """Return the newest readable run that completed its plan on a rig of this name; None if there is none."""
    folder = last_good(rig, runs)
    if folder is None:
        return None
    try:
        with RunReader(folder) as reader:
            return GoodRun(folder.name, stored(rig, reader.parameters()))
    except StoreError:
        return None
