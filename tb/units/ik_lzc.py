# SPDX-License-Identifier: Apache-2.0
"""``ik_lzc`` against its definition: the most places by which all words can go left and still fit."""

import itertools
import random

import cocotb

from model.dataflow.nodes import Latency
from tb.units.unit import Unit, crossed, each, named, pack, parameters, signed, some, unpack

P = parameters()
W, N = P["W"], P["N"]
WORDS = signed(W)
EXHAUSTIVE = W * N <= 12


def room(*words: int) -> int:
    if not any(words):
        return 0
    return max(s for s in range(W) if all(w << s in WORDS for w in words))


def bench(dut) -> Unit:
    return Unit(dut, "d", "count", each(lambda d: (room(*unpack(d, W, N)),)), latency=Latency(32)["lzc"])


CASES = {
    "zeros": ([0] * N, 0),
    "minus_ones": ([-1] * N, W - 1),
    "one": ([1] + [0] * (N - 1), W - 2),
    "last_minus_one": ([0] * (N - 1) + [-1], W - 1),
    "largest": ([WORDS[-1]] + [0] * (N - 1), 0),
    "least": ([0] * (N - 1) + [WORDS[0]], 0),
    "half_of_least": ([WORDS[0] // 2] + [0] * (N - 1), 1),
    "half_of_largest": ([0] * (N - 1) + [WORDS[-1] // 2], 1),
}


@cocotb.test()
async def latency(dut):
    await bench(dut).check_latency((pack([WORDS[0]] * N, W),), (pack([1] * N, W),))


@cocotb.test()
@cocotb.parametrize(case=named(CASES))
async def corner(dut, case):
    words, count = CASES[case]
    await bench(dut).check_corner((pack(words, W),), (count,), good=(pack([WORDS[-1] // 4] * N, W),))


@cocotb.test()
async def powers_of_two(dut):
    """Each power of two, its neighbours and their negatives, in each word alone."""
    near = sorted({s * (1 << k) + e for k in range(W) for s in (1, -1) for e in (-1, 0, 1)})
    await bench(dut).check((pack([0] * k + [v] + [0] * (N - 1 - k), W),) for k in range(N) for v in near if v in WORDS)


@cocotb.test()
async def extremes(dut):
    await bench(dut).check((pack(v, W),) for v in crossed(*[WORDS] * N))


@cocotb.test(skip=not EXHAUSTIVE)
async def all_words(dut):
    vectors = [(pack(v, W),) for v in itertools.product(WORDS, repeat=N)]
    random.shuffle(vectors)
    await bench(dut).check(vectors)


@cocotb.test(skip=EXHAUSTIVE)
async def random_words(dut):
    """Words of any common magnitude, so that every count is met."""
    vectors = []
    for _ in range(1500):
        small = signed(random.randint(1, W))
        vectors.append((pack([random.randrange(small.start, small.stop) for _ in range(N)], W),))
    await bench(dut).check(vectors + [(pack(v, W),) for v in some(500, *[WORDS] * N)])
