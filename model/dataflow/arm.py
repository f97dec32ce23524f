# SPDX-License-Identifier: Apache-2.0
"""Dataflow of the whole arm around the lean one: hand pose to seven joint angles.

The input words are the hand's point, its quaternion Qh and the tool's length; the core's target is the wrist:

    (L62) n = |Qh|^2                               bad_hand: |Qh| outside [1 - 2^-8, 1 + 2^-8)
    (L63) h = Qh, or 1 for a bad hand              (L64) t = tool, or 0 for a bad hand
    (L65) r_x = ik + wj    (L66) r_y = jk - wi     (L67) r_z = 1/2 - ii - jj      half the third column of Qh's rotation
    (L68) .. (L70) x, y, z = hand - 2 t r          saturated

The wrist's orientation and all angles are computed from the words Qs and Qe that leave, so roundings of Qs and Qe do
not turn the hand:

    (L71) .. (L74) G = Qs~ h                       (L75) .. (L78) Qw = (-qe_i + qe_w i)~ G = (Qs Rx(th4))~ Qh

    (L79) d = atan2(j, i), K |(i, j)|              (L80) s = atan2(k, w), K |(w, k)|      of Qs
    (L81) b = atan2(|(i, j)|, |(w, k)|)            (L82) .. (L84) th1 = s + d, th2 = 2 b, th3 = s - d
    (L85) e = atan2(-qe_w, qe_i)                   (L86) th4 = 2 e
    (L87) .. (L92) the same of Qw: th5, th6, th7

K is the CORDIC's gain (:mod:`model.dataflow.angles`), which cancels in b.  Bits of the branch turn joints by half a
turn or negate them, as in :mod:`model.reference.joints`.  over_k: th_k is outside its limits, exactly.
"""

from functools import partial

from ..io.words import JOINTS, RESULT_FIELDS
from ..reference.joints import NEGATED, TURNED
from . import lean
from . import operations as ops
from .angles import ANGLE
from .annotations import SAME, SUM, Growth, Limited, Within
from .lean import Lean
from .nodes import HALF_UP, Domain, Format, Node

SECTIONS = {"hand": "wrist target of a hand pose", **lean.SECTIONS, "frame": "wrist quaternion", "joints": "angles"}
"""Section name -> description; the core's sections are the lean datapath's."""

LENGTH = Within(0.0, 1.01, "the squared length of a good hand")
ROW = Within(-0.51, 0.51, "half a component of a unit vector, times |Qh|^2 < 1.01")
GOOD = Within(-1.01, 1.01, "parts of a quaternion no longer than 1 + 2^-8")
PART = Within(-1.02, 1.02, "parts of Qh times Qs or Qe")
POINT = Within(-2.0, 2.0, "a word", below=True)
OFFSET = Within(-1.02, 1.02, "half a component of the tool's offset")
WRIST = Limited("a wrist outside the format is brought to its edge")
TURN = Within(-1.0, 1.0, "a binary angle, which wraps", below=True)
GAINED = Within(0.0, 1.68, "K times the length of two parts, K = 1.6468")

ROUNDED_SUM = Growth(added=True)


def arm(d: Domain, target: dict[str, Node]) -> None:
    """Build the whole datapath, from the input words to results and flags."""
    hand(d, target)
    lean.guard(d, d.nodes)
    _from_core(d, target["phi"])


def after_guard(d: Domain, phi: Node) -> None:
    """Build everything but the core's exact decisions, whose nodes are in ``d.nodes``, as are the input words."""
    hand(d, d.nodes)
    _from_core(d, phi)


def _from_core(d: Domain, phi: Node) -> None:
    lean.sections(d, phi)
    d.words(*RESULT_FIELDS)
    frame(d)
    d.words("qw_w", "qw_i", "qw_j", "qw_k")
    joints(d)


