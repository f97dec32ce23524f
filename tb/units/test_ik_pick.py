# SPDX-License-Identifier: Apache-2.0
"""``ik_pick``: a, or b with either sign, modulo 2^W."""

from model.dataflow.nodes import Latency
from tb.units.unit import BIT, Tests, checks, each, runs, signed


def bench(W: int) -> Tests:
    words = signed(W)

    def reference(a, b, use_b, minus):
        if not use_b:
            return a
        # the least word is its own negative
        return -b if minus and b != words[0] else b

    return checks(
        {"a": words, "b": words, "use_b": BIT, "minus": BIT},
        {"q": words},
        each(reference),
        latency=Latency(32)["mux"],
        latencies=[((1, 2, 0, 0), (1, 2, 1, 1))],
    )


test_ik_pick = runs("ik_pick", bench, {"W": 32}, more=[{"W": 4}])
