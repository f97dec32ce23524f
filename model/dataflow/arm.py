# SPDX-License-Identifier: Apache-2.0
"""Dataflow of the whole arm, from a hand pose to seven joint angles; it contains the lean dataflow.

The hand pose is the hand's point, its quaternion Qh and the tool's length.  The lean dataflow's target is the wrist:

    |Qh|^2 = hand_sq                               bad_hand: |Qh| outside [1 - 2^-8, 1 + 2^-8)
    h = Qh, or 1 for a bad hand                    tool_h = tool, or 0 for a bad hand
    r_x = ik + wj    r_y = jk - wi    r_z = 1/2 - ii - jj      half the third column of Qh's rotation
    (x, y, z) = hand - 2 tool_h r                  saturated

The wrist's quaternion Qw and all angles are computed from the result words Qs and Qe, so the rounding of Qs and Qe does
not turn the hand:

    G = Qs~ h                                      Qw = (-qe_i + qe_w i)~ G = (Qs Rx(th4))~ Qh

    d = atan2(j, i), K |(i, j)|    s = atan2(k, w), K |(w, k)|      of Qs
    b = atan2(|(i, j)|, |(w, k)|)                  th1 = s + d, th2 = 2 b, th3 = s - d
    e = atan2(-qe_w, qe_i)                         th4 = 2 e
    likewise from Qw: th5, th6, th7

~ is the conjugate.  K is the CORDIC's gain (:mod:`model.dataflow.angles`), which cancels in b.  Branch bits add half a
turn to joints or negate them (:mod:`model.reference.joints`).  The flag over_k is set if th_k is outside its limits.
"""

from functools import partial, reduce
from operator import or_

from ..io.words import JOINTS, RESULT_FIELDS
from ..reference.joints import NEGATED, TURNED
from .angles import Angle, Gained
from .expressions import ANY, HALF_UP, Function, Logic, Select, Sum, Term, number, square
from .formats import Format, LeanFormats
from .lean import SECTIONS as CORE_SECTIONS
from .lean import lean, norm
from .lean_operations import Choice
from .mul3 import Mul3
from .nodes import SAME, SATURATE, SUM, WRAP, Dataflow, Growth, Limited, Node, Record, Within

SECTIONS = {"hand": "wrist target of a hand pose", **CORE_SECTIONS, "frame": "wrist quaternion", "joints": "angles"}
"""Section name -> description, including the lean datapath's sections."""

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

MOST_H = "66049/65536"
"""Largest squared length of a good hand: (1 + 2^-8)^2."""

WORST_ERROR = {"qs": 0.004, "qe": 0.0001, "qw": 0.0001}
"""Quaternion -> largest error of its words at any word length."""


def arm(d: Dataflow, target: dict[str, Node]) -> None:
    """Build the whole datapath, from the input words to results and flags."""
    hand(d, target)
    lean(d, d.nodes)
    d.words(*RESULT_FIELDS)
    frame(d)
    d.words("qw_w", "qw_i", "qw_j", "qw_k")
    joints(d)


class WrappedSum(Sum):
    """Sum of two terms, wrapped to the format of its node."""

    def facts(self, node, domain):
        total = self.formula(domain)
        end, turn = (number(turns * -node.format.low * node.format.ulp) for turns in (1, 2))
        wrapped = f"(ite (< {total} (- {end})) (+ {total} {turn}) {total})"
        return [f"(= {node.name} (ite (<= {end} {total}) (- {total} {turn}) {wrapped}))"]

    def lower(self, to, node):
        to.plus(node, *self.parts)


def replaced(word: Term, mask: Term, constant: int) -> Choice:
    """Return a word, replaced by ``constant`` (0 or 1) where the mask is set."""
    return Choice(Select(mask, constant, word), "replaced", word, mask, constant)


def outside(angle, low: int, high: int, width: int):
    """Return a mask of angles outside the arc from ``low`` to ``high``. All are words with one turn = 2^width."""
    turn = (1 << width) - 1
    return (angle - low & turn) > (high - low & turn)


