"""`python -m tests.campaigns.notices [--sample] [--schedules N]`: notices through outages and kills.

Each schedule has some hours of notices in virtual time, and a real relay over loopback that is down, drops mails or
accepts them without an answer. The sender is killed after any byte that it writes to its outbox, and restarts; the
service repeats its notes. Counts lost, duplicate and misordered notices.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from socket import socketpair
from statistics import median
from time import process_time

from tester.notices.notice import Notice
from tester.notices.outbox_file import OutboxFile
from tester.service.address import UnixAddress
from tester.service.gateway_link import GatewayLink, LinkConfig
from tester.service.service_link import OwnerEnd
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, HEAD, NOON_S, OutboxScene, mail_settings, notice

SCHEDULES, SAMPLE_SCHEDULES = 200, 10
HOURS = 6.0
"""Length of a schedule, h of virtual time; then the relay is up until everything is sent."""
AFTER_S = 4.0 * 3600.0
COST_US = 100.0
"""Maximum cost of a notice to the scanning process, us: 1 % of a scan at 100 Hz [A]."""


class Killed(BaseException):
    """The sender is killed in the middle of a write."""


class KillableFile(OutboxFile):
    """An outbox whose process is killed once it has written ``left`` more bytes."""

    def __init__(self, path: Path, left: int) -> None:
        self.left = left
        super().__init__(path)

    def _write(self, data: bytes) -> None:
        if len(data) > self.left:
            os.write(self._file, data[: self.left])
            raise Killed
        self.left -= len(data)
        super()._write(data)


@dataclass
class Tally:
    """Totals of all schedules."""

    notices: int = 0
    kills: int = 0
    answers_lost: int = 0
    dropped: int = 0
    down_s: float = 0.0
    lost: int = 0
    doubled: int = 0
    unexcused: int = 0
    """Duplicates beyond the number of lost answers and kills, or with different bytes."""
    disorder: int = 0
    examples: list[str] = field(default_factory=list[str])


class Schedule:
    """One random schedule, the same for a seed."""

    def __init__(self, seed: int, folder: Path, relay: MailRelay, tally: Tally) -> None:
        self.random = Random(seed)
        self.seed, self.folder, self.relay, self.tally = seed, folder, relay, tally
        self.notices_sent: list[Notice] = []
        self.now_s = NOON_S - 4.0 * 3600.0  # away from the hour of the morning's message
        self.kills = self.losses = 0
        self.may_kill = True
        self.scene = self.started()

    def started(self) -> OutboxScene:
        """Start a sender, which receives all notes again; it may be killed during its start."""
        while True:
            left = int(self.random.expovariate(1 / 4000.0)) if self.may_kill else sys.maxsize
            try:
                file = KillableFile(self.folder / "outbox", left)
                scene = OutboxScene(self.folder, mail_settings(self.relay.port, to=[ANNA, HEAD], second=[]),
                                    now_s=self.now_s, file=file)  # fmt: skip
                for note in self.notices_sent:
                    scene.take(note)
            except Killed:
                self.kills += 1
            else:
                return scene

    def go_on(self, seconds: float) -> None:
        """Let time pass, with new senders after kills."""
        until_s = self.now_s + seconds
        while self.now_s < until_s:
            try:
                self.scene.pass_time(until_s - self.now_s)
            except Killed:
                self.kills += 1
                self.scene.close()
                self.now_s = self.scene.now_s + self.random.uniform(1.0, 60.0)
                self.scene = self.started()
            else:
                self.now_s = until_s

    def run(self) -> None:
        """Carry the schedule out, and count."""
        relay, random = self.relay, self.random
        relay.taken.clear()
        end_s = self.now_s + HOURS * 3600.0
        while self.now_s < end_s:
            relay.down = random.random() < 0.4
            wait_s = random.choice((0.0, 5.0, 60.0, 600.0, 3600.0)) * random.random()
            self.tally.down_s += wait_s * relay.down
            if random.random() < 0.3:
                relay.loses = 1
            if random.random() < 0.3:
                relay.drops = 1
            waiting = relay.loses, relay.drops
            for _ in range(random.choice((0, 1, 1, 1, 3))):
                self.notices_sent.append(notice(len(self.notices_sent) + 1))
                try:
                    self.scene.take(self.notices_sent[-1])
                except Killed:
                    self.kills += 1
                    self.scene.close()
                    self.scene = self.started()
            self.go_on(wait_s + 0.1)
            self.losses += waiting[0] - relay.loses
            self.tally.dropped += waiting[1] - relay.drops
        relay.down, self.may_kill = False, False
        waiting = relay.loses
        self.scene.close()
        self.scene = self.started()
        self.go_on(AFTER_S)
        self.losses += waiting - relay.loses
        self.scene.close()
        self.count()

    def count(self) -> None:
        """Compare the notices accepted by the relay with those sent by the service."""
        tally, bad = self.tally, list[str]()
        tally.notices += 2 * len(self.notices_sent)
        tally.kills += self.kills
        tally.answers_lost += self.losses
        expected = [one.what for one in self.notices_sent]
        doubled = 0
        for place in (ANNA, HEAD):
            mails = [mail for mail in self.relay.taken if mail.to == [place]]
            idents = Counter(mail.ident for mail in mails)
            first = {mail.ident: mail for mail in reversed(mails)}
            came = [str(mail.message["Subject"]).partition("trip: ")[2] for mail in mails]
            order = list(dict.fromkeys(came))
            doubled += sum(count - 1 for count in idents.values())
            lost = len(set(expected) - set(order))
            changed = sum(mail.raw != first[mail.ident].raw for mail in mails) + len(idents) - len(set(came))
            tally.lost += lost
            tally.unexcused += changed
            tally.disorder += order != expected
            if lost or changed or order != expected:
                bad.append(f"schedule {self.seed}, {place}: {lost} lost, {changed} changed")
        tally.doubled += doubled
        excess = max(doubled - self.losses - self.kills, 0)
        tally.unexcused += excess
        if excess:
            bad.append(f"schedule {self.seed}: {doubled} doubled, {self.losses} answers lost, {self.kills} kills")
        tally.examples += bad


def cost_us(count: int = 2000) -> float:
    """Return the median cost of a notice to the scanning process, us. Its gateway does not read."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ours, theirs = socketpair()
        link = GatewayLink(LinkConfig(UnixAddress(folder / "s"), folder / "card", folder, "sim"))
        link.adopt(OwnerEnd(ours))
        took: list[float] = []
        for number in range(count):
            note = notice(number)
            began = process_time()
            link.notify(note)
            took.append(process_time() - began)
        ours.close()
        theirs.close()
    return 1e6 * median(took)


