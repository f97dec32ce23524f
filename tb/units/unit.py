# SPDX-License-Identifier: Apache-2.0
"""What the unit testbenches of ``rtl/lib`` and ``rtl/cores`` share.

``tb/test_<module>.py`` starts the simulations (:func:`run_unit`), ``tb/<module>.py`` holds their cocotb tests on top of
:class:`Unit`.  References are written without the RTL's or the model's arithmetic: Python integers and fractions, and
APyTypes for rounding and saturation (:func:`rounded`).
"""

from __future__ import annotations

import itertools
import json
import os
import random
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import cocotb
import pytest
from apytypes import APyFixedArray, OverflowMode, QuantizationMode
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

Vector = tuple[int, ...]

SEED = int(os.environ.get("COCOTB_RANDOM_SEED", "1"))
"""Of every simulation that :func:`run_unit` starts, unless the environment says otherwise."""


# ---- starting a simulation (pytest) ----------------------------------------------------------------------------------


def run_unit(module: str, sets: Sequence[dict[str, int]], tests: str | None = None, sim: str | None = None) -> Path:
    """Runs ``tb/units/<module>.py`` (or ``<tests>.py``) on an instance of ``module`` for each of the parameter sets.

    All of them stand in one top (tb/sim/shells.py).  ``sim`` is icarus or verilator (default: ``SIM``).  Raises
    ``SystemExit`` when a test or the build fails; the log names the set.
    """
    from tb.sim.runner import simulate
    from tb.sim.shells import TOP, top_of

    top = top_of({title(parameters): (module, parameters) for parameters in sets})
    return simulate(
        TOP,
        "tb.units.sets",
        top=top,
        env={
            "IK_BENCH": f"tb.units.{tests or module}",
            "IK_SETS": json.dumps({title(parameters): parameters for parameters in sets}),
        },
        name=module,
        seed=SEED,
        sim=sim,
    )


def with_sets(*few: dict[str, int], more: Sequence[dict[str, int]] = ()) -> Callable:
    """Gives a test lists of parameter sets, ``sets``: a few in the quick gate, and more in ``make test-all``."""
    groups = [pytest.param(few, id="few")]
    if more:
        groups.append(pytest.param(more, id="more", marks=pytest.mark.slow))
    return lambda test: pytest.mark.sim(pytest.mark.parametrize("sets", groups)(test))


def title(parameters: dict[str, int]) -> str:
    """A parameter set as a name, in Verilog and of tests."""
    return "_".join(f"{k}{v}" for k, v in parameters.items()).replace("-", "m")


# ---- inside a simulation (cocotb) ------------------------------------------------------------------------------------


def parameters() -> dict[str, int]:
    """The parameters of the instance that a bench is loaded for (tb/units/sets.py)."""
    return json.loads(os.environ["IK_PARAMETERS"])


def named(cases: Iterable[str]) -> list[cocotb.Param]:
    """Values for ``cocotb.parametrize`` that name their tests, however long they are."""
    return [cocotb.Param(case, case) for case in cases]


