"""The device parameters of a rig: reads them, writes them to a file, and compares them with an earlier file."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter

from tester.base import clock
from tester.doctor.examination import Examination
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import title_of
from tester.run.kept import IDENTITY, KEPT, object_key, object_name
from tester.run.set_up import DeviceParameter, Parameters, mapped, stored, written, written_at_connect
from tester.store.run_reader import RunReader

FORMAT = 1
"""Version of the file format; a file of any other version is refused."""


class DumpError(ValueError):
    """A file is not a dump of parameters; the message gives the reason."""


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
        """Return the text of the dump's file, in JSON."""
        return json.dumps({"format": FORMAT, **asdict(self)}, indent=1, ensure_ascii=False) + "\n"


def dumped(e: Examination) -> ParameterDump:
    """Read the parameters of every device of a rig."""
    devices: dict[str, dict[str, DeviceParameter]] = {}
    silent: list[str] = []
    for name, config in e.rig.drives().items():
        answers = e.can.objects.get(config.node_id)
        if answers is None:
            silent.append(name)
            continue
        by_connect = written_at_connect(config)
        kept = (*IDENTITY, *KEPT, *written(config), *mapped(config))
        devices[name] = {
            object_key(key): DeviceParameter(answers[key].text, object_name(key), object_key(key) in by_connect)
            for key in kept if key in answers and answers[key].ok
        }  # fmt: skip
    for line in e.lines.values():
        for key, unit in line.units.items():
            device = title_of(e.rig, key)
            if not unit.there:
                silent.append(device)
                continue
            parameters = {"profile": DeviceParameter(unit.profile.name, unit.profile.title)}
            for name, answer in unit.configuration.items():
                if answer.ok:
                    value = str(int.from_bytes(answer.data, "big"))
                    parameters[f"0x{answer.question.address:04X}"] = DeviceParameter(value, name, name != "device type")
            devices[device] = parameters
    return ParameterDump(e.rig.name, clock.utc_now(), devices, tuple(silent))


def read_dump(path: Path) -> ParameterDump:
    """Return the dump in a file; raises DumpError, OSError."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        version = data.pop("format")
        if version == FORMAT:
            return TypeAdapter(ParameterDump).validate_python(data)
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        expected = "expected the output of `tester bus params dump`"
        raise DumpError(f"{path} is no dump of parameters ({expected}): {error}") from error
    raise DumpError(f"{path}: format {version} is not known (expected {FORMAT})")


def stored_in(rig: Rig, folder: Path) -> Parameters:
    """Return a run's stored parameters; raises StoreError, or DumpError if the run stored none."""
    with RunReader(folder) as reader:
        parameters = stored(rig, reader.parameters())
    if not parameters:
        raise DumpError(f"{folder.name} has no parameters on record: it was never connected")
    return parameters
