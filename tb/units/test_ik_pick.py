# SPDX-License-Identifier: Apache-2.0
"""``ik_pick``: a, or b with either sign, modulo 2^W."""

from model.dataflow.nodes import Latency
from tb.units.unit import BIT, Tests, checks, each, runs, signed


def bench(W: int, CUT: int = 0) -> Tests:
    words = signed(W)

    def reference(a, b, use_b, minus):
        if not use_b:
            return a >> CUT << CUT
        # the least word has no opposite and stays
        return (-(b >> CUT) if minus and b >> CUT != words[0] >> CUT else b >> CUT) << CUT

    return checks(
        {"a": words, "b": words, "use_b": BIT, "minus": BIT},
        {"q": words},
        each(reference),
        latency=Latency(32)["mux"],
        latencies=[((1 << CUT, 2 << CUT, 0, 0), (1 << CUT, 2 << CUT, 1, 1))],
    )


test_ik_pick = runs("ik_pick", bench, {"W": 32}, more=[{"W": 4}, {"W": 8, "CUT": 3}])