class Unit:
    """A module without handshake: a vector goes in at every clock, its outputs come ``latency`` clocks later.

    ``inputs``, ``outputs`` and ``signed`` name ports, separated by blanks.  ``expected`` maps a list of input vectors
    to the list of output vectors.  Inputs change after the rising edge, outputs are read at the falling edge, when both
    have settled in both simulators; outputs are compared as bits, so that an X is a difference.  One in a test: it owns
    the clock.

    A parameter DA is the delay of port ``a``, and so on: the port then gets its word of a vector so many clocks before
    ports without delay get theirs, and ``latency`` counts from these.
    """

    SHOWN = 4  # differences in a message

    def __init__(
        self,
        dut,
        inputs: str,
        outputs: str,
        expected: Callable[[Sequence[Vector]], Sequence[Vector]],
        *,
        latency: int,
        signed: str = "",
    ) -> None:
        self.dut = dut
        self.inputs = {name: getattr(dut, name) for name in inputs.split()}
        self.outputs = {name: getattr(dut, name) for name in outputs.split()}
        self.width = {name: len(handle) for name, handle in (self.inputs | self.outputs).items()}
        self.signed = set(signed.split())
        self.expected = expected
        delays = [parameters().get(f"D{name[0].upper()}", 0) for name in self.inputs]
        self.late = [max(delays) - delay for delay in delays]  # clocks from a vector's first word to each input's
        self.latency = latency + max(delays)
        self.last: Vector | None = None  # what was driven before
        self.clock = 0
        Clock(dut.clk, 10, unit="ns").start()

    # ---- what tests do -----------------------------------------------------------------------------------------------

    async def check(self, vectors: Iterable[Vector]) -> list[Vector]:
        """One vector a clock, without gaps; every output must be the expected one.  Returns what came out."""
        vectors = list(vectors)
        assert vectors, "no vectors to check"
        first = self.clock + 1
        seen = await self._drive(vectors, self.latency)
        got = seen[self.latency :]
        wanted = [self._bits(w) for w in self.expected(vectors)]
        assert len(wanted) == len(vectors), f"{len(wanted)} expectations for {len(vectors)} vectors"
        wrong = [k for k, (g, w) in enumerate(zip(got, wanted, strict=True)) if g != w]
        lines = [
            f"  vector {k} at clock {first + k}: {self._show(self.inputs, self._bits(vectors[k], self.inputs))} -> "
            f"expected {self._show(self.outputs, wanted[k])}, got {self._show(self.outputs, got[k])} "
            f"at clock {first + k + self.latency}"
            for k in wrong[: self.SHOWN]
        ]
        assert not wrong, "\n".join(
            [
                f"{self.dut._name}, latency {self.latency}, seed {SEED}: {len(wrong)} of {len(vectors)} vectors differ",
                *lines,
            ]
        )
        return [tuple(self._value(name, bits) for name, bits in zip(self.outputs, row, strict=True)) for row in got]

    async def check_corner(self, vector: Vector, outputs: Vector, good: Vector) -> None:
        """``vector`` gives ``outputs``; ``good`` vectors right before and right after it give what they should."""
        (reference,) = self.expected([vector])
        assert tuple(reference) == tuple(outputs), f"the reference gives {reference} for {vector}, not {outputs}"
        await self.check([good, vector, good, vector, vector, good, good])

    async def check_latency(self, quiet: Vector, other: Vector) -> None:
        """Measures the clocks from a single ``other`` among ``quiet`` vectors to each output; it must be the latency.

        Every output must differ between the two vectors.
        """
        a, b = (self._bits(w) for w in self.expected([quiet, other]))
        alike = [name for name, p, q in zip(self.outputs, a, b, strict=True) if p == q]
        assert not alike, f"{quiet} and {other} do not tell latencies apart: same {alike}"
        before, after = 2 * self.latency + 8, 2 * self.latency + 8
        await self._drive([quiet] * before, 0)
        seen = await self._drive([other] + [quiet] * after, 0)
        for k, name in enumerate(self.outputs):
            at = [clock for clock, row in enumerate(seen) if row[k] != a[k]]
            became = [seen[clock][k] for clock in at]
            assert (at, became) == ([self.latency], [b[k]]), (
                f"{self.dut._name}.{name}: one vector {other} among {quiet} changed it {at[:4]} clocks later to "
                f"{became[:4]}; expected {b[k]} after {self.latency} clocks, and only there"
            )

    # ---- inside ------------------------------------------------------------------------------------------------------

    async def _drive(self, vectors: Sequence[Vector], wait: int) -> list[list[str]]:
        """Drives the vectors and holds the last for ``wait`` more clocks; the outputs of each clock as bits."""
        rising, falling = RisingEdge(self.dut.clk), FallingEdge(self.dut.clk)
        inputs = [(handle, (1 << self.width[name]) - 1) for name, handle in self.inputs.items()]
        outputs = list(self.outputs.values())
        seen = []
        before = max(self.late)
        words = [self.last or vectors[0]] * before + [*vectors] + [vectors[-1]] * wait
        self.last = vectors[-1]
        for clock in range(before, len(words)):
            await rising
            for k, ((handle, mask), late) in enumerate(zip(inputs, self.late, strict=True)):
                handle.value = words[clock - late][k] & mask
            await falling
            self.clock += 1
            seen.append([str(handle.value) for handle in outputs])
        return seen

    def _bits(self, values: Vector, ports: Iterable[str] | None = None) -> list[str]:
        """Values (of the outputs, unless ``ports`` are given) as bits."""
        bits = []
        for name, value in zip(self.outputs if ports is None else ports, values, strict=True):
            width, signed = self.width[name], name in self.signed
            low, high = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
            assert low <= value <= high, f"{value} does not fit {name}, {width} bits"
            bits.append(format(int(value) & ((1 << width) - 1), f"0{width}b"))
        return bits

    def _value(self, name: str, bits: str) -> int:
        value = int(bits, 2)
        return value - (1 << len(bits)) if name in self.signed and bits[0] == "1" else value

    def _show(self, ports: Iterable[str], row: Sequence[str]) -> str:
        """Ports with their values, decimal and hexadecimal; bits where they are not known."""
        shown = []
        for name, bits in zip(ports, row, strict=True):
            known = set(bits) <= {"0", "1"}
            shown.append(f"{name}={self._value(name, bits)} (0x{int(bits, 2):x})" if known else f"{name}={bits}")
        return " ".join(shown)


