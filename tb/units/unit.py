# SPDX-License-Identifier: Apache-2.0
"""Framework for the unit testbenches of ``rtl/lib``.

``tb/units/test_<module>.py`` has a bench, a function from the module's parameters to the cocotb tests of such an
instance, and runs it on parameter sets (:func:`runs`). Most benches are one call of :func:`checks`. References avoid
the arithmetic of RTL and model: they use Python integers and fractions, and APyTypes for rounding and saturation
(:func:`rounded`).
"""

from __future__ import annotations

import itertools
import json
import math
import os
import random
from collections.abc import Awaitable, Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

import cocotb
import pytest
from apytypes import APyFixedArray, OverflowMode, QuantizationMode
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

from tb.sim.native_run import nodes_of

Vector = tuple[int, ...]
Parameters = dict[str, int]
Tests = dict[str, Callable[..., Awaitable[None]]]
"""cocotb tests by name, functions of ``dut``."""

SEED = int(os.environ.get("COCOTB_RANDOM_SEED", "1"))
"""Seed of every simulation started by :func:`run_unit`; the environment overrides it."""

EVERY = 1 << 16
"""Largest number of input vectors that is tested exhaustively."""


# ---- starting a simulation (pytest) ----------------------------------------------------------------------------------


def simulation(
    module: str, sets: Sequence[Parameters], bench: Callable[..., Tests] | None = None, flat: bool = False
) -> dict:
    """Return the arguments of :func:`tb.sim.runner.simulate` for the tests of ``bench`` on an instance of ``module``
    per parameter set, all in one top (tb/sim/wrapper_top.py). ``flat``: the netlist has no internal names."""
    from tb.sim.wrapper_top import TOP, top_of

    return {
        "toplevel": TOP,
        "module": "tb.units.sets",
        "top": top_of({title(parameters): (module, parameters) for parameters in sets}),
        "env": {
            "IK_BENCH": f"{bench.__module__}:{bench.__name__}" if bench else "",
            "IK_SETS": json.dumps({title(parameters): parameters for parameters in sets}),
            "IK_FLAT": "1" if flat else "",
        },
        "name": module,
        "seed": SEED,
    }


def run_unit(
    module: str, sets: Sequence[Parameters], bench: Callable[..., Tests] | None = None, sim: str | None = None
) -> Path:
    """Run :func:`simulation`.

    ``sim`` is icarus or verilator (default: ``SIM``). Raises ``SystemExit`` when a test or the build fails; the log
    names the set.
    """
    from tb.sim.runner import simulate

    return simulate(**simulation(module, sets, bench), sim=sim)


def runs(module: str, bench: Callable[..., Tests], *few: Parameters, more: Sequence[Parameters] = ()) -> Callable:
    """Return a test of ``bench`` on a module: a few parameter sets in the quick gate, and more in ``make test-all``.

    Its attribute ``simulations`` is the module and :func:`simulation` of each group, for tb/mutation.
    """
    groups = [pytest.param(few, id="few")]
    if more:
        groups.append(pytest.param(more, id="more", marks=pytest.mark.slow))

    @pytest.mark.sim
    @pytest.mark.parametrize("sets", groups)
    def test(sets):
        run_unit(module, sets, bench)

    test.simulations = module, {group.id: partial(simulation, module, *group.values, bench) for group in groups}
    return test


def stops(module: str, *sets: Parameters, says: str) -> Callable:
    """Return a test that each parameter set stops the build with a message that contains ``says``."""

    @pytest.mark.parametrize("parameters", sets, ids=title)
    def test(parameters, caplog):
        with pytest.raises(SystemExit):
            run_unit(module, [parameters], sim="icarus")
        assert says in caplog.text

    return test


def title(parameters: Parameters) -> str:
    """Return a parameter set's name, valid in Verilog and as a test ID."""
    return "_".join(f"{k}{v}" for k, v in parameters.items()).replace("-", "m")


def sets_of(names: str) -> Callable[..., Parameters]:
    """Return a function from the values of these parameters, and others by name, to a parameter set."""
    return lambda *values, **others: dict(zip(names.split(), values, strict=True)) | others


