"""The rehearsed machines: one of each kind as `tester sim` provides it, and a short recipe for it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from tests.campaigns.acceptance.bench import COMMAND, ROOT

READY_S = 60.0
EXAMPLE = Path(__file__).parents[2] / "extension" / "examples" / "kind"


@dataclass(frozen=True, slots=True)
class Rehearsed:
    """A machine and its recipe. ``by_hand``: a person raises its arm after a kill; ``times``: speed of its clock and
    its runs'.
    """

    name: str
    rig: str
    recipe: str
    by_hand: bool = False
    example: bool = False
    """Whether its kind comes from the example package; its rig file is then written beside the recipe."""
    times: float = 1.0
    longest_s: float = 600.0
    """Time limit of a run, s."""


DISC = Rehearsed("pin-on-disc", "pin-on-disc", """\
recipe: rehearsal of a disc
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 2, min_valid: 1, distance: 60 mm, temperature_band: 5 K, soak: {within: 3 K, for: 1 s}}
grids:
  - {name: one, interface: [dry, wet], load: 10 N, temperature: 23 degC, track_speed: 0.2 m/s}
""", by_hand=True)  # fmt: skip
BLOCK = Rehearsed("grosch", "grosch", """\
recipe: rehearsal of a block
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 2, min_valid: 1, distance: 4 mm, soak: {within: 1 K, for: 2 s}}
grids:
  - {name: one, load: [10 N, 20 N], temperature: 23 degC, track_speed: 5 mm/s}
""")  # fmt: skip
WHEEL = Rehearsed("wheel", "sim", """\
recipe: rehearsal of a wheel
specimens: [{compound: "3#"}]
measure:
  wheel_speed: 0.8 m/s
  repeats: 2
  min_valid: 1
  window: 20 rev
  temperature_band: 20 K
  soak: {within: 5 degC, for: 1 s}
  max_bursts: 3
grids:
  - {name: one, slip_velocity: [100 mm/s, 200 mm/s], load: 100 N, temperature: 24.2 degC}