class Outside(Function):
    """Mask of angles outside the arc from ``low`` to ``high``."""

    def __init__(self, angle: Node, low: int, high: int) -> None:
        mask = partial(outside, low=low, high=high, width=angle.format.width)
        super().__init__(mask, "{} outside its limits", angle, frac=0)

    def mask_registers(self, to, node):
        return {node.name}  # set after the joint's angle


class OutsideFormat(Function):
    """Mask of wrists with a coordinate outside the format of the coordinate's node."""

    def __init__(self, *wrists: Node) -> None:
        def mask(*words):
            rounded = [node.rounded(word) for node, word in zip(wrists, words, strict=True)]
            return reduce(or_, ((word > fmt.high) | (word < fmt.low) for word in rounded))

        fmt, names = wrists[0].format, ", ".join(node.name for node in wrists)
        super().__init__(mask, f"{names} outside the format", *(node.op for node in wrists), frac=0)

    def mask_registers(self, to, node):
        return to.wrist_registers()


def parts(before: str, after: str = "", of: str = "wijk") -> tuple[str, ...]:
    """Return the names ``before`` + part + ``after`` for the parts of a quaternion that ``of`` lists."""
    return tuple(f"{before}{part}{after}" for part in of)


def equations(*names: str) -> str:
    """Return the text of a ``proof`` whose facts are the equations of the named nodes."""
    return "; ".join(f"={name}" for name in names)


def hand(d: Dataflow, target: dict[str, Node]) -> None:
    """Build the quaternion h (Qh, or 1 for a bad hand), the wrist point (x, y, z), ``bad_hand`` and ``saturated``."""
    f = LeanFormats(d.width)
    d.at("hand")
    good = "=qh_len; good hand; |Qh|"
    # Four squares add up to at most 16; the sum wraps at 8. A wrapped sum is far from 1, so the hand is still bad.
    exact = Format(2 * d.width, 2 * d.width - 4, "2*W - 4")
    sums = equations("bad_hand", "hand_sq", "hijk_sq", "hij_sq", *parts("h", "_sq"), *parts("qh_"))
    squares = {}
    for c in "ijkw":
        facts: Record = {"within": LENGTH, "grows": SAME, "proof": f"=h{c}_sq; {good}"}
        squares[c] = d.node(f"h{c}_sq", square(target[f"qh_{c}"]), exact, "square", **facts)
    total = squares["i"]
    for c, name in (("j", "hij_sq"), ("k", "hijk_sq"), ("w", "hand_sq")):
        facts = {"ends": WRAP, "within": LENGTH, "grows": SUM, "proof": f"{good}; {sums}"}
        total = d.node(name, WrappedSum((1, total), (1, squares[c])), exact, "wide", **facts)
    least, most = ((1 + side / 256) ** 2 for side in (-1, 1))
    bad_hand = d.mask("bad_hand", (total < least) | (total >= most))
    for c in "wijk":
        facts = {"within": GOOD, "grows": SAME, "proof": "=h_len; |h|"}
        d.node(f"h_{c}", replaced(target[f"qh_{c}"], bad_hand, int(c == "w")), f.result, **facts)
    facts = {"within": POINT, "grows": SAME, "proof": "=tool_h; =tool"}
    tool_h = d.node("tool_h", replaced(target["tool"], bad_hand, 0), f.result, **facts)
    d.definitions["qh_len"] = norm(*parts("qh_"))
    d.definitions["h_len"] = norm(*parts("h_"))
    d.lemma("good hand", "not bad_hand")  # assumption, used only for the hand's products
    d.lemma("|Qh|", f"implies(not bad_hand, qh_len <= {MOST_H})", f"=qh_len; {sums}")
    d.lemma("|h|", f"0 <= h_len and h_len <= {MOST_H}", f"=h_len; =qh_len; |Qh|; {equations(*parts('h_'))}")

    def product(a: str, b: str) -> Node:
        operation = Mul3(target[f"qh_{a}"], target[f"qh_{b}"])
        return d.node(f"h_{a}{b}", operation, f.inner, within=GOOD, proof=f"=h_{a}{b}; {good}")

    def row(axis: str, total: Sum) -> Node:
        proof = f"=r_{axis}; {equations(*(node.name for node in total.operands))}; {good}"
        return d.node(f"r_{axis}", total, f.inner, ends=WRAP, within=ROW, grows=SUM, proof=proof)

    rows = {"x": row("x", product("i", "k") + product("w", "j")), "y": row("y", product("j", "k") - product("w", "i"))}
    rows["z"] = row("z", 0.5 - product("i", "i") - product("j", "j"))
    wrist = []
    for axis, half in rows.items():
        off = d.node(f"off_{axis}", Mul3(half, tool_h), f.inner, "mul3_far", within=OFFSET)  # half the offset
        facts = {"ends": SATURATE, "within": POINT, "grows": Growth((1.0, 2.0)), "limited": WRIST}
        point = target[f"hand_{axis}"]
        moved = Choice(point - 2 * off, "wrist", point, off, free=True)
        wrist.append(d.node(axis, moved, f.result, "sum2", rounding=HALF_UP, **facts))
    d.mask("saturated", OutsideFormat(*wrist), "sum2")
    d.words("x", "y", "z")