def instances(op: str, count: int, of: Callable[..., Parameters]) -> list[Parameters]:
    """Return the distinct parameter sets of an operator in the paper datapath of 32 and 18 bits, ``count`` per width.

    ``of`` makes one from the width and the formats of operands and result.
    """
    found = []
    for width in (32, 18):
        nodes = [node for node in nodes_of("paper", width) if node.op == op]
        sets = [of(width, *(n.format for n in (*node.operands, node))) for node in nodes]
        found += [one for k, one in enumerate(sets) if one not in sets[:k]]
    assert len(found) == 2 * count, found
    return found


# ---- inside a simulation (cocotb) ------------------------------------------------------------------------------------


def inside(test: Callable[..., Awaitable[None]]) -> Callable[..., Awaitable[None]]:
    """Mark a test that accesses module internals."""
    test.inside = True
    return test


def places(memory: str, count: int, width: int) -> Callable[..., Awaitable[None]]:
    """Return a test of a memory's size: one more location or bit may not fit the block RAMs of a chip."""

    @inside
    async def counted(dut) -> None:
        if cocotb.SIM_NAME.startswith("Icarus"):  # Verilator does not expose memories
            found = getattr(dut.u, memory)  # inside the shell of tb/sim/wrapper_top.py
            assert (len(found), len(found[0])) == (count, width), f"{len(found)} places of {len(found[0])} bits"

    return counted


def built(block: str, there: bool) -> Callable[..., Awaitable[None]]:
    """Return a test for the presence of a generate block whose variants compute the same words but differ in size."""

    @inside
    async def found(dut) -> None:
        assert hasattr(dut.u, block) == there, f"{block} is {'not ' if there else ''}there"

    return found


def checks(
    inputs: dict[str, range],
    outputs: dict[str, range],
    expected: Callable[..., Sequence[Sequence[int]]],
    *streams: Callable[[], Iterable[Vector | int]],
    latency: int,
    latencies: Sequence[tuple[Vector | int, Vector | int]],
    delays: Parameters | None = None,
    still: Sequence[str] = (),
    corners: dict[str, tuple[Vector | int, Vector | int]] | None = None,
    good: Vector | int = 0,
    fits: Callable[..., bool] = lambda *vector: True,
    also: Callable[[list[Vector], list[Vector]], None] = lambda vectors, got: None,
) -> Tests:
    """Return the tests of a module without handshake.

    ``inputs`` and ``outputs`` map ports to their words; ``expected``, ``latency`` and ``delays`` are as in
    :class:`Unit`. A vector of one word may be written as the word.

    - *latency*: measured between the two vectors of each of ``latencies``, for all outputs except ``still``.
    - *corner_<name>*: each of ``corners``, vector and outputs, between ``good`` vectors; omitted if a word does not fit
      its port.
    - *extremes*: all combinations of the corners of each operand.
    - *every_vector* if there are at most :data:`EVERY`, otherwise *random_vectors*.
    - each of ``streams``, by its name: its vectors, one per clock.

    Stream vectors that do not satisfy ``fits`` are skipped; ``also`` is an additional check of vectors and outputs.
    """
    words = inputs.values()

    def every_vector():
        vectors = list(itertools.product(*words))
        random.shuffle(vectors)
        return vectors

    def random_vectors():
        return some(3000, *words)

    def unit(dut) -> Unit:
        return Unit(dut, inputs, outputs, expected, latency, delays or {})

    async def measured(dut) -> None:
        bench, told = unit(dut), set()
        for quiet, other in latencies:
            told |= await bench.check_latency(_row(quiet), _row(other))
        assert told == set(outputs) - set(still), f"the latency was measured of {sorted(told)} only"

    async def corner(vector, wanted, dut) -> None:
        await unit(dut).check_corner(vector, wanted, _row(good))

    async def stream(vectors, dut) -> None:
        chosen = [vector for vector in map(_row, vectors()) if fits(*vector)]
        also(chosen, await unit(dut).check(chosen))

    tests: Tests = {"latency": measured}
    for name, case in (corners or {}).items():
        vector, wanted = map(_row, case)
        if _all_in(vector, words) and _all_in(wanted, outputs.values()):
            tests[f"corner_{name}"] = partial(corner, vector, wanted)

    def extremes():
        return crossed(*words)

    general = every_vector if math.prod(map(size, words)) <= EVERY else random_vectors
    return tests | {vectors.__name__: partial(stream, vectors) for vectors in (extremes, general, *streams)}


def _row(value: Vector | int) -> Vector:
    return value if isinstance(value, tuple) else (value,)


def _all_in(values: Vector, words: Iterable[range]) -> bool:
    return all(value in of for value, of in zip(values, words, strict=True))


