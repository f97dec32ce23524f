# SPDX-License-Identifier: Apache-2.0
"""Climb to the worst targets of the lean datapath: hand errors of the bit-true model beside their tolerance.

    python -m scripts.climb [--width 18 32 ...] [--rounds N] [--seed S]

A round changes each of the worst targets in one to six words, by powers of two and small numbers, and keeps the worst
of old and new, a few of each kind, so that no single target takes all places. The start are targets of every region.
The worst of all go into `WORST` of model/dataflow/tests/test_datapaths.py.

Exit status: 0 all hands are within their tolerance, 1 one is not, 2 bad input, 130 after Ctrl-C, 143 after SIGTERM.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.stimuli import REGIONS, mixed, region
from scripts.console import Meter, Parser, command, progress, whole, word_length
from tb.core import hardest

KEPT, EACH = 400, 50
"""Targets that go on into the next round, and children of each."""


def _children(parents: np.ndarray, width: int, random: np.random.Generator) -> np.ndarray:
    """Changed copies (EACH N, 6) of targets (N, 6)."""
    rows = np.repeat(parents, EACH, axis=0)
    steps = random.choice([-1, 1], rows.shape) * random.integers(1, 4, rows.shape)
    steps <<= random.integers(0, random.integers(1, width, (len(rows), 1)), rows.shape)
    changed = random.random(rows.shape) < random.choice([0.2, 0.5, 1.0], (len(rows), 1))
    top = (1 << (width - 1)) - 1
    return np.clip(rows + np.where(changed, steps, 0), -top - 1, top)


def hand_errors(words: np.ndarray, width: int) -> np.ndarray:
    """Hand error / reach (N,); 0 for targets out of reach."""
    return np.nan_to_num(hardest.errors(words, fixed.run(words, width, "lean").results, width)[0])


def _best(words: np.ndarray, hand: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """The worst hands, at most eight of targets whose positions and arms have the same signs and sizes."""
    order = np.argsort(-hand, kind="stable")
    seen: dict[bytes, int] = {}
    chosen = []
    for n in order.tolist():
        row = words[n, [0, 1, 2, 4, 5]]
        kind = np.concatenate([np.sign(row), np.frexp(row.astype(float))[1] // 2]).tobytes()
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= 8:
            chosen.append(n)
        if len(chosen) == KEPT:
            break
    return words[chosen], hand[chosen]


def climb(width: int, rounds: int, seed: int, meter: Meter) -> tuple[np.ndarray, float]:
    """The worst target found (6,) and its hand error / reach."""
    random = np.random.default_rng((seed, width))
    words = np.concatenate([mixed(20000, width, seed), *(region(name, 5000, width, seed) for name in REGIONS)])
    words, hand = _best(words, hand_errors(words, width), width)
    for number in range(rounds):
        more = np.unique(_children(words, width, random), axis=0)
        words, at = np.unique(np.concatenate([words, more]), axis=0, return_index=True)
        hand = np.concatenate([hand, hand_errors(more, width)])[at]
        words, hand = _best(words, hand, width)
        meter(number + 1, f"W = {width}: {hand[0]:.3g}")
    return words[0], float(hand[0])


@command("climb")
def main(arguments: Sequence[str] | None) -> int:
    """Run the command line; the exit status."""
    parser = Parser("climb", "Climb to the worst targets of the lean datapath.", fails="a hand is beyond its tolerance")
    parser.add_argument("--width", type=word_length, nargs="+", default=WIDTHS, metavar="W", help="(default: all)")
    parser.add_argument("--rounds", type=whole(1), default=300, metavar="N", help="(default: %(default)s)")
    parser.add_argument("--seed", type=whole(0), default=1, metavar="S", help="(default: %(default)s)")
    parsed = parser.parse_args(arguments)
    status = 0
    for width in parsed.width:
        with progress("climb", parsed.rounds) as meter:
            words, hand = climb(width, parsed.rounds, parsed.seed, meter)
        bar = tolerances.sought(width)
        print(f"W = {width}: {hand:.3e} of the reach, tolerance {bar:.3g}: {', '.join(map(str, words))}", flush=True)
        status |= hand > bar
    return status


if __name__ == "__main__":
    sys.exit(main())
