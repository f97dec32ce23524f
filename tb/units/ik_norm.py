# SPDX-License-Identifier: Apache-2.0
"""``ik_norm`` against its definition: words times 2^count, as large as they may be together."""

import itertools
import random
from fractions import Fraction

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, crossed, each, named, pack, parameters, signed, some, unpack

P = parameters()
W, N = P["W"], P["N"]
WORDS = signed(W)
EXHAUSTIVE = W * N <= 12


def normalized(*words: int) -> tuple[list[int], int]:
    if not any(words):
        return [1 << W - 2] + [0] * (N - 1), 0
    count = max(s for s in range(W) if all(w << s in WORDS for w in words))
    return [w << count for w in words], count


def reference(d: int) -> tuple[int, int]:
    words, count = normalized(*unpack(d, W, N))
    return pack(words, W), count


def bench(dut) -> Unit:
    return Unit(dut, "d", "q count", each(reference), latency=Latency(32)["norm"])


async def check(dut, vectors) -> None:
    """What :class:`Unit` checks, and that the result is what it is for: of full size, in the same direction."""
    vectors = list(vectors)
    for words, (q, count) in zip(vectors, await bench(dut).check((pack(v, W),) for v in vectors), strict=True):
        mantissas = [Fraction(w, 1 << W - 1) for w in unpack(q, W, N)]
        most = max(map(abs, mantissas))
        assert Fraction(1, 2) <= most <= 1, f"{words} became {unpack(q, W, N)}, which does not fill the word"
        if any(words):
            assert unpack(q, W, N) == [w * 2**count for w in words], (
                f"{words} became {unpack(q, W, N)} with count {count}"
            )


CASES = {
    "zeros_become_one_half": ([0] * N, [1 << W - 2] + [0] * (N - 1), 0),
    "minus_ones": ([-1] * N, [WORDS[0]] * N, W - 1),
    "one": ([0] * (N - 1) + [1], [0] * (N - 1) + [1 << W - 2], W - 2),
    "largest": ([WORDS[-1]] * N, [WORDS[-1]] * N, 0),
    "least": ([WORDS[0]] * N, [WORDS[0]] * N, 0),
    "large_and_minus_one": ([WORDS[-1]] + [-1] * (N - 1), [WORDS[-1]] + [-1] * (N - 1), 0),
    "half_of_least": ([WORDS[0] // 2] + [1] * (N - 1), [WORDS[0]] + [2] * (N - 1), 1),
}


@cocotb.test()
async def latency(dut):
    """The count leaves with the words."""
    await bench(dut).check_latency((pack([WORDS[0]] * N, W),), (pack([1] * N, W),))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    words, q, count = CASES[case]
    await bench(dut).check_corner((pack(words, W),), (pack(q, W), count), good=(pack([WORDS[-1] // 4] * N, W),))


@cocotb.test()
async def extremes(dut):
    await check(dut, crossed(*[WORDS] * N))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = list(itertools.product(WORDS, repeat=N))
    random.shuffle(vectors)
    await check(dut, vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    """Words of any common magnitude, so that every count is met."""
    vectors = []
    for _ in range(1500):
        small = signed(random.randint(1, W))
        vectors.append(tuple(random.randrange(small.start, small.stop) for _ in range(N)))
    await check(dut, vectors + some(500, *[WORDS] * N))
