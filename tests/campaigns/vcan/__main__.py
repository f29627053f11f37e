"""`python -m tests.campaigns.vcan [--keep DIR]`: a recipe on a real vcan, and a second master on the same computer.

Boots user-mode Linux on this computer's own file system (Debian: user-mode-linux, kmod, iproute2, can-utils), makes a
vcan there, puts the simulated rig on it (`tester sim --can socketcan:vcan0`) and runs a short recipe with the rig
file's interface socketcan. Then it runs it again, and `cansend` resets a node in the middle of it.

The kernel has one processor, a system call takes about 30 us, and its host is shared: LIMITS widens the rig file's time
limits, and the reply limits of the three devices are 400 ms. As root the kernel runs with real-time priority (SCHED_RR
1): it needs half a processor for two minutes. Exit code 1 where a figure misses, 0 with a line "skipped" where a
program is missing.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import drivers.profiles
from tests.campaigns.acceptance.bench import ROOT
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.doors.__main__ import RECIPE, SAMPLE_SLIPS

PROGRAMS = {"linux.uml": "user-mode-linux", "insmod": "kmod", "ip": "iproute2", "cansend": "can-utils",
            "setpriv": "util-linux"}  # fmt: skip
"""Required programs, by Debian package."""
MODULES = Path("/usr/lib/uml/modules")
MEMORY = "2G"
PATIENCE_S = 900.0
FOREIGN = "000#8101"
"""NMT, reset node 1: no other program may send this."""
REPLY_MS = 400
PROFILES = {"load_cell": "four_axis_transmitter", "jacket": "simulated_jacket", "ir_thermometer": "calex_pyrominibus"}
LIMITS = {
    "scan.sliding": "50Hz",
    "can.consumer_heartbeat": "0.35s",
    "interlocks.silent_can_scans": "50",
    "interlocks.silent_can_heartbeats": "20",
    "interlocks.late_scan": "1s",
    "interlocks.stale_can_scans": "50",
    "interlocks.stale_can": "1s",
    "interlocks.stale_inputs": "1s",
    "interlocks.stale_cell": "1s",
    "interlocks.frozen_cell": "2s",
}
"""Packaged: 100 Hz, 0.2 s, 2.5, 1.5, 0.15 s, 2.5, 0.15 s, 0.25 s, 0.05 s, 0.5 s."""


def missing() -> list[str]:
    """Return the missing packages."""
    if sys.platform != "linux":
        return ["Linux"]
    search = os.pathsep.join((os.environ.get("PATH", ""), "/usr/sbin", "/sbin"))
    absent = [package for program, package in PROGRAMS.items() if shutil.which(program, path=search) is None]
    if not absent and not list(MODULES.glob("*/kernel/drivers/net/can/vcan.ko")):
        absent.append(f"vcan.ko below {MODULES}")
    return absent


def prepare(job: Path) -> None:
    """Write the files for the kernel's folder."""
    (job / "recipe.yaml").write_text(RECIPE.format(slip=SAMPLE_SLIPS), encoding="utf-8")
    settings = dict(LIMITS)
    for device, profile in PROFILES.items():
        text = (Path(drivers.profiles.__file__).parent / f"{profile}.toml").read_text(encoding="utf-8")
        text, changed = re.subn(r"(?m)^reply_max_ms = [0-9.]+", f"reply_max_ms = {REPLY_MS}", text)
        if changed != 1:
            raise ValueError(f"{profile}.toml has {changed} reply limits, expected one")
        (job / f"{profile}.toml").write_text(text, encoding="utf-8")
        settings[f"devices.{device}.profile"] = str(job / f"{profile}.toml")
    options = "--accept-risk slow-kernel " + " ".join(f"--set {key}={value}" for key, value in settings.items())
    known = {"JOB": job, "PYTHON": sys.executable, "ROOT": ROOT, "MODULES": MODULES, "FOREIGN": FOREIGN}
    lines = [f'{name}="{value}"' for name, value in {**known, "OPTIONS": options}.items()]
    (job / "environment").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shutil.copy(Path(__file__).with_name("inside.sh"), job / "init.sh")
    (job / "init.sh").chmod(0o755)