PRODUCTS = {"w": "ww+ ii+ jj+ kk+", "i": "wi+ iw- jk- kj+", "j": "wj+ jw- ki- ik+", "k": "wk+ kw- ij- ji+"}
"""Part of G = Qs~ h -> its products, each written as part of Qs, part of h, sign."""


def frame(d: Dataflow) -> None:
    """Build the wrist's quaternion Qw."""
    f, n = LeanFormats(d.width), d.nodes
    d.at("frame")
    for c, row in PRODUCTS.items():
        terms = []
        for a, b, sign in map(tuple, row.split()):
            facts = {"within": PART, "proof": f"=g_{a}{b}; =qs_len; =h_len; words of Qs; |h|"}
            term = d.node(f"g_{a}{b}", Mul3(n[f"qs_{a}"], n[f"h_{b}"]), f.inner, "mul3_far", **facts)
            terms.append((1 if sign == "+" else -1, term))
        d.node(f"g_{c}", Sum(*terms), f.inner, "sum2", within=PART, grows=SUM, proof="=g_len; |G|")
    turned = []
    for c, other, direction in (("w", "i", 1), ("i", "w", -1), ("j", "k", 1), ("k", "j", -1)):
        products = []
        for part, half in ((c, "i"), (other, "w")):
            name = f"f_{c}{part}"
            facts = {"within": PART, "proof": f"={name}; =g_len; =qe_len; |G|; words of Qe"}
            products.append(d.node(name, Mul3(n[f"g_{part}"], n[f"qe_{half}"]), f.inner, "mul3_far", **facts))
            turned.append(name)
        facts = {"rounding": HALF_UP, "within": PART, "grows": ROUNDED_SUM, "proof": "=qw_len; |Qw|"}
        difference = Sum((direction, products[1]), (-1, products[0]))
        total = Choice(difference, "rounded_sum", *products, direction, operands=tuple(products))
        d.node(f"qw_{c}", total, f.result, "sum2", **facts)
    frame_lemmas(d, turned)


