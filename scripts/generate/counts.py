# SPDX-License-Identifier: Apache-2.0
"""Operation counts of a dataflow: nodes by computing unit, sums by their + and -."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np

from model.dataflow import fixed
from model.dataflow.nodes import Latency

WIDTH = 32

VECTORS = ("norm", "sincos", "trig")
"""Units with several results."""


class _Counted(np.ndarray):
    """Array of words that counts the + and - applied to it."""

    done: Counter = Counter()

    def __array_ufunc__(self, ufunc, method, *inputs, **kwargs):
        _Counted.done["+-"] += ufunc in (np.add, np.subtract)
        plain = [i.view(np.ndarray) if isinstance(i, _Counted) else i for i in inputs]
        return np.asarray(getattr(ufunc, method)(*plain, **kwargs)).view(_Counted)


class _Counting(fixed.Bits):
    """Dataflow run that records the + and - of every choice."""

    def __init__(self, width: int) -> None:
        super().__init__(width)
        self.additions: Counter = Counter()

    def apply(self, name, operands, fmt, words):
        before = _Counted.done["+-"]
        value = words(*(np.asarray(n.value).view(_Counted) for n in operands))
        self.additions[name] = _Counted.done["+-"] - before
        return np.asarray(value).view(np.ndarray)


def counted_run(flow: Callable, width: int = WIDTH) -> tuple[fixed.Bits, Counter]:
    """Run a dataflow; return it and the number of + and - of every choice."""
    d = _Counting(width)
    flow(d, d.inputs(lambda name, fmt: np.array([1 << (width - 3)])))
    return d, d.additions


def operations(flow: Callable) -> dict[str, Counter]:
    """Return for each section the number of each unit, a kind of `Latency.TABLE`, and of ``additions``.

    Each + or - of a rounded or exact sum is an addition; those inside another unit, such as the rounding of a product
    or a shift count, are not.  ``exact`` counts products of the flags, which also count under their own unit.
    """
    run, written = counted_run(flow)
    counts: dict[str, Counter] = {}
    vectors = set()
    for node in run.nodes.values():
        mine, unit = counts.setdefault(node.section, Counter()), node.latency
        if unit in ("sum2", "sum3"):
            mine["additions"] += max(int(unit[-1]), len(node.operands)) - 1
        elif unit in ("mux", "wide"):
            mine["additions"] += written[node.name]
        elif unit in VECTORS and (key := (unit, tuple(o.name for o in node.operands))) in vectors:
            continue
        elif unit in Latency.TABLE:
            mine[unit.removesuffix("_far")] += 1
            mine["exact"] += node.op == "choose" and unit in ("mul", "square", "product")
            if unit in VECTORS:
                vectors.add(key)
        elif unit:
            raise RuntimeError(f"node {node.name}: no rule for the operation {unit}")
    return counts
