# SPDX-License-Identifier: Apache-2.0
"""Choice among the eight branches of a hand pose: the joints nearest to reference joints, inside their limits.

Only the largest step counts, and the largest of seven is a maximum, which distributes over the minimum.  So for each
elbow bit e, relative to the given branch, shoulder and wrist choose their bits s and w apart:

    min_e max(step_4[e], min_s max(step_1[s], step_2[s], step_3[s^e]), min_w max(step_5[e^w], step_6[w], step_7[w]))

A step is counted in 2^-12 turns, towards 0; its top bit is set for an angle outside the limits, which is further away
than any other.  Equal steps keep the given branch's bit.

Where th2 or th6 is 0 or half a turn, the axes of its neighbours coincide, and only the sum or the difference of their
angles counts.  The first neighbour then takes its reference, and the other one the rest.
"""

from collections.abc import Sequence

import numpy as np

from ..io.words import BRANCHES, REFERENCES
from ..reference.joints import NEGATED, TURNED
from .arm import arm
from .expressions import ANY, Constant, Logic, Not, Operation, Select, Sum, Term, Unary
from .formats import Format
from .nodes import WRAP, Dataflow, Node

SECTION = {"choose": "the branch nearest to the reference joints"}

STEP_BITS = 12
"""Bits of a step; above them is a bit for angles outside their limits."""

FOLD_CLOCKS = 50
"""Clocks of ``ik_fold_choose``, which has no named nodes."""

BALLS = {"shoulder": (1, 2, 3), "wrist": (6, 7, 5)}
"""Ball joint -> its three joints; the elbow bit turns the last one as well."""


def eps(width: int) -> int:
    """Return the words next to 0 and half a turn within which th2 and th6 are singular."""
    return 8 if width > 24 else 16


class Near(Unary):
    """Mask of angles less than ``most`` words from 0 or from half a turn."""

    free = True

    def __init__(self, angle: Term, most: int) -> None:
        super().__init__(angle)
        self.frac, self.most = 0, most

    def words(self, values):
        half = (1 << self.term.frac) - 1
        return (self.term.words(values) + self.most - 1 & half) < 2 * self.most - 1

    def text(self, level=0):
        return f"{self.term.text()} near 0 or half a turn"


class Above(Unary):
    """Angle above a lower limit: the arc from there upwards, less than a turn."""

    free = True

    def __init__(self, angle: Term, low: int, name: str) -> None:
        super().__init__(angle)
        self.low, self.name = low, name

    def words(self, values):
        return self.term.words(values) - self.low & (2 << self.frac) - 1

    def text(self, level=0):
        return f"{self.term.text()} above {self.name}"


class Longer(Unary):
    """Mask of arcs longer than the one between a joint's limits, ``span``."""

    free = True

    def __init__(self, arc: Term, span: int, name: str) -> None:
        super().__init__(arc)
        self.frac, self.span, self.name = 0, span, name

    def words(self, values):
        return self.term.words(values) > self.span

    def text(self, level=0):
        return f"{self.term.text()} > {self.name}"


