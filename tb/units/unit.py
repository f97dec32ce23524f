# SPDX-License-Identifier: Apache-2.0
"""Framework for the unit testbenches of ``rtl/lib`` and ``rtl/fold``.

A bench is a function that maps a module's parameters to the checks of an instance; most are one call of
:func:`checks`. All benches of a file share a simulation (:func:`runs`). Most references share no arithmetic with RTL
and model: they use Python integers and fractions. The other references are functions of the model.
"""

import inspect
import itertools
import math
import os
import random
import re
from collections.abc import Awaitable, Callable, Iterable, Sequence
from fractions import Fraction
from functools import partial
from typing import NamedTuple

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge
from cocotb.utils import get_sim_time

from tb.sim.timeout import timed_test

Vector = tuple[int, ...]
Parameters = dict[str, int]
Ports = dict[str, int]  # port -> word in one clock
Tests = dict[str, Callable[..., Awaitable[None]]]  # name -> check, a coroutine function of ``dut``

SEED = int(os.environ.get("COCOTB_RANDOM_SEED", "1"))
"""Seed of all unit simulations; the environment overrides it."""

EVERY = 1 << 14  # largest number of possible input vectors that is tested exhaustively


# ---- starting a simulation (pytest) ----------------------------------------------------------------------------------


class Case(NamedTuple):
    """A module, its bench, its parameter sets in ``make test``, and further parameter sets in ``make test-all``."""

    module: str
    bench: Callable[..., Tests]
    few: Sequence[Parameters]
    more: Sequence[Parameters] = ()


def simulation(pairs: Iterable[tuple[Case, Parameters]]) -> dict:
    """Return the arguments of :func:`tb.sim.runner.simulate` that simulate all pairs as instances in one top."""
    from tb.sim.sources import TOP, top_of

    pairs = list(pairs)
    instances = {
        "_".join([case.module, *(f"{k}{v}" for k, v in values.items())]): (case.module, values)
        for case, values in pairs  # for example ik_exact_W5_SQUARE0
    }
    file = pairs[0][0].bench.__module__
    return {"toplevel": TOP, "module": file, "top": top_of(instances), "name": "units", "seed": SEED}


def module_of(name: str) -> str:
    """Return the module's name, given an instance's or test's name: cut off the parameters, which are in capitals."""
    return re.search(r"ik(_[a-z0-9]+)+", name)[0]


def runs(cases: Sequence[Case]) -> tuple[Callable, Callable]:
    """Return two tests for the benches of a file: one for pytest, one for cocotb inside the simulation.

    The pytest test has a case per module for its `few` parameter sets, and a slow case for `more`. All selected `few`
    cases share a simulation, and so do all selected `more` cases.
    """
    from tb.sim.shared import Shared

    def options(group: str, names: list[str]) -> dict:
        return simulation((case, values) for case in cases if case.module in names for values in getattr(case, group))

    file, rows = cases[0].bench.__module__.rpartition(".")[2], []
    for group, slow in (("few", []), ("more", [pytest.mark.slow])):
        shared = Shared(f"{file}-{group}", partial(options, group), module_of)
        for module in (case.module for case in cases if getattr(case, group)):
            rows.append(pytest.param(shared, module, id=f"{module}-{group}", marks=[*slow, pytest.mark.bench(module)]))

    @pytest.mark.sim
    @pytest.mark.parametrize(("simulation", "name"), rows)
    def test(request, simulation, name):
        simulation.check(request, name)

    return test, cocotb_tests(cases)


def sets_of(names: str, *rows: Vector, **others: int) -> list[Parameters]:
    """Return one parameter set per row of values for the parameters ``names``; all sets include ``others``."""
    return [dict(zip(names.split(), row, strict=True)) | others for row in rows]


# ---- inside a simulation (cocotb) ------------------------------------------------------------------------------------


def cocotb_tests(cases: Sequence[Case]):
    """Return the cocotb test, parametrized with each check of each instance in the simulated top.

    Outside a simulation there are no instances. The design supplies the parameters of each instance and, if the bench
    takes ``**delays``, the delays of its ports.
    """
    benches = {case.module: case.bench for case in cases}
    checks = []
    for instance in getattr(cocotb, "top", ()):
        bench = benches[module_of(instance._name)]
        expected = inspect.signature(bench).parameters.values()
        names = "|".join("D[A-Z]" if one.kind is one.VAR_KEYWORD else one.name for one in expected)
        parameters = {handle._name: int(handle.value) for handle in instance if re.fullmatch(names, handle._name)}
        for name, test in bench(**parameters).items():
            checks.append(cocotb.Param((instance, test), f"{instance._name}.{name}"))

    @cocotb.parametrize(check=checks)
    @timed_test(name="vectors")
    async def vectors(top, check):
        instance, test = check
        await test(dut=instance)

    return vectors