def boot(job: Path) -> None:
    """Run the kernel to its end."""
    command = [
        "linux.uml", f"mem={MEMORY}", "rootfstype=hostfs", "rootflags=/", "rw", f"init={job / 'init.sh'}",
        f"job={job}", "con0=fd:0,fd:1", "con=null", "quiet",
    ]  # fmt: skip
    if os.geteuid() == 0 and shutil.which("chrt"):
        command = ["chrt", "-r", "1", *command]
    with (job / "kernel.log").open("w", encoding="utf-8") as log:
        subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, timeout=PATIENCE_S, check=False
        )


def read(job: Path, name: str) -> str:
    """Return the contents of a file of the job, "" if it does not exist."""
    path = job / name
    return path.read_text(encoding="utf-8", errors="replace").strip() if path.exists() else ""


def coefficient(job: Path, name: str) -> tuple[float, float]:
    """Return a run's coefficient and its expanded uncertainty of this wheel; NaN if it has none."""
    for path in (job / name).glob("*/conditions.csv"):
        with path.open(encoding="utf-8-sig", newline="") as file:
            for row in csv.DictReader(file):
                if row["level"] == "condition" and row["mu"]:
                    return float(row["mu"]), float(row["u_expanded"])
    return math.nan, math.nan


def _why(log: str) -> str:
    """Return why a kernel did not come up, from its log."""
    if "set fp regs failed" in log:
        # Linux 6.1 keeps room for the registers of AVX-512; a processor with AMX has more of them.
        return "it has no room for this processor's registers (AMX): use another machine, or a newer user-mode-linux"
    return log[-300:]


def figures(job: Path) -> Iterator[Figure]:
    """Yield the figures."""
    failed = read(job, "failed") or ("" if read(job, "kernel") else f"no kernel: {_why(read(job, 'kernel.log'))}")
    yield holds("kernel with a vcan", not failed, failed or read(job, "kernel"), "boots")
    if failed:
        return
    yield holds("link", "vcan" in read(job, "link"), read(job, "link").replace("\n", " ")[:100], "vcan0, up")
    first = read(job, "first.err").splitlines()
    tried = [f"{name} run {read(job, f'{name}.attempts')}" for name in ("first", "second")]
    yield holds("attempts until the host let the kernel keep its time", True, ", ".join(tried), "no limit")
    yield equal("first run, exit code", read(job, "first.code"), "0")
    if read(job, "first.code") != "0":
        print("\n".join(first[:20]))
    mu, u = coefficient(job, "memory")
    other, other_u = coefficient(job, "first")
    yield at_most("coefficient off that in one process", abs(other - mu), math.hypot(u, other_u), digits=4)
    trip = next((line for line in read(job, "second.err").splitlines() if line.startswith("tripped")), "no trip")
    yield equal("run with a second master, exit code", read(job, "second.code"), "5")
    named = trip.startswith("tripped: second master")
    yield holds(f"its trip after cansend vcan0 {FOREIGN}", named, trip[:160], "second master")
    yield holds("the simulated rig", True, read(job, "sim.err") or "silent", "no limit")


def main(arguments: list[str] | None = None) -> int:
    """Boot and measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.vcan", description="A recipe on a real vcan.")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep logs and runs in this new folder")
    read = parser.parse_args(arguments)
    if absent := missing():
        print(f"skipped: not installed: {', '.join(absent)}")
        return 0
    missed = 0
    with TemporaryDirectory(prefix="vcan-", ignore_cleanup_errors=True) as temporary:
        job = (read.keep or Path(temporary)).resolve()
        job.mkdir(parents=True, exist_ok=True)
        prepare(job)
        try:
            boot(job)
        except subprocess.TimeoutExpired:
            print(f"MISS the kernel ends: not within {PATIENCE_S:g} s  [ends]")
            missed += 1
        for figure in figures(job):
            missed += not figure.ok
            print(figure, flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