class Step(Operation):
    """Size of a difference of arcs in 2^-12 turns; all ones for an angle outside its limits.

    ``whole``: the joint has no limits, so the difference is taken modulo a turn.
    """

    free = True

    def __init__(self, gap: Term, out: Term, whole: bool) -> None:
        super().__init__(gap, out)
        self.gap, self.out, self.whole, self.frac = gap, out, whole, STEP_BITS - 1

    def words(self, values):
        gap, turn = self.gap.words(values), 2 << self.gap.frac
        if self.whole:
            gap = (gap + turn // 2 & turn - 1) - turn // 2
        size = np.where(gap < 0, ~gap, gap) >> self.gap.frac + 1 - STEP_BITS
        return np.where(self.out.words(values), (2 << STEP_BITS) - 1, size)

    def text(self, level=0):
        return f"{self.out.text()} ? most : |{self.gap.text()}|"


class Extreme(Operation):
    """The larger or the smaller of two terms."""

    free = True
    FUNCTIONS = {"max": np.maximum, "min": np.minimum}

    def __init__(self, name: str, a: Term, b: Term) -> None:
        super().__init__(a, b)
        self.name, self.frac = name, a.frac

    def words(self, values):
        return self.FUNCTIONS[self.name](*(part.words(values) for part in self.parts))

    def text(self, level=0):
        return f"{self.name}({', '.join(part.text() for part in self.parts)})"


def arm_and_choice(d: Dataflow, target: dict[str, Node]) -> None:
    """Build the whole arm and the choice behind it."""
    arm(d, target)
    choose(d)


def choose(d: Dataflow) -> None:
    """Build the choice behind the joints of the whole arm."""
    n = d.nodes
    d.at("choose")
    d.words("over_2")  # all joints are ready
    angles = {k: n[f"th{k}"] for k in range(1, 8)}
    for first, middle, last in ((1, 2, 3), (5, 6, 7)):
        _split(d, angles, first, middle, last)
    free = -(1 << d.width - 1), (1 << d.width - 1) - 1
    limits = d.limits or [free] * 7
    steps = {k: _steps(d, k, angles[k], limits[k - 1]) for k in angles}
    turns = _turns(d, steps)

    d.words("turn_wrist")  # all bits are ready
    for branch in BRANCHES:
        turn = turns[branch]
        d.mask(turn.name.replace("turn", "choice"), Logic("xor", ANY, n[branch], turn))
    for k, angle in angles.items():
        name = f"th{k}"
        if name in TURNED:
            changed: Term = Logic("xor", ANY, *(turns[branch] for branch in TURNED[name]))
            joint: Operation = Sum((1, angle), (1, Select(changed, Constant(-1), 0)))
        else:
            changed = turns[NEGATED[name]]
            joint = Select(changed, -angle, angle)
        d.node(f"joint_{k}", joint, d.word(0), ends=WRAP)
        d.mask(f"out_{k}", Select(changed, n[f"out_{k}_1"], n[f"out_{k}_0"]))
    d.mask("singular", n["singular_2"] | n["singular_6"])


def _split(d: Dataflow, angles: dict[int, Node], first: int, middle: int, last: int) -> None:
    """Replace the angles next to a singular joint."""
    between, reference = angles[middle], d.nodes[REFERENCES[first - 1]]
    singular = d.mask(f"singular_{middle}", Near(between, eps(d.width)))
    opposite = d.mask(f"opposite_{middle}", (between >= Constant(0.5)) | (between < Constant(-0.5)))
    swing = d.node(f"swing_{first}", angles[first] - reference, d.word(0), "mux", ends=WRAP)
    rest = Select(singular, Select(opposite, -swing, swing), 0)
    angles[first] = d.node(f"split_{first}", Select(singular, reference, angles[first]), d.word(0))
    angles[last] = d.node(f"split_{last}", angles[last] + rest, d.word(0), "mux", ends=WRAP)


def _steps(d: Dataflow, k: int, angle: Node, limits: Sequence[int]) -> list[Node]:
    """Return the nodes of a joint's steps from its reference: unchanged, and turned by half a turn or negated."""
    low, span = limits[0], limits[1] - limits[0] & (1 << d.width) - 1
    arc = Format(d.width, d.width - 1, "W - 1", signed=False)
    aligned = d.nodes["split_7"]
    reference = d.node(f"ref_at_{k}", Above(d.nodes[REFERENCES[k - 1]], low, f"low_{k}"), arc, after=aligned)
    steps = []
    for b, value in enumerate((angle, angle + Constant(-1) if f"th{k}" in TURNED else -angle)):
        at = d.node(f"at_{k}_{b}", Above(value, low, f"low_{k}"), arc, after=aligned)
        out = d.mask(f"out_{k}_{b}", Longer(at, span, f"span_{k}"))
        gap = d.node(f"gap_{k}_{b}", at - reference, Format(d.width + 1, d.width - 1, "W - 1"), "mux")
        whole = span == (1 << d.width) - 1
        steps.append(d.node(f"step_{k}_{b}", Step(gap, out, whole), GROUP))
    return steps


GROUP = Format(STEP_BITS + 1, STEP_BITS - 1, str(STEP_BITS - 1), signed=False)


def _turns(d: Dataflow, steps: dict[int, list[Node]]) -> dict[str, Node]:
    """Return a dict: bit of the branch -> mask that changes it; ``steps``: joint -> its two steps."""
    n = d.nodes

    def extreme(name: str, function: str, a: Node, b: Node) -> Node:
        return d.node(name, Extreme(function, a, b), GROUP)

    for ball, (one, two, shared) in BALLS.items():
        for b in (0, 1):
            pair = extreme(f"{ball}_pair_{b}", "max", steps[one][b], steps[two][b])
            for e in (0, 1):
                extreme(f"{ball}_{e}{b}", "max", pair, steps[shared][e ^ b])
        for e in (0, 1):
            both = n[f"{ball}_{e}0"], n[f"{ball}_{e}1"]
            d.mask(f"{ball}_turn_{e}", both[1] < both[0])
            extreme(f"{ball}_least_{e}", "min", *both)
    for e in (0, 1):
        balls = extreme(f"balls_{e}", "max", n[f"shoulder_least_{e}"], n[f"wrist_least_{e}"])
        extreme(f"arm_{e}", "max", balls, steps[4][e])
    for branch in range(8):
        s, e, w = (branch >> bit & 1 for bit in range(3))
        parts = n[f"shoulder_{e}{s}"], n[f"wrist_{e}{w}"], steps[4][e]
        outside = [part >= Constant(2) for part in parts]
        d.mask(f"feasible_{branch}", Not(outside[0] | outside[1] | outside[2]))
    elbow = d.mask("turn_elbow", n["arm_1"] < n["arm_0"])
    extreme("least", "min", n["arm_0"], n["arm_1"])
    turns = {"branch_elbow": elbow}
    for ball in BALLS:
        turns[f"branch_{ball}"] = d.mask(f"turn_{ball}", Select(elbow, *(n[f"{ball}_turn_{e}"] for e in (1, 0))))
    return turns