def main(arguments: list[str] | None = None) -> int:
    """Measure; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.notices", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SCHEDULES} schedules")
    parser.add_argument("--schedules", type=int, default=SCHEDULES, metavar="N", help=f"schedules ({SCHEDULES})")
    read = parser.parse_args(arguments)
    schedules = SAMPLE_SCHEDULES if read.sample else read.schedules
    tally = Tally()
    with MailRelay() as relay:
        for seed in range(schedules):
            with tempfile.TemporaryDirectory() as folder:
                Schedule(seed, Path(folder), relay, tally).run()
    cost = cost_us()
    print(f"     {schedules} schedules of {HOURS:g} h: {tally.notices} notices to an address, relay down for "
          f"{tally.down_s / 3600.0:.0f} h, {tally.kills} kills, {tally.dropped} mails dropped, "
          f"{tally.answers_lost} answers lost, {tally.doubled} mails twice under one Message-ID")  # fmt: skip
    figures = [
        ("notices lost", f"{tally.lost}", "0", tally.lost == 0),
        ("doubled without a lost answer or a kill, or changed", f"{tally.unexcused}", "0", tally.unexcused == 0),
        ("addresses that got notices out of order", f"{tally.disorder}", "0", tally.disorder == 0),
        ("kills, answers lost, mails dropped", f"{tally.kills}, {tally.answers_lost}, {tally.dropped}", "some of each",
         min(tally.kills, tally.answers_lost, tally.dropped) > 0),
        ("cost of a notice for the process that scans", f"{cost:.0f} us", f"<= {COST_US:g} us", cost <= COST_US),
    ]  # fmt: skip
    for name, value, asked, met in figures:
        print(f"{'ok  ' if met else 'MISS'} {name}: {value} (asked: {asked})", flush=True)
    for example in tally.examples[:10]:
        print(f"     {example}")
    missed = sum(not met for *_, met in figures)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