class Unit:
    """Bench of a module without handshake: takes a vector in every clock, with outputs ``latency`` clocks later.

    ``inputs`` and ``outputs`` map ports to their words. ``expected`` maps the words of each input, one sequence per
    port, to those on each output. Inputs change after the rising edge; outputs are sampled at the falling edge, when
    both have settled in both simulators, and compared as bits, so that X is a difference. The bench owns the clock: one
    per test.

    A delay DA belongs to port ``a``, and so on: this port gets its word of a vector DA clocks before the ports without
    delay, from which ``latency`` counts.
    """

    SHOWN = 4  # differences in a message

    def __init__(
        self, dut, inputs: dict[str, range], outputs: dict[str, range], expected, latency: int, delays: Parameters
    ) -> None:
        self.dut = dut
        self.inputs, self.outputs, self.expected = inputs, outputs, expected
        self.handles = {name: getattr(dut, name) for name in (*inputs, *outputs)}
        for name, words in (inputs | outputs).items():
            bits = {len(self.handles[name]), len(getattr(dut.u, name))}  # shell and module port
            assert bits == {size(words).bit_length() - 1}, f"{name} has {bits} bits"
        clocks = [delays.get(f"D{name[0].upper()}", 0) for name in inputs]
        self.late = [max(clocks) - delay for delay in clocks]  # clocks from a vector's first word to each input's
        self.latency = latency + max(clocks)
        self.last: Vector | None = None  # last driven vector
        self.clock = 0
        Clock(dut.clk, 10, unit="ns").start()

    # ---- checks ------------------------------------------------------------------------------------------------------

    async def check(self, vectors: list[Vector]) -> list[Vector]:
        """Drive one vector per clock without gaps, compare every output, and return the outputs."""
        assert vectors, "no vectors to check"
        first = self.clock + 1
        got = (await self._drive(vectors, self.latency))[self.latency :]
        wanted = self._wanted(vectors)
        wrong = [k for k, (g, w) in enumerate(zip(got, wanted, strict=True)) if g != w]
        lines = [
            f"  vector {k} at clock {first + k}: {_show(self.inputs, _bits(self.inputs, vectors[k]))} -> "
            f"expected {_show(self.outputs, wanted[k])}, got {_show(self.outputs, got[k])} "
            f"at clock {first + k + self.latency}"
            for k in wrong[: self.SHOWN]
        ]
        assert not wrong, "\n".join(
            [
                f"{self.dut._name}, latency {self.latency}, seed {SEED}: {len(wrong)} of {len(vectors)} vectors differ",
                *lines,
            ]
        )
        return [tuple(map(_value, self.outputs.values(), row)) for row in got]

    async def check_corner(self, vector: Vector, outputs: Vector, good: Vector) -> None:
        """Check that ``vector`` gives ``outputs`` and that ``good`` vectors right before and after it are correct."""
        assert self._wanted([vector]) == [_bits(self.outputs, outputs)], f"the reference of {vector} is not {outputs}"
        await self.check([good, vector, good, vector, vector, good, good])

    async def check_latency(self, quiet: Vector, other: Vector) -> set[str]:
        """Measure the clocks from one ``other`` among ``quiet`` vectors to each output and compare with the latency.

        Outputs equal for both vectors must not change. Return the changing ones, of which there must be at least one.
        """
        a, b = self._wanted([quiet, other])
        assert a != b, f"{quiet} and {other} do not tell latencies apart"
        room = 2 * self.latency + 8
        await self._drive([quiet] * room, 0)
        seen = await self._drive([other] + [quiet] * room, 0)
        for name, was, becomes, *row in zip(self.outputs, a, b, *seen, strict=True):
            changes = {clock: bits for clock, bits in enumerate(row) if bits != was}
            assert changes == ({self.latency: becomes} if becomes != was else {}), (
                f"{self.dut._name}.{name}: one vector {other} among {quiet} changed it to {changes} (clocks later: "
                f"bits); expected {becomes} after {self.latency} clocks, and only there"
            )
        return {name for name, was, becomes in zip(self.outputs, a, b, strict=True) if was != becomes}

    # ---- internals ---------------------------------------------------------------------------------------------------

    async def _drive(self, vectors: Sequence[Vector], wait: int) -> list[list[str]]:
        """Drive the vectors, hold the last for ``wait`` more clocks, and return each clock's outputs as bits."""
        rising, falling = RisingEdge(self.dut.clk), FallingEdge(self.dut.clk)
        inputs = [(self.handles[name], size(words) - 1) for name, words in self.inputs.items()]
        outputs = [self.handles[name] for name in self.outputs]
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

    def _wanted(self, vectors: Sequence[Vector]) -> list[list[str]]:
        """Return the expected outputs of vectors as bits."""
        rows = [_bits(self.outputs, row) for row in zip(*self.expected(*zip(*vectors, strict=True)), strict=True)]
        assert len(rows) == len(vectors), f"{len(rows)} expectations for {len(vectors)} vectors"
        return rows


