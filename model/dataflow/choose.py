# SPDX-License-Identifier: Apache-2.0
"""Choice among the eight branches of a hand pose: the joints nearest to reference joints, inside their limits.

A branch's step is the largest step of its seven joints.  A maximum distributes over a minimum, so for each elbow bit e,
the shoulder bit s and the wrist bit w are chosen independently of each other (all bits relative to the given branch):

    min_e max(step_4[e], min_s max(step_1[s], step_2[s], step_3[s^e]), min_w max(step_5[e^w], step_6[w], step_7[w]))

A joint's step, from its reference to its angle, is in units of 2^-12 turns, rounded towards 0.  If the angle is outside
its limits, the step's top bit is set, so it exceeds all others.  If steps are equal, the given branch's bit is kept.

Where th2 or th6 is 0 or half a turn, the axes of the joints before and after it coincide, and only the sum or the
difference of their angles matters.  The joint before then takes its reference angle, and the joint after the rest.
"""

import numpy as np

from ..io.words import BRANCHES, REFERENCES
from ..reference.joints import NEGATED, TURNED
from .arm import arm
from .expressions import ANY, Constant, Function, Logic, Operation, Select, Sum, Term, magnitude
from .formats import Format
from .nodes import WRAP, Dataflow, Node

SECTION = {"choose": "the branch nearest to the reference joints"}

STEP_BITS = 12
STEP = Format(STEP_BITS + 1, STEP_BITS - 1, str(STEP_BITS - 1), signed=False)
"""Bits of a step, and its format: above these bits is a bit for angles outside their limits."""

FOLD_CLOCKS = 50
"""Clocks of ``ik_fold_choose``, which has no named nodes."""

BALLS = {"shoulder": (1, 2, 3), "wrist": (6, 7, 5)}
"""Ball joint -> its three joints; the elbow bit also turns the last of them."""


def eps(width: int) -> int:
    """Return the distance from 0 or half a turn, in ulps of a word, below which th2 and th6 count as singular."""
    return 8 if width > 24 else 16


def step(gap: Node, out: Node, whole: bool) -> Function:
    """Return the size of ``gap``, a difference of arcs, in 2^-12 turns; all ones where the mask ``out`` is set.

    ``out``: the angle is outside its limits.  ``whole``: the joint has no limits, so the gap is taken modulo a turn.
    """
    turn = 2 << gap.frac

    def size(gaps, outside):
        arcs = (gaps + turn // 2 & turn - 1) - turn // 2 if whole else gaps
        return np.where(outside, (2 << STEP_BITS) - 1, magnitude(arcs) >> gap.frac + 1 - STEP_BITS)

    return Function(size, "{1} ? most : |{0}|", gap, out, frac=STEP_BITS - 1)


def choose(d: Dataflow, target: dict[str, Node]) -> None:
    """Build the whole arm and, from its joint angles, the choice of a branch."""
    arm(d, target)
    n = d.nodes
    d.at("choose")
    d.words("over_2")  # all joints are ready
    angles = {k: n[f"th{k}"] for k in range(1, 8)}
    for first, middle, last in ((1, 2, 3), (5, 6, 7)):
        _split(d, angles, first, middle, last)
    steps = {k: _steps(d, k, angles[k], *d.limits[k - 1]) for k in angles}
    turns = _turns(d, steps)

    d.words("turn_wrist")  # all bits are ready
    for branch in BRANCHES:
        turn = turns[branch]
        d.mask(turn.name.replace("turn", "choice"), Logic("xor", ANY, n[branch], turn))
    for k, angle in angles.items():
        name = f"th{k}"
        if name in TURNED:
            changed: Term = Logic("xor", ANY, *(turns[branch] for branch in TURNED[name]))
            joint: Operation = Sum((1, angle), (1, Select(changed, -1, 0)))
        else:
            changed = turns[NEGATED[name]]
            joint = Select(changed, -angle, angle)
        d.node(f"joint_{k}", joint, d.word(0), ends=WRAP)
        d.mask(f"out_{k}", Select(changed, n[f"out_{k}_1"], n[f"out_{k}_0"]))
    d.mask("singular", n["singular_2"] | n["singular_6"])


def _split(d: Dataflow, angles: dict[int, Node], first: int, middle: int, last: int) -> None:
    """Replace the angles of the joints ``first`` and ``last`` where the joint ``middle`` is singular."""
    between, reference = angles[middle], d.nodes[REFERENCES[first - 1]]
    most, half = eps(d.width), (1 << between.frac) - 1
    near = Function(lambda a: (a + most - 1 & half) < 2 * most - 1, "{} near 0 or half a turn", between, frac=0)
    singular = d.mask(f"singular_{middle}", near)
    opposite = d.mask(f"opposite_{middle}", (between >= 0.5) | (between < -0.5))
    swing = d.node(f"swing_{first}", angles[first] - reference, d.word(0), "mux", ends=WRAP)
    rest = Select(singular, Select(opposite, -swing, swing), 0)
    angles[first] = d.node(f"split_{first}", Select(singular, reference, angles[first]), d.word(0))
    angles[last] = d.node(f"split_{last}", angles[last] + rest, d.word(0), "mux", ends=WRAP)


def _steps(d: Dataflow, k: int, angle: Node, low: int, high: int) -> list[Node]:
    """Return joint k's steps from its reference: to ``angle``, and to ``angle`` turned by half a turn or negated."""
    turn = (1 << d.width) - 1
    span = high - low & turn

    def above(name: str, value: Term) -> Node:  # the arc from the lower limit upwards, less than a turn
        arc = Format(d.width, d.width - 1, "W - 1", signed=False)
        return d.node(name, Function(lambda a: a - low & turn, f"{{}} above low_{k}", value), arc, after=n["split_7"])

    n, steps = d.nodes, []
    reference = above(f"ref_at_{k}", n[REFERENCES[k - 1]])
    for b, value in enumerate((angle, angle + Constant(-1) if f"th{k}" in TURNED else -angle)):
        at = above(f"at_{k}_{b}", value)
        out = d.mask(f"out_{k}_{b}", Function(lambda arc: arc > span, f"{{}} > span_{k}", at, frac=0))
        gap = d.node(f"gap_{k}_{b}", at - reference, Format(d.width + 1, d.width - 1, "W - 1"), "mux")
        steps.append(d.node(f"step_{k}_{b}", step(gap, out, span == turn), STEP))
    return steps


def _turns(d: Dataflow, steps: dict[int, list[Node]]) -> dict[str, Node]:
    """Return a dict: branch bit -> mask of targets for which the bit changes; ``steps``: joint -> its two steps."""
    n = d.nodes

    def extreme(name: str, function: str, a: Node, b: Node) -> Node:
        computed = {"max": np.maximum, "min": np.minimum}[function]
        return d.node(name, Function(computed, f"{function}({{}}, {{}})", a, b), STEP)

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
        d.mask(f"feasible_{branch}", ~(outside[0] | outside[1] | outside[2]))
    elbow = d.mask("turn_elbow", n["arm_1"] < n["arm_0"])
    extreme("least", "min", n["arm_0"], n["arm_1"])
    turns = {"branch_elbow": elbow}
    for ball in BALLS:
        turns[f"branch_{ball}"] = d.mask(f"turn_{ball}", Select(elbow, *(n[f"{ball}_turn_{e}"] for e in (1, 0))))
    return turns
