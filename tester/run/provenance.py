"""Provenance stored with a run: software, libraries, rig, calibration, devices, bus counters."""

from __future__ import annotations

import json
import os
import platform
import shlex
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import recipes
from drivers.drives.reader import GENERIC
from tester import kinds
from tester.analysis.kelvin import KnownSlope
from tester.base import clock
from tester.base.plugins import plugins
from tester.inputs.materials.compound import compound_model
from tester.inputs.recipe.foreseen import known_slopes
from tester.inputs.recipe.loader import LoadedRecipe
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import title_of
from tester.inputs.rig.profiles import profile_of
from tester.inputs.rig.rig_files import risks_of
from tester.machine.devices import DeviceList
from tester.run.kept import object_key
from tester.run.kind_lookup import recipe_part, run_parts, served_kind
from tester.run.set_up import GoodRun
from tester.store.journal_records import StoredParameter
from tester.store.recorder import Recorder
from tester.store.records import ACCEPTED_RISK, EXTENSION, LOOSE_KEYS, Calibration, RunInfo, SessionInfo, StoredMaterial

LIBRARIES = ("friction-tester", "numpy", "pyarrow", "pydantic", "pymodbus", "pyserial", "python-can", "pyyaml")
"""Distributions whose versions are stored with a run."""

ABSENT = "not installed"
"""Version stored for a distribution that is not installed, for example one that belongs to an extra."""

PACKAGED = "packaged: "
"""Prefix of the source of a recipe that comes with the program."""

_GIT_AT_MOST_S = 2.0


def run_info(
    name: str,
    plan: Plan,
    recipe: LoadedRecipe,
    rig: Rig,
    *,
    seed: int = 0,
    operator: str = "",
    recipe_source: str = "",
    rig_source: str = "",
    risks: Mapping[str, str] | None = None,
    materials: Sequence[StoredMaterial] = (),
) -> RunInfo:
    """Return the record of a run's beginning for the store. ``risks``: as ``accepted_risks`` returns them."""
    return RunInfo(
        name=name,
        recipe_name=plan.name,
        recipe_text=recipe.tree.text,
        rig_text=rig.text,
        started_utc=clock.utc_now(),
        simulated=rig.simulated,
        kind=plan.kind,
        worn=served_kind(rig).machine.specimen,
        axes=recipe_part(rig).axes,
        seed=seed if rig.simulated else None,
        software_version=_version("friction-tester"),
        git_revision=git_revision(),
        operator=operator,
        recipe_source=recipe_source,
        rig_source=rig_source,
        calibration=calibration_of(rig),
        metadata={**plan.metadata, **(risks or {})},
        versions=library_versions(),
        terms=tuple(recipe_part(rig).terms(rig)),
        known=_known_slopes(plan, rig, materials),
        materials=tuple(materials),
    )


def _known_slopes(plan: Plan, rig: Rig, materials: Sequence[StoredMaterial]) -> tuple[KnownSlope, ...]:
    """Return the slopes of friction over temperature from the compounds' files, if they apply to the rubber on the
    rig.
    """
    if not recipe_part(rig).rubs_as_described(rig):
        return ()
    files = [file for file in materials if file.role == "compound" and file.text]
    return tuple(known_slopes(plan, {file.name: compound_model(file.text or "", file.file) for file in files}))


def accepted_risks(rig: Rig, reason: str, unmeasured: str = "") -> dict[str, str]:
    """Return the metadata about accepted risks: keys, and steps of commissioning that lack; empty for none."""
    risks = [*map(str, risks_of(rig)), *([unmeasured] if unmeasured else [])]
    return {ACCEPTED_RISK: reason, LOOSE_KEYS: "; ".join(risks)} if risks else {}


def session_info(number: int, origin_s: float, operator: str) -> SessionInfo:
    """Return the store's record of the stretch of the run that begins now."""
    return SessionInfo(
        session=number,
        origin_s=origin_s,
        started_utc=clock.utc_now(),
        host=platform.node(),
        pid=os.getpid(),
        operator=operator,
        software_version=_version("friction-tester"),
        git_revision=git_revision(),
        versions=json.dumps(library_versions()),
    )


def library_versions() -> dict[str, str]:
    """Return the versions of everything on which a result depends: libraries (ABSENT if not installed), Python,
    platform.

    They include every extension that this process has loaded, with its package and the hash of its file.
    """
    versions = {package: _version(package, ABSENT) for package in LIBRARIES}
    versions |= {f"{EXTENSION}{plugin.group}/{plugin.name}": plugin.describe() for plugin in plugins().loaded}
    return versions | {"python": platform.python_version(), "platform": platform.platform()}