def _bits(ports: dict[str, range], values: Iterable[int]) -> list[str]:
    """Return values of ports as bits."""
    bits = []
    for (name, words), value in zip(ports.items(), map(int, values), strict=True):
        width = size(words).bit_length() - 1
        assert value in words, f"{value} does not fit {name}, {width} bits"
        bits.append(format(value & (size(words) - 1), f"0{width}b"))
    return bits


def _value(words: range, bits: str) -> int:
    value = int(bits, 2)
    return value if value in words else value - size(words)


def _show(ports: dict[str, range], row: Sequence[str]) -> str:
    """Format ports with decimal and hexadecimal values; as bits if unknown."""
    return " ".join(
        f"{name}={_value(words, bits)} (0x{int(bits, 2):x})" if set(bits) <= {"0", "1"} else f"{name}={bits}"
        for (name, words), bits in zip(ports.items(), row, strict=True)
    )


# ---- vectors ---------------------------------------------------------------------------------------------------------


def signed(width: int) -> range:
    """Return all signed words."""
    return range(-(1 << width - 1), 1 << width - 1)


def unsigned(width: int) -> range:
    """Return all unsigned words."""
    return range(1 << width)


BIT = range(2)


def size(words: range) -> int:
    """Return the number of words; ``len`` fails above 63 bits."""
    return words.stop - words.start


def corners(words: range) -> list[int]:
    """Return both ends, the middle, three quarters, and neighbours."""
    low, high = words[0], words[-1]
    mid = (low + high + 1) // 2
    near = {low, low + 1, mid - 1, mid, mid + 1, (mid + high + 1) // 2, high - 1, high}
    return sorted(v for v in near if v in words)


def crossed(*words: range) -> list[Vector]:
    """Return all combinations of the operands' corners."""
    return list(itertools.product(*map(corners, words)))


def some(count: int, *words: range) -> list[Vector]:
    """Return random vectors: a third of the words uniform, a third of random magnitude, the rest close to a corner."""
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
    """Concatenate words, the first in the low bits."""
    return sum((w % (1 << width)) << k * width for k, w in enumerate(words))


def unpack(bits: int, width: int, count: int) -> list[int]:
    """Split the bits from :func:`pack` into signed words."""
    words = [(bits >> k * width) % (1 << width) for k in range(count)]
    return [w - (1 << width) if w >> width - 1 else w for w in words]


# ---- references ------------------------------------------------------------------------------------------------------


def each(function: Callable[..., Vector | int]) -> Callable[..., Iterator[Sequence[int]]]:
    """Turn a reference for one vector into a reference for many."""
    return lambda *columns: zip(*map(_row, map(function, *columns)), strict=True)


def fixed_point(values: Sequence[int], width: int, frac: int = 0) -> APyFixedArray:
    """Return words of ``width`` bits, ``frac`` of them fraction bits, as an APyTypes array."""
    return APyFixedArray([v & ((1 << width) - 1) for v in values], int_bits=width - frac, frac_bits=frac)


def rounded(values: APyFixedArray, width: int) -> tuple[list[int], list[int]]:
    """Round half up to saturated integers of ``width`` bits with APyTypes; also return 1 where a value saturated."""
    # One bit more than the value's own for rounding, and at least ``width``.
    room = max(values.int_bits + 1, width)
    exact = _words(values.cast(int_bits=room, frac_bits=0, quantization=QuantizationMode.RND))
    words = _words(
        values.cast(int_bits=width, frac_bits=0, quantization=QuantizationMode.RND, overflow=OverflowMode.SAT)
    )
    return words, [int(w != e) for w, e in zip(words, exact, strict=True)]


def _words(values: APyFixedArray) -> list[int]:
    half = 1 << values.bits - 1
    return [(int(v) + half) % (2 * half) - half for v in values.to_bits()]
