"""What the devices of a rig are set to: read, written down, and held against what was written down before."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from drivers.axis import AxisConfig
from tester.base import clock
from tester.base.source import load_tree
from tester.doctor import wanted
from tester.doctor.examination import Examination
from tester.rig import Rig
from tester.rig.sensors import title_of
from tester.run.kept import IDENTITY, KEPT, object_key, object_name
from tester.store.catalogue import run_folders
from tester.store.reader import RunReader
from tester.store.records import StoredParameter
from tester.store.schema import StoreError
from tester.store.status import WENT_THROUGH

FORMAT = 1
"""Version of the file; another one is refused."""


class DumpError(ValueError):
    """A file that is no dump of parameters; the message says why."""


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
class ParameterDump:
    """The parameters of every device of a rig that answered."""

    rig: str
    taken_utc: str
    devices: Parameters
    silent: tuple[str, ...] = ()
    """Devices of the rig file that did not answer."""

    @property
    def text(self) -> str:
        """The dump as a file."""
        devices = {
            device: {
                key: {"value": one.value, "name": one.name, "written": one.written} for key, one in parameters.items()
            }
            for device, parameters in self.devices.items()
        }
        data = {"format": FORMAT, "rig": self.rig, "taken_utc": self.taken_utc, "devices": devices,
                "silent": list(self.silent)}  # fmt: skip
        return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


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


def dumped(e: Examination) -> ParameterDump:
    """Read what every device of a rig is set to."""
    devices: dict[str, dict[str, DeviceParameter]] = {}
    silent: list[str] = []
    for name, config in e.rig.drives().items():
        answers = e.can.objects.get(config.node_id)
        if answers is None:
            silent.append(name)
            continue
        written = _written(config)
        kept = (*IDENTITY, *KEPT, *wanted.written(config), *wanted.mapped(config))
        devices[name] = {
            object_key(key): DeviceParameter(answers[key].text, object_name(key), object_key(key) in written)
            for key in kept if key in answers and answers[key].ok
        }  # fmt: skip
    for line in e.lines.values():
        for key, unit in line.units.items():
            device = title_of(e.rig, key)
            if not unit.there:
                silent.append(device)
                continue
            found = {"profile": DeviceParameter(unit.profile.name, unit.profile.title)}
            for name, answer in unit.configuration.items():
                if answer.ok:
                    value = str(int.from_bytes(answer.data, "big"))
                    found[f"0x{answer.question.address:04X}"] = DeviceParameter(value, name, name != "device type")
            devices[device] = found
    return ParameterDump(e.rig.name, clock.utc_now(), devices, tuple(silent))


def read_dump(path: Path) -> ParameterDump:
    """Return the dump of a file; raises DumpError, OSError."""
    try:
        data = cast("dict[str, object]", json.loads(path.read_text(encoding="utf-8")))
        if data["format"] != FORMAT:
            raise DumpError(f"{path}: format {data['format']} is not known (expected {FORMAT})")
        devices = cast("dict[str, dict[str, dict[str, object]]]", data["devices"])
        parameters = {
            device: {
                key: DeviceParameter(str(one["value"]), str(one["name"]), bool(one["written"]))
                for key, one in found.items()
            }
            for device, found in devices.items()
        }
        silent = cast("list[str]", data["silent"])
        return ParameterDump(str(data["rig"]), str(data["taken_utc"]), parameters, tuple(map(str, silent)))
    except DumpError:
        raise
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        expected = "expected what `tester params dump` writes"
        raise DumpError(f"{path} is no dump of parameters ({expected}): {error}") from error


def stored(rig: Rig, rows: Iterable[StoredParameter]) -> Parameters:
    """Return what a run has stored of its devices, as far as a dump has it; the last value of each counts.

    Commands that a connect reads back are no set-up, and are left out.
    """
    written = {name: _written(config) for name, config in rig.drives().items()}
    kept = {object_key(key) for key in (*IDENTITY, *KEPT)}
    found: dict[str, dict[str, DeviceParameter]] = {}
    for row in rows:
        by_connect = row.device in written and row.parameter in written[row.device]
        if row.device not in written or by_connect or row.parameter in kept:
            found.setdefault(row.device, {})[row.parameter] = DeviceParameter(row.value, row.name, by_connect)
    return found


def _written(config: AxisConfig) -> set[str]:
    return {object_key(key) for key in (*wanted.written(config), *wanted.mapped(config))}


def stored_in(rig: Rig, folder: Path) -> Parameters:
    """Return what a run has stored; raises StoreError, DumpError where it has stored nothing."""
    with RunReader(folder) as reader:
        found = stored(rig, reader.parameters())
    if not found:
        raise DumpError(f"{folder.name} has no parameters on record: it was never connected")
    return found


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
