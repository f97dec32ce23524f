# SPDX-License-Identifier: Apache-2.0
"""Inputs and results of a simulation, and differences from the model's results; independent of the simulator.

A job is an array of targets to run in order. Its rows are signed input words: wrist targets (N, 6), or poses of the
whole arm with their branch (N, 12). If the core chooses the branch, 7 reference joints precede the branch (N, 19).
"""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import Format, inner_frac
from model.dataflow.nodes import Limits, Node
from model.dataflow.quadratic import SINE, SINE_FRACS, sine_sums
from model.io.stimuli import arm_limits, arm_targets, mixed, referenced
from model.io.words import pack

KEPT, SHOWN = 1000, 5  # numbers of differences kept for the message, and shown in it; the others are only counted


class SimulationError(Exception):
    """Error of a simulation that did not complete; the message has one or more lines for the user."""


def usual_limits(datapath: str, width: int) -> list[tuple[int, int]]:
    """Return the limits of joints that benches use by default."""
    return arm_limits(width, long=MODELS[datapath].chooses)


def usual_words(datapath: str, count: int, width: int, seed: int) -> np.ndarray:
    """Return a job with targets of every kind."""
    path = MODELS[datapath]
    words = (arm_targets if path.side else mixed)(count, width, seed)
    return referenced(words, width, seed) if path.chooses else words


def arithmetic_corners(datapath: str, width: int) -> np.ndarray:
    """Return targets of all magnitudes with few significant bits, and targets with an angle whose sine or cosine,
    before it is rounded, is one LSB below the rounding boundary."""
    sizes = itertools.product(range(0, width - 6, 3), range(width - 11))
    shifted = [(29 << j, -26 << j, -25 << j, -10647, 0, 999 << k) for j, k in sizes]
    frac = min(inner_frac(width), SINE_FRACS[-1])
    form = SINE.form(frac, MODELS[datapath].tile)
    angles = np.random.default_rng(5).integers(0, 1 << width - 1, 100000)
    dropped = (1 << form.sum_frac - frac) - 1
    near = [angles[y & dropped == dropped >> 1][:10] for y in sine_sums(angles, width, form)]
    return np.array([*shifted, *((999, -700, 444, angle, 999, 999) for angle in np.concatenate(near))])


def answer(words: np.ndarray, width: int, datapath: str, limits: Limits | None = None) -> fixed.Answer:
    """Return the model's answer to a job; ``limits`` default to :func:`usual_limits`."""
    count = len(MODELS[datapath].inputs)
    branch = words[:, count] if MODELS[datapath].side else 0
    return fixed.run(words[:, :count], width, datapath, branch, limits or usual_limits(datapath, width))


def limits_port(limits: Limits, width: int) -> int:
    """Return the value of the port ``limits`` of ``ik_arm``; each limit wraps modulo one turn."""
    half = 1 << width - 1
    return pack((np.ravel(limits)[None] + half) % (2 * half) - half, width)[0]


@dataclass
class Run:
    """Results of the RTL for a job.

    ``results`` (N, words) are signed; they and ``flags`` (N,) are in input order. ``latency_cycles`` counts the clocks
    from first in to first out, ``total_cycles`` from first in to last out, both ends included. Both counts are None
    for hardware behind a link. ``bit_mismatches`` counts differing bits of all visible named nodes; ``first_mismatch``
    is a message. ``branch`` (N,) is the chosen branch, if the core chooses.
    """

    results: np.ndarray
    flags: np.ndarray
    latency_cycles: int | None
    total_cycles: int | None
    bit_mismatches: int
    first_mismatch: str | None
    branch: np.ndarray | None = None


@dataclass(frozen=True)
class Difference:
    """One node of one target in which RTL and model differ."""

    node: Node
    target: int
    clock: int
    rtl: str  # bits, including X and Z
    model: str

    def bits(self) -> int:
        """Return the number of differing bits. X and Z differ from both 0 and 1."""
        return sum(a != b for a, b in zip(self.rtl, self.model, strict=True))

    def __str__(self) -> str:
        equation = f" {self.node.equation}" if self.node.equation else ""
        rtl, model = (f"{hexadecimal(bits)} ({value(bits, self.node.format)})" for bits in (self.rtl, self.model))
        name = f"{self.node.section}.{self.node.name}{equation}"
        return f"{name} of target {self.target} at clock {self.clock}: RTL {rtl}, model {model}"


def hexadecimal(bits: str) -> str:
    """Return bits as hexadecimal digits, or unchanged if any bit is X or Z."""
    return f"{int(bits, 2):0{-(-len(bits) // 4)}x}" if set(bits) <= {"0", "1"} else bits


def value(bits: str, fmt: Format, digits: int = 12) -> str:
    """Return the value of bits in format ``fmt`` as text with ``digits`` significant digits."""
    if not set(bits) <= {"0", "1"}:
        return "unknown"
    word = int(bits, 2)
    if fmt.signed and bits[0] == "1":
        word -= 1 << fmt.width
    return f"{word / 2**fmt.frac:.{digits}g}"


def report(differences: Sequence[Difference], nodes: Iterable[Node], since: int = 0) -> str:
    """Return a message about the first target that differs; empty if none does. The message counts targets from
    ``since``, the number of the run's first target, and lists differing nodes in the order of ``nodes``."""
    if not differences:
        return ""
    order = {node.name: k for k, node in enumerate(nodes)}
    first = min(d.target for d in differences)
    of_first = [replace(d, target=first - since) for d in differences if d.target == first]
    of_first.sort(key=lambda d: order[d.node.name])
    lines = [f"first difference: {of_first[0]}", *(f"            then: {d}" for d in of_first[1:SHOWN])]
    if len(of_first) > SHOWN:
        lines.append(f"            and {len(of_first) - SHOWN} more nodes of this target")
    return "\n".join(lines)