def checks(
    inputs: dict[str, range],
    outputs: dict[str, range],
    reference: Callable,
    *streams: Callable[[], Iterable[Vector | int]],
    latency: int,
    columns: bool = False,
    delays: Parameters | None = None,
    corners: Iterable[tuple[Vector | int, Vector | int]] = (),
    good: Vector | int = 0,
    fits: Callable[..., bool] = lambda *vector: True,
) -> Tests:
    """Return the tests of a module without handshake; in each, a vector enters in every clock (:func:`stream`).

    ``inputs`` and ``outputs`` map ports to the range of their words. ``reference`` takes the words of one vector, or
    with ``columns`` the words of all vectors, one sequence per input. A vector of one word may be written as the word.

    - *named* drives each (vector, outputs) of ``corners`` whose words fit the ports, with ``good`` vectors around it.
    - *every_vector* if there are at most :data:`EVERY` vectors; otherwise *extremes*, all combinations of the
      :func:`corners` of the inputs, and *random_vectors*.
    - one test for each function or partial in ``streams``: it has the function's name and drives the vectors returned.

    Vectors that do not satisfy ``fits`` are skipped.
    """
    words = list(inputs.values())

    def expected(*operands):
        return reference(*operands) if columns else zip(*map(_row, map(reference, *operands)), strict=True)

    def named():
        for vector, wanted in ((_row(vector), _row(wanted)) for vector, wanted in corners):
            if all(word in of for word, of in zip(vector + wanted, (*words, *outputs.values()), strict=True)):
                reference = [column[0] for column in map(list, expected(*([word] for word in vector)))]
                assert reference == list(wanted), f"the reference of {vector} is {reference}, not {wanted}"
                yield from (good, vector, good, vector, vector, good)

    async def run(vectors, dut) -> None:
        chosen = [vector for vector in map(_row, vectors()) if fits(*vector)]
        await stream(dut, inputs, outputs, expected, chosen, latency, delays or {})

    streams = (named, *streams) if corners else streams
    generators = {getattr(vectors, "func", vectors).__name__: vectors for vectors in streams}
    if math.prod(map(size, words)) <= EVERY:
        generators["every_vector"] = lambda: shuffled(itertools.product(*words))
    else:
        generators |= {"extremes": partial(crossed, *words), "random_vectors": partial(some, 2000, *words)}
    return {name: partial(run, vectors) for name, vectors in generators.items()}


async def stream(dut, inputs, outputs, expected, vectors: list[Vector], latency: int, delays) -> None:
    """Drive one vector per clock without gaps, and compare every output ``latency`` clocks later.

    Inputs change after the rising edge. Outputs are sampled at the falling edge, when all ports have settled in both
    simulators, and compared as bits, so that X is a difference. A module's parameter DA delays its port ``a``, DB its
    port ``b``, and so on (``delays``: parameter -> clocks). So ``a`` is driven DA clocks early; ``latency`` counts from
    ports without delay.
    """
    assert vectors, "no vectors to check"
    for name, words in (inputs | outputs).items():
        bits = {len(getattr(dut, name)), len(getattr(dut.u, name))}  # wrapper and module port
        assert bits == {_bits(words)}, f"{name} has {bits} bits"
    Clock(dut.clk, 10, unit="ns").start()
    clocks = [delays.get(f"D{name[0].upper()}", 0) for name in inputs]
    before = max(clocks)
    ports = [
        (getattr(dut, name), k, size(words) - 1, before - clocks[k]) for k, (name, words) in enumerate(inputs.items())
    ]
    results = [getattr(dut, name) for name in outputs]
    rising, falling = RisingEdge(dut.clk), FallingEdge(dut.clk)
    rows = [vectors[0]] * before + vectors + [vectors[-1]] * (latency + before)
    got, times = [], []
    for clock in range(before, len(rows)):
        await rising
        for handle, k, mask, late in ports:
            handle.value = rows[clock - late][k] & mask
        await falling
        if clock >= latency + 2 * before:
            got.append([str(handle.value) for handle in results])
            times.append(get_sim_time("ns"))
    columns = expected(*zip(*vectors, strict=True))
    wanted = [list(map(_written, row, outputs.values())) for row in zip(*columns, strict=True)]
    wrong = [k for k, rows in enumerate(zip(got, wanted, strict=True)) if rows[0] != rows[1]]
    assert not wrong, (
        f"{dut._name}, latency {latency}, seed {SEED}: {len(wrong)} of {len(vectors)} vectors differ; "
        f"vector {wrong[0]} at {times[wrong[0]]:.0f} ns, {dict(zip(inputs, vectors[wrong[0]], strict=True))}: "
        f"{dict(zip(outputs, got[wrong[0]], strict=True))} instead of {wanted[wrong[0]]}"
    )