""")  # fmt: skip
SLEDGE = Rehearsed("a package's sledge", "sledge.yaml", """\
recipe: rehearsal of a sledge
specimens: [{compound: "1#"}, {compound: "3#"}]
measure: {repeats: 2, min_valid: 1, window: 10 rev}
grids: [{name: speed, speed: 20 mm/s}]
""", example=True)  # fmt: skip
EVERY = (DISC, BLOCK, WHEEL, SLEDGE)


def fast() -> tuple[Rehearsed, ...]:
    """Return the disc's packaged recipe whole, and the block's on one track at four temperatures, 5 times as fast.

    The block repeats each condition, because a difference is judged by its uncertainty, and soaks for 5 min.
    """
    files = [ROOT / "recipes" / f"{name}.yaml" for name in ("pin-on-disc", "grosch")]
    disc, block = (file.read_text(encoding="utf-8") for file in files)
    recipe = yaml.safe_load(block)
    recipe["measure"] |= {"repeats": 2, "soak": {"within": "0.5 K", "for": "5 min", "at_most": "3 h"}}
    (clean, _) = recipe["grids"]
    recipe["grids"] = [clean | {"surface": "silicon carbide", "temperature": [f"{c} degC" for c in (-10, 10, 30, 50)]}]
    text = yaml.safe_dump(recipe, sort_keys=False)
    return (
        Rehearsed(
            "pin-on-disc, whole, 5 times as fast", "pin-on-disc", disc, by_hand=True, times=5.0, longest_s=3600.0
        ),
        Rehearsed("grosch at four temperatures, 5 times as fast", "grosch", text, times=5.0, longest_s=7200.0),
    )


class Machine:
    """`tester sim` in a folder, at addresses that do not change on a restart."""

    def __init__(self, folder: Path, of: Rehearsed, door: str, seed: int) -> None:
        """Choose addresses and write the recipe; ``door``: TCP or ptys; ``seed``: of the simulated machine."""
        self.folder, self.of, self.seed = folder, of, seed
        folder.mkdir(parents=True)
        (folder / "recipe.yaml").write_text(of.recipe, encoding="utf-8")
        self.rig = of.rig
        if of.example:
            text = (EXAMPLE / "lab_sledge" / "rig.yaml").read_text(encoding="utf-8")
            self.rig = str(folder / of.rig)
            Path(self.rig).write_text(text.replace("kind: sledge", "kind: lab_sledge:KIND"), encoding="utf-8")
        first = free_port()
        self.console = f"127.0.0.1:{first}"
        (folder / "links").mkdir()
        places = ["--rtu", "--slcan", "--links", str(folder / "links")]
        self._options = places if door == "ptys" else ["--listen", f"127.0.0.1:{first + 1}"]
        self._process: subprocess.Popen[str] | None = None

    def start(self) -> None:
        """Start it, and wait until it is ready; raises ValueError with its output if it is not."""
        arguments = ["sim", "--speed", str(self.of.times), "--rig", self.rig, "--seed", str(self.seed)]
        arguments += ["--control", self.console.partition(":")[2]]
        arguments += ["--write-rig", str(self.folder / "rig.yaml"), *self._options]
        with (self.folder / "sim.err").open("a", encoding="utf-8") as errors:
            self._process = tester(arguments, errors)
        assert self._process.stdout is not None
        if not self._process.stdout.readline().startswith("ready: "):
            raise ValueError(f"tester sim: {(self.folder / 'sim.err').read_text(encoding='utf-8')}")

    def run(self) -> subprocess.Popen[str]:
        """Begin a run of the recipe on it, with answered prompts and simulated hands."""
        arguments = ["run", str(self.folder / "recipe.yaml"), "--rig", str(self.folder / "rig.yaml")]
        return self._program([*arguments, "--out", str(self.folder / "runs")])

    def resume(self, run: Path) -> subprocess.Popen[str]:
        """Resume a run on it in the same way."""
        return self._program(["resume", str(run)])

    def here(self, out: Path) -> subprocess.Popen[str]:
        """Run the recipe on the same rig inside one process."""
        with (self.folder / "here.err").open("a", encoding="utf-8") as errors:
            recipe = str(self.folder / "recipe.yaml")
            how = ["--rig", self.rig, "--seed", str(self.seed), "--yes", "--out", str(out)]
            return tester(["run", recipe, *how], errors)

    def command(self, line: str) -> str:
        """Type a line at its console and return the answer."""
        host, _, port = self.console.partition(":")
        with socket.create_connection((host, int(port)), timeout=10.0) as console:
            console.sendall(f"{line}\n".encode())
            answer = b""
            while not answer.endswith(b"\n\n"):
                answer += console.recv(4096)
        return answer.decode().strip()

    def kill(self) -> None:
        """End it as a power failure does."""
        if self._process is not None:
            self._process.send_signal(signal.SIGKILL)
            self._process.wait()
            self._process = None

    def _program(self, arguments: Sequence[str]) -> subprocess.Popen[str]:
        with (self.folder / "run.err").open("a", encoding="utf-8") as errors:
            speed = [] if self.of.times == 1.0 else ["--speed", str(self.of.times)]
            return tester([*arguments, *speed, "--yes", "--hands", self.console], errors)


def tester(arguments: Sequence[str], errors: object) -> subprocess.Popen[str]:
    """Start the product under test, with the example package on its path."""
    paths = (str(ROOT), str(EXAMPLE), os.environ.get("PYTHONPATH", ""))
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, *arguments], env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, text=True,  # type: ignore[call-overload]
    )  # fmt: skip


def free_port() -> int:
    """Return the first of ten consecutive ports; only the first is checked to be free."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return min(probe.getsockname()[1], 65000)
