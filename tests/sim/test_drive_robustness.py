"""Whatever comes over the wire, the simulated drive stays a drive: no exception, a legal state, bounded motion."""

from __future__ import annotations

import copy
from math import isfinite

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drivers import cia402
from drivers.cia402 import STATUS_BITS, State
from tests.sim.drive_bench import NODE, PC, PRESS, WHEEL, YAW, DriveBench

INDICES = (0x1003, 0x1010, 0x1016, 0x1017, 0x1400, 0x1600, 0x1800, 0x1A00, 0x6007, 0x6040, 0x605A, 0x6060, 0x6080)
INDICES += (0x6083, 0x6085, 0x6098, 0x607A, 0x607D, 0x60FE, 0x60FF, 0x6081)

BENCHES = [DriveBench(WHEEL).enabled(), DriveBench(PRESS).enabled(), DriveBench(YAW).enabled(1)]

sdo_writes = st.builds(
    lambda index, sub, size, data: (
        0x600 + NODE,
        bytes((0x23 | (4 - size) << 2, index & 0xFF, index >> 8, sub)) + data,
    ),
    st.sampled_from(INDICES),
    st.integers(0, 3),
    st.integers(1, 4),
    st.binary(min_size=4, max_size=4),
)
frames = st.one_of(
    st.tuples(st.just(0x600 + NODE), st.binary(max_size=8)),
    sdo_writes,
    st.tuples(st.just(0x200 + NODE), st.binary(min_size=6, max_size=6)),
    st.tuples(
        st.just(0x200 + NODE),
        st.sampled_from((0x06, 0x07, 0x0F, 0x1F, 0x3F, 0x02, 0x00, 0x80, 0x10F)).map(
            lambda word: bytes((word & 0xFF, word >> 8, 0x10, 0x27, 0, 0))
        ),
    ),
    st.tuples(st.sampled_from((0x200 + NODE, 0x300 + NODE)), st.binary(max_size=8)),
    st.just((0x080, b"")),
    st.just((0x700 + PC, b"\x05")),
    st.tuples(st.just(0x000), st.sampled_from((1, 2, 128, 130)).map(lambda command: bytes((command, NODE)))),
)


@pytest.mark.parametrize("number", range(len(BENCHES)))
@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(script=st.lists(st.tuples(frames, st.sampled_from((0.0, 0.001, 0.01, 0.1))), max_size=40))
def test_no_frame_breaks_the_drive(number: int, script: list[tuple[tuple[int, bytes], float]]) -> None:
    bench = copy.deepcopy(BENCHES[number])
    for (can_id, data), seconds in script:
        bench.send(can_id, data)
        if seconds:
            bench.drive.advance(bench.now, bench.now + seconds)
            bench.now += seconds
            bench.collect()
        drive = bench.drive
        assert cia402.decode(drive.statusword) is drive.state
        assert drive.statusword & 0x4F == STATUS_BITS[drive.state] & 0x4F
        assert isfinite(drive.axis.value)
        assert isfinite(drive.axis.position)
        assert drive.due_s > bench.now
    times = [t for t, _, _ in bench.heard]
    assert times == sorted(times)


@pytest.mark.parametrize("number", range(len(BENCHES)))
@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(script=st.lists(st.tuples(frames, st.sampled_from((0.001, 0.01, 0.1))), max_size=25))
def test_disable_voltage_always_ends_the_torque(
    number: int, script: list[tuple[tuple[int, bytes], float]]
) -> None:
    bench = copy.deepcopy(BENCHES[number])
    for (can_id, data), seconds in script:
        bench.send(can_id, data)
        bench.drive.advance(bench.now, bench.now + seconds)
        bench.now += seconds
    bench.nmt(128)
    bench.run(0.5)
    bench.send(0x600 + NODE, bytes.fromhex("2b40600000000000"))
    assert bench.drive.state in (State.SWITCH_ON_DISABLED, State.FAULT, State.FAULT_REACTION)