async def with_go(
    dut, vectors: Callable[[], Iterable[Ports]], clocks: int, expected: Callable[[list[Ports], Ports], Ports]
) -> None:
    """Drive the vectors in order with ``go`` = 1. In 3 of 10 clocks, ``go`` is 0; a random vector must have no effect.

    ``expected(taken, now)`` returns the outputs that are defined. ``taken`` has the inputs of all clocks with ``go``,
    newest last; ``now`` has the present inputs. Outputs are compared once ``taken`` has ``clocks`` entries.
    """
    Clock(dut.clk, 10, unit="ns").start()
    owed = list(vectors())
    taken: list[Ports] = []
    while len(taken) < len(owed):
        go = random.random() < 0.7
        now = owed[len(taken)] if go else random.choice(owed)
        await RisingEdge(dut.clk)
        dut.go.value = int(go)
        for port, word in now.items():
            getattr(dut, port).value = word
        await FallingEdge(dut.clk)
        if len(taken) >= clocks:
            wanted = expected(taken, now)
            outputs = {port: str(getattr(dut, port).value) for port in wanted}
            bits = {port: f"{word:0{len(outputs[port])}b}" for port, word in wanted.items()}
            assert outputs == bits, f"after {taken[-clocks:]} and with {now}: {outputs} instead of {bits}"
        if go:
            taken.append(now)


def _row(value: Vector | int) -> Vector:
    return value if isinstance(value, tuple) else (value,)


def _bits(words: range) -> int:
    return size(words).bit_length() - 1


def _written(value: int, words: range) -> str:
    assert int(value) in words, f"{value} does not fit {_bits(words)} bits"
    return format(int(value) & size(words) - 1, f"0{_bits(words)}b")


# ---- vectors ---------------------------------------------------------------------------------------------------------


def signed(width: int) -> range:
    """Return the range of signed words."""
    return range(-(1 << width - 1), 1 << width - 1)


def unsigned(width: int) -> range:
    """Return the range of unsigned words."""
    return range(1 << width)


BIT = range(2)


def size(words: range) -> int:
    """Return the number of words in a range; ``len`` fails for words of more than 62 bits."""
    return words.stop - words.start


def corners(words: range) -> list[int]:
    """Return both ends and the middle of a range, their neighbours, and the middle of the upper half."""
    low, high = words[0], words[-1]
    mid = (low + high + 1) // 2
    near = {low, low + 1, mid - 1, mid, mid + 1, (mid + high + 1) // 2, high - 1, high}
    return sorted(v for v in near if v in words)


def shuffled(vectors: Iterable) -> list:
    vectors = list(vectors)
    return random.sample(vectors, len(vectors))


def crossed(*words: range) -> list[Vector]:
    """Return all combinations of the :func:`corners` of several ranges."""
    return list(itertools.product(*map(corners, words)))


def some(count: int, *words: range) -> list[Vector]:
    """Return ``count`` random vectors: a third of words are uniform, a third of random size, a third near a corner."""
    return [tuple(_one(w) for w in words) for _ in range(count)]


def _one(words: range) -> int:
    kind = random.randrange(6)
    if kind < 2:
        return random.randrange(words.start, words.stop)
    if kind < 4:  # any magnitude
        value = random.getrandbits(random.randint(1, _bits(words))) * random.choice((1, -1))
    else:
        value = random.choice(corners(words)) + random.choice((-1, 0, 0, 1))
    return min(max(value, words[0]), words[-1])


def pairs(width: int, count: int = 1000) -> list[Vector]:
    """Return pairs of signed words in random order: all if width <= 6, else ``count``, of which a quarter have a 0."""
    word = signed(width)
    if width <= 6:
        return shuffled(itertools.product(word, word))
    rows = [(x * random.choice((0, 1, 1, 1)), y) for x, y in some(count, word, word)]
    return [row if random.random() < 0.8 else row[::-1] for row in rows]


# ---- references ------------------------------------------------------------------------------------------------------


def rounded(value: int, places: int) -> int:
    """Divide by 2^places and round half up."""
    return math.floor(Fraction(value, 1 << places) + Fraction(1, 2))


def wrapped(value: int, words: range) -> int:
    """Wrap a value to the range of words."""
    return (value - words[0]) % size(words) + words[0]