def frame_lemmas(d: Dataflow, turned: list[str]) -> None:
    """State the lemmas on the lengths of Qs, Qe, G and Qw, in exact arithmetic and as words."""
    uses = "=w_q; =i_q; =j_q; =k_q; =wi_1_len; =kj_1_len; q_1; 1/|q|; length_sq"
    d.lemma("|w_q|", f"{norm('w_q', 'i_q', 'j_q', 'k_q')} <= 1", uses)
    d.lemma("|Qs|", f"{norm(*parts('qs_'))} <= 1", f"|w_q|; {equations(*parts('qs_'))}")
    d.lemma("|Qe|", f"{norm('qe_w', 'qe_i')} == 1", "case; =qe_w; =qe_i; elbow w; elbow i; A + B; =d1; =d2")
    for q, e in WORST_ERROR.items():  # |w| <= |q| + e and |q| <= q^2 + 1/4
        for part in parts(f"{q}_", of="wi" if q == "qe" else "wijk"):
            statement = f"{part}_w*{part}_w <= {1 + 2 * e}*{part}*{part} + {e / 2 + e * e:.9f}"
            d.lemma(f"word {part}", statement, f"{part}; ~{part}")
    for q, of in (("qs", "wijk"), ("qe", "wi")):
        d.definitions[f"{q}_len"] = norm(*parts(f"{q}_", "_w", of))
    d.definitions["g_len"] = norm(*parts("g_"))
    d.definitions["qw_len"] = norm(*parts("qw_"))
    uses = "=qs_len; |Qs|; word qs_w; word qs_i; word qs_j; word qs_k"
    d.lemma("words of Qs", "0 <= qs_len and qs_len <= 1.017", uses)
    d.lemma("words of Qe", "0 <= qe_len and qe_len <= 1.001", "=qe_len; |Qe|; word qe_w; word qe_i")
    products = (f"g_{a}{b}" for a in "wijk" for b in "wijk")
    uses = equations("g_len", "qs_len", "h_len", *parts("g_"), *products)
    d.lemma("|G| = |Qs| |h|", "g_len == qs_len*h_len", uses)
    d.lemma("|G|", "0 <= g_len and g_len <= 1.025", "|G| = |Qs| |h|; words of Qs; |h|")
    d.lemma("|Qw| = |G| |Qe|", "qw_len == g_len*qe_len", equations("qw_len", "g_len", "qe_len", *parts("qw_"), *turned))
    d.lemma("|Qw|", "qw_len <= 1.0265", "|Qw| = |G| |Qe|; |G|; words of Qe")
    uses = "=qw_len; |Qw|; word qw_w; word qw_i; word qw_j; word qw_k"
    d.lemma("words of Qw", f"{norm(*parts('qw_', '_w'))} <= 1.028", uses)


def joints(d: Dataflow) -> None:
    """Build the seven joint angles and, for each joint, the mask of targets whose angle is outside its limits."""
    d.at("joints")
    _ball(d, "qs", JOINTS[:3])
    _twice(d, "th4", angle(d, "qe_e", Angle(d.nodes["qe_i"], d.nodes["qe_w"], -1)))
    _ball(d, "qw", JOINTS[4:])
    for k, (low, high) in enumerate(d.limits, start=1):
        d.mask(f"over_{k}", Outside(d.nodes[f"th{k}"], low, high))


def _ball(d: Dataflow, q: str, names: tuple[str, ...]) -> None:
    """Build the angles ``names`` of the three joints that together turn by the quaternion ``q``."""
    n = d.nodes
    fmt = Format(d.width + 3, d.width + 1, "W + 1", signed=False)
    for name, x, y in (("d", "i", "j"), ("s", "w", "k")):
        of = Angle(n[f"{q}_{x}"], n[f"{q}_{y}"])
        proof = f"={q}_{x}{y}; {'=qs_len; ' * (q == 'qs')}words of Q{q[1]}"
        of.length = d.node(f"{q}_{x}{y}", Gained(of), fmt, within=GAINED, proof=proof)
        angle(d, f"{q}_{name}", of)
    between = angle(d, f"{q}_b", Angle(n[f"{q}_wk"], n[f"{q}_ij"]))
    facts: Record = {"rounding": HALF_UP, "ends": WRAP, "within": TURN, "grows": ROUNDED_SUM}
    one, other = n[f"{q}_s"], n[f"{q}_d"]
    for name, sign in ((names[0], 1), (names[2], -1)):
        turned = tuple(n[bit] for bit in TURNED[name])
        total = Sum((1, one), (sign, other), (1, Select(Logic("xor", ANY, *turned), -1, 0)))
        d.node(name, Choice(total, "joint", one, other, sign, turned, free=True), d.word(0), "sum2", **facts)
    _twice(d, names[1], between)


def angle(d: Dataflow, name: str, of: Angle) -> Node:
    """Build the node of an angle.  If the vector's length is a node, the angle starts after that node."""
    bits = d.width + 4
    latency = "vector_y" if of.length else "vector"
    return d.node(name, of, Format(bits, bits - 1, "W + 3"), latency, after=of.length, within=TURN)


def _twice(d: Dataflow, name: str, half: Node) -> None:
    facts: Record = {"rounding": HALF_UP, "ends": WRAP, "within": TURN, "grows": Growth((2.0,))}
    term, negated = 2 * half, d.nodes[NEGATED[name]]
    d.node(name, Choice(Select(negated, -term, term), "twice", half, negated, free=True), d.word(0), **facts)