# ---- vectors ---------------------------------------------------------------------------------------------------------


def signed(width: int) -> range:
    """All signed words."""
    return range(-(1 << width - 1), 1 << width - 1)


def unsigned(width: int) -> range:
    """All unsigned words."""
    return range(1 << width)


def corners(words: range) -> list[int]:
    """Both ends, the middle, three quarters and their neighbours."""
    low, high = words[0], words[-1]
    mid = (low + high + 1) // 2
    near = {low, low + 1, mid - 1, mid, mid + 1, (mid + high + 1) // 2, high - 1, high}
    return sorted(v for v in near if v in words)


def crossed(*words: range) -> list[Vector]:
    """The corners of all operands, each with each."""
    return list(itertools.product(*map(corners, words)))


def some(count: int, *words: range) -> list[Vector]:
    """Random vectors; a third of the operands uniform, a third of random magnitude, the rest at or next to a corner."""
    return [tuple(_one(w) for w in words) for _ in range(count)]


def _one(words: range) -> int:
    kind = random.randrange(6)
    if kind < 2:
        return random.randrange(words.start, words.stop)
    if kind < 4:  # any magnitude
        value = random.getrandbits(random.randint(1, (words.stop - words.start).bit_length() - 1))
        value *= random.choice((1, -1))
    else:
        value = random.choice(corners(words)) + random.choice((-1, 0, 0, 1))
    return min(max(value, words[0]), words[-1])


def pack(words: Sequence[int], width: int) -> int:
    """Words side by side, the first in the low bits."""
    return sum((w % (1 << width)) << k * width for k, w in enumerate(words))


def unpack(bits: int, width: int, count: int) -> list[int]:
    """The signed words that :func:`pack` put side by side."""
    words = [(bits >> k * width) % (1 << width) for k in range(count)]
    return [w - (1 << width) if w >> width - 1 else w for w in words]


# ---- references ------------------------------------------------------------------------------------------------------


def each(function: Callable[..., Vector]) -> Callable[[Sequence[Vector]], list[Vector]]:
    """A reference for one vector as a reference for many."""
    return lambda vectors: [function(*v) for v in vectors]


def fixed_point(values: Sequence[int], width: int, frac: int = 0) -> APyFixedArray:
    """Words of ``width`` bits, ``frac`` of them behind the point, as an APyTypes array."""
    return APyFixedArray([v & ((1 << width) - 1) for v in values], int_bits=width - frac, frac_bits=frac)


def rounded(values: APyFixedArray, width: int) -> tuple[list[int], list[int]]:
    """APyTypes' round half up to integers of ``width`` bits, saturated; and 1 where that saturated."""
    # A bit more than the value's own for the rounding, and no less than asked for.
    room = max(values.int_bits + 1, width)
    exact = _words(values.cast(int_bits=room, frac_bits=0, quantization=QuantizationMode.RND))
    words = _words(
        values.cast(int_bits=width, frac_bits=0, quantization=QuantizationMode.RND, overflow=OverflowMode.SAT)
    )
    return words, [int(w != e) for w, e in zip(words, exact, strict=True)]


def _words(values: APyFixedArray) -> list[int]:
    half = 1 << values.bits - 1
    return [(int(v) + half) % (2 * half) - half for v in values.to_bits()]