def hand(d: Domain, target: dict[str, Node]) -> None:
    """Build the wrist's point, the words of Qh that the wrist's orientation uses, and their flags."""
    f, L = Lean(d.width), d.line
    d.at("hand")
    # Four squares add up to at most 16; the sum wraps at 8. A wrapped sum is far from 1, so the hand is still bad.
    exact, total = Format(2 * d.width, 2 * d.width - 4, "2*W - 4"), "hi_sq"
    for c in "ijkw":
        L(62).op(f"h{c}_sq", (f"qh_{c}",), exact, ops.square, "square", within=LENGTH, grows=SAME)
    for c, name in (("j", "hij_sq"), ("k", "hijk_sq"), ("w", "hand_sq")):
        operands, total = (total, f"h{c}_sq"), name
        L(62).op(name, operands, exact, partial(ops.plus_wrapped, width=exact.width), "wide", within=LENGTH, grows=SUM)
    d.at()
    d.mask("bad_hand", (total,), partial(ops.off_one, frac=exact.frac, places=8))
    for c in "wijk":
        how = partial(ops.chosen, unit=f.result.frac if c == "w" else None)
        L(63).op(f"h_{c}", (f"qh_{c}", "bad_hand"), f.result, how, within=GOOD, grows=SAME)
    L(64).op("tool_h", ("tool", "bad_hand"), f.result, partial(ops.chosen, unit=None), within=POINT, grows=SAME)

    half = 1 << f.frac - 1
    rows = ("x", "ik", "wj", (1, 1), 0), ("y", "jk", "wi", (1, -1), 0), ("z", "ii", "jj", (-1, -1), half)
    for line, (axis, first, second, signs, one) in enumerate(rows, start=65):
        terms = first, second
        for term in terms:
            L(line).mul3(f"h_{term}", target[f"qh_{term[0]}"], target[f"qh_{term[1]}"], f.inner, within=GOOD)
        how = partial(ops.half_row, signs=signs, half=one, width=f.inner.width)
        L(line).op(f"r_{axis}", [f"h_{term}" for term in terms], f.inner, how, within=ROW, grows=SUM)
    shifts = {"up": f.drop - 1, "drop": f.drop - 1, "top": f.result.high}  # off is half the offset
    wrist: list[str] = []
    for line, axis in enumerate("xyz", start=68):
        row, wrist = d.nodes[f"r_{axis}"], [*wrist, f"hand_{axis}", f"off_{axis}"]
        L(line).mul3(wrist[-1], row, d.nodes["tool_h"], f.inner, kind="mul3_far", within=OFFSET)
        facts = {"within": POINT, "grows": Growth((1.0, 2.0)), "limited": WRIST}
        L(line).op(axis, wrist[-2:], f.result, partial(ops.target, **shifts), "sum2", HALF_UP, **facts)
    d.at()
    d.mask("saturated", wrist, partial(ops.outside_format, **shifts), "sum2")
    d.words("x", "y", "z")


def frame(d: Domain) -> None:
    """Build Qw."""
    f, n, L = Lean(d.width), d.nodes, d.line
    d.at("frame")
    rows = {"w": "ww+ ii+ jj+ kk+", "i": "wi+ iw- jk- kj+", "j": "wj+ jw- ki- ik+", "k": "wk+ kw- ij- ji+"}
    for line, (c, row) in enumerate(rows.items(), start=71):
        terms = [(f"g_{term[:2]}", n[f"qs_{term[0]}"], n[f"h_{term[1]}"]) for term in row.split()]
        for name, a, b in terms:
            L(line).mul3(name, a, b, f.inner, kind="mul3_far", within=PART)
        how = partial(ops.four, signs=tuple(1 if sign == "+" else -1 for sign in row[2::4]))
        L(line).op(f"g_{c}", [name for name, *_ in terms], f.inner, how, "sum2", within=PART, grows=SUM)
    for line, (c, other, sign) in enumerate((("w", "i", 1), ("i", "w", -1), ("j", "k", 1), ("k", "j", -1)), start=75):
        products = f"f_{c}{c}", f"f_{c}{other}"
        for name, of, half in zip(products, (c, other), "iw", strict=True):
            L(line).mul3(name, n[f"g_{of}"], n[f"qe_{half}"], f.inner, kind="mul3_far", within=PART)
        facts, how = {"within": PART, "grows": ROUNDED_SUM}, partial(ops.two, sign=sign, drop=f.drop)
        L(line).op(f"qw_{c}", products, f.result, how, "sum2", HALF_UP, **facts)


def joints(d: Domain) -> None:
    """Build the seven angles, and which of them are outside their limits."""
    L = d.line
    d.at("joints")
    _ball(d, 79, "qs", JOINTS[:3])
    L(85).vector(None, "qe_e", d.nodes["qe_i"], -d.nodes["qe_w"], within=(TURN,))
    _twice(L(86), "th4", "qe_e")
    _ball(d, 87, "qw", JOINTS[4:])
    d.at()
    free = -(1 << d.width - 1), (1 << d.width - 1) - 1
    for k, (low, high) in enumerate(d.limits or [free] * 7, start=1):
        d.mask(f"over_{k}", (f"th{k}",), partial(ops.outside, low=low, high=high, width=d.width))


def _ball(d: Domain, line: int, q: str, names: tuple[str, ...]) -> None:
    """Build the three angles of a ball joint with the quaternion ``q``."""
    n, L = d.nodes, d.line
    L(line).vector(f"{q}_ij", f"{q}_d", n[f"{q}_i"], n[f"{q}_j"], within=(GAINED, TURN))
    L(line + 1).vector(f"{q}_wk", f"{q}_s", n[f"{q}_w"], n[f"{q}_k"], within=(GAINED, TURN))
    L(line + 2).vector(None, f"{q}_b", n[f"{q}_wk"], n[f"{q}_ij"], within=(TURN,))
    for number, (name, sign) in enumerate(((names[0], 1), (names[2], -1))):
        how = partial(ops.joint, sign=sign, drop=ANGLE, width=d.width)
        operands = f"{q}_s", f"{q}_d", *TURNED[name]
        L(line + 3 + 2 * number).op(name, operands, d.word(0), how, "sum2", HALF_UP, within=TURN, grows=ROUNDED_SUM)
    _twice(L(line + 4), names[1], f"{q}_b")


def _twice(d: Domain, name: str, half: str) -> None:
    how = partial(ops.twice, drop=ANGLE, width=d.width)
    facts = {"within": TURN, "grows": Growth((2.0, 0.0))}
    d.op(name, (half, NEGATED[name]), d.word(0), how, error=HALF_UP, **facts)
