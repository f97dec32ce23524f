# SPDX-License-Identifier: Apache-2.0
"""Every argument of dividers, square roots and reciprocal roots, checked by a native program.

Tests use short words; `make release-check` adds words of 16 and 32 bits, which take 12 minutes on two CPU cores.
"""

import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import pytest

from model.dataflow.formats import Latency
from model.dataflow.quadratic import INVERSE_ROOT
from tb.sim.env import ROOT, environment
from tb.sim.native_run import build

pytestmark = [pytest.mark.slow, pytest.mark.cost(20)]

PIECE = 1 << 23  # vectors per process, about one second


class Case(NamedTuple):
    """A module: its class in exhaustive.cpp, total argument width, latency in clocks, and parameters."""

    harness: str
    bits: int
    clocks: int
    parameters: dict[str, int]


def divider(width: int, shift: int) -> Case:
    """All pairs of signed words."""
    clocks = Latency(width)["div"]
    parameters = {"NW": width, "DW": width, "SH": shift, "QW": width, "LAT": clocks, "DIGIT": 1}
    return Case("Div", 2 * width, clocks, parameters)


def root(bits: int, argument: int, shift: int, width: int) -> Case:
    """All arguments of `bits` bits, in words of `argument` bits including the sign."""
    clocks = Latency(width)["root"]
    return Case("Root", bits, clocks, {"NW": argument, "SH": shift, "QW": width, "LAT": clocks, "DIGIT": 1})


def reciprocal(frac: int) -> Case:
    return Case("Rsqrt", frac + 3, 1 + INVERSE_ROOT.clocks(frac), {"F": frac})  # 1: the mantissa register


SHORT = {"div_8": divider(8, 6), "root_17": root(17, 17, 13, 12), "rsqrt_19": reciprocal(19)}
LONG = {
    "div_16_0": divider(16, 0),
    "div_16_14": divider(16, 14),
    "root_32": root(32, 33, 29, 32),  # arguments are not negative
    **{f"rsqrt_{frac}": reciprocal(frac) for frac in range(20, 25)},
}


def program(name: str, case: Case):
    harness = ROOT / "tb" / "units" / "exhaustive.cpp"
    top = f"ik_{case.harness.lower()}"
    return build(top, harness, case.parameters, name=name, define=f"CORE={case.harness}")


def failures(path, case: Case, vectors: range) -> tuple[int, str]:
    """Return the number of failures and a description of the first one."""
    parameters = [f"{name}={value}" for name, value in case.parameters.items()]
    command = [path, vectors.start, vectors.stop, case.bits, case.clocks, *parameters]
    done = subprocess.run([*map(str, command)], env=environment(), capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    count, first = done.stdout.split("\n")
    assert done.returncode == (count != "0")
    return int(count), first


@pytest.mark.parametrize("name", [*SHORT, *(pytest.param(name, marks=pytest.mark.release) for name in LONG)])
def test_every_argument(name):
    case = (SHORT | LONG)[name]
    path = program(name, case)
    pieces = [range(k, min(k + PIECE, 1 << case.bits)) for k in range(0, 1 << case.bits, PIECE)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for count, first in pool.map(lambda vectors: failures(path, case, vectors), pieces):
            assert not count, f"{count} failures; {first}"


@pytest.mark.parametrize("clocks", [-1, 1])
@pytest.mark.parametrize("name", SHORT)
def test_another_latency_fails(name, clocks):
    case = SHORT[name]
    assert failures(program(name, case), case._replace(clocks=case.clocks + clocks), range(10000))[0] > 1000