def recipe_source(path: Path) -> str:
    """Return the source of a recipe, as it is stored: its path, or the name of a packaged recipe."""
    if path.parent == recipes.FOLDER:
        return f"{PACKAGED}{path.stem}"
    return str(path.absolute())


def rig_source(name: str, overrides: tuple[str, ...]) -> str:
    """Return the source of a rig, as it is stored: path or name of a packaged rig, then the overrides, quoted for a
    shell.
    """
    where = name if kinds.shipping(name) is not None else str(Path(name).absolute())
    return shlex.join([where, *overrides])


def calibration_of(rig: Rig) -> tuple[Calibration, ...]:
    """Return every figure that converts a device's reading into a quantity."""
    return tuple(_calibration_of(rig))


def _calibration_of(rig: Rig) -> Iterator[Calibration]:
    for key, config in rig.devices.items():
        device = title_of(rig, key)
        profile = profile_of(config.profile)
        yield Calibration(device, "profile", config.profile, "")
        for block in profile.blocks:
            for signal in block.signals:
                if signal.unit:
                    yield Calibration(device, f"scale of {signal.name}", repr(signal.scale), signal.unit)
                if signal.offset:
                    yield Calibration(device, f"offset of {signal.name}", repr(signal.offset), signal.unit)
        for name, value in config.parameters.items():
            unit = profile.writes[name].unit if name in profile.writes else ""
            yield Calibration(device, name, repr(value), unit or "1")
    for name, node in rig.can.nodes.items():
        for channel, datum in node.channels.items():
            yield Calibration(name, f"scale of {channel}", repr(datum.scale), datum.unit)
    for name, axis in rig.drives().items():
        yield Calibration(name, "velocity increments", repr(axis.velocity_increments), f"1/({axis.unit})")
        yield Calibration(name, "position increments", repr(axis.position_increments), f"1/({axis.unit})")
        yield Calibration(name, "rated torque", repr(axis.rated_torque_nm), "N m")
    yield from run_parts(rig).calibration(rig)


def read_back(rig: Rig, devices: DeviceList, now_s: float) -> Iterator[StoredParameter]:
    """Yield everything that was read from the devices before arming."""
    for drive in devices.drives:
        name, drive_profile = drive.config.name, drive.config.drive
        if drive_profile.name != GENERIC:
            yield StoredParameter(now_s, name, "profile", drive_profile.title, drive_profile.name)
        for key, value in drive.parameters.items():
            yield StoredParameter(now_s, name, object_key(key), "", str(value))
    for device in devices.modbus:
        name, profile = title_of(rig, device.name), device.driver.profile
        yield StoredParameter(now_s, name, "profile", profile.title, profile.name)
        if profile.identity is not None:
            register = f"0x{profile.identity.address:04X}"
            yield StoredParameter(now_s, name, register, "device type, as read back", str(profile.identity.value))


def record_parameters(
    rig: Rig, devices: DeviceList, recorder: Recorder, now_s: float, good: GoodRun | None = None
) -> str:
    """Store the parameters read from devices; return the differences from the last good run, "" if there are none."""
    rows = list(read_back(rig, devices, now_s))
    for row in rows:
        recorder.device_parameter(row.t_s, row.device, row.parameter, row.value, row.name)
    return good.differences(rig, rows) if good is not None else ""


def record_statistics(devices: DeviceList, recorder: Recorder, now_s: float) -> None:
    """Store the present counters of the buses."""
    recorder.bus_statistic(now_s, "can", "", "unknown frames", devices.master.unknown_frames)
    for drive in devices.drives:
        recorder.bus_statistic(now_s, "can", drive.config.name, "malformed", drive.malformed)
    for node in devices.nodes:
        recorder.bus_statistic(now_s, "can", node.name, "malformed", node.malformed)
    for counted in devices.counted:
        counted.store(recorder, now_s)
    for number, (_, link) in enumerate(devices.lines, start=1):
        bus = f"line {number}"
        recorder.bus_statistic(now_s, bus, "", "garbage", link.garbage)
        for station in link.stations:
            counters, name = station.counters, f"unit {station.unit_id}"
            for counter in ("requests", "replies", "timeouts", "crc_errors", "garbage", "late"):
                recorder.bus_statistic(now_s, bus, name, counter, float(getattr(counters, counter)))
            for code, times in sorted(counters.exceptions.items()):
                recorder.bus_statistic(now_s, bus, name, f"exception {code:02X}", times)


def git_revision() -> str:
    """Return the revision of this program, with ``-dirty`` if files differ from it; empty outside a checkout."""
    root = Path(__file__).resolve().parent.parent
    if not (root / ".git").exists():
        return ""
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_GIT_AT_MOST_S, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()


def _version(package: str, absent: str = "unknown") -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return absent
