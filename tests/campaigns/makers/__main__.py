"""`python -m tests.campaigns.makers [--sample] [--seed N]`: do the profiles fit the makers' register tables?

Each device is a slave built from its maker's table alone, independently of its profile; modbus_tk serves it. Numbers
drawn over the whole range of every channel must read within one step of the register. Each write must arrive as the
table requires. What the table forbids must be refused by name: values out of range, exceptions 1 to 3; while a device
fails or is busy (4, 6) no number is valid. No number is valid during any fault of the table, or while a device is
silent; all are valid afterwards. A device that restarts and misses a reply is set up again. A frequency inverter on
CAN, from the pages of five makers, is judged in the same way. Prints a line a figure; exit status 1 where one misses.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator

from drivers.profiles import load_profile
from tests.campaigns.acceptance.figure import Figure, at_least, equal
from tests.campaigns.makers import (
    calex_pyrominibus,
    calex_pyrousb,
    flintec_dad141,
    hygrometer_sht20,
    jumo_diratron,
    laumas_tlb,
    moxa_e1214,
    moxa_e1240,
    omron_e5cc,
    raytek_mi3,
    seneca_z_sg,
)
from tests.campaigns.makers.cases import Cases
from tests.campaigns.makers.controllers import ControllerCases
from tests.campaigns.makers.inverter_cases import InverterCases
from tests.campaigns.makers.seat import Tally, placed

SENSORS = (
    raytek_mi3.TABLE,
    flintec_dad141.TABLE,
    seneca_z_sg.TABLE,
    moxa_e1240.TABLE,
    moxa_e1214.TABLE,
    calex_pyrominibus.TABLE,
    calex_pyrousb.TABLE,
    hygrometer_sht20.TABLE,
    laumas_tlb.TABLE,
)
CONTROLLERS = (jumo_diratron.TABLE, omron_e5cc.TABLE)
ROUNDS, SAMPLE_ROUNDS = 200, 10
"""Readings, and writes of each parameter, by device."""
MOST_PRINTED = 40
LEAST_DEVICES = 5
KINDS = ("read", "write", "refuse", "fault")


def figures(rounds: int, seed: int) -> Iterator[Figure]:
    """Conduct the cases of every device; yield the figures."""
    tally, devices = Tally(), 0
    for table in (*SENSORS, *CONTROLLERS):
        made = ControllerCases if table in CONTROLLERS else Cases
        with placed(table) as place:
            source = random.Random(f"{table.profile} {seed}")
            made(place, load_profile(table.profile), source, tally).conduct(rounds)
        devices += 1
    InverterCases(random.Random(f"inverter {seed}"), tally).conduct(rounds)
    devices += 1
    for text in tally.wrong[:MOST_PRINTED]:
        print(f"     {text}")
    yield at_least("devices", devices, LEAST_DEVICES)
    yield at_least("numbers compared", tally.counts["numbers"], devices * rounds)
    for kind in KINDS:
        wrong = sum(text.startswith(kind) for text in tally.wrong)
        yield equal(f"wrong of {tally.counts[kind]} judged, {kind}", wrong, 0)


def main(arguments: list[str] | None = None) -> int:
    """Conduct the cases; return the exit status."""
    description = (__doc__ or "").partition("\n")[2]
    parser = argparse.ArgumentParser("python -m tests.campaigns.makers", description=description)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_ROUNDS} rounds instead of {ROUNDS}")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    options = parser.parse_args(arguments)
    missed = 0
    for figure in figures(SAMPLE_ROUNDS if options.sample else ROUNDS, options.seed):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
