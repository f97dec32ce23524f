# SPDX-License-Identifier: Apache-2.0
"""Dataflow of ``rtl/lean``: the paper's results, computed from two levels of reciprocal square roots.

The equations are at the top of :mod:`model.reference.lean_equations`; docs/generated/lean.md derives them from the
paper's.  A, B and K are the nodes a_far, b_near and k_law; s, rho_sq, sin_el, cos_el have the equations' names, and
(u_x, u_y) is (x, y)/rho.

Exact part.  Squares, their sums, A, B and K are integers of 2W + 2 bits; their signs decide the flags.  The argument of
every root is normalized by an even shift, so the root's relative precision does not depend on the argument's size.  The
root, and every node computed from it, then has a power of two as its unit.

Formats.  An inner word has F = W + 5 fraction bits, but at least 22 and at most 33, and a range of [-2, 2).  A root has
22 fraction bits up to W = 18; above, it has F, but at most 31.  Its argument, a mantissa m, has 3 more.  The root is
1/(2 sqrt(m)), in (1/2, 1]; it is 1 where m = 0.

Rounding.  ``Mul3`` omits or estimates the product of the two low parts and rounds half up.  Roots are faithful, shifts
round down, results are rounded half up to W - 2 fraction bits.

Proofs.  Each range has its reason and, as ``proof``, the facts from which z3 derives it (:mod:`tb.formal.lean_proofs`),
separated by semicolons:
``=node`` is the node's equation and ``node`` its range.  ``~node`` states that the word's error is within its bound.
``#node`` states that an exact word's magnitude is 0, one ulp, or at least two ulps.  Other names are lemmas,
stated after their nodes.  A range without ``proof`` follows from the node's equation and its operands' ranges.
"""

from . import lean_operations as ops
from .expressions import FLOOR, HALF_UP, Product, Select, square, zero
from .formats import Format, LeanFormats
from .lean_operations import Count, Even, EvenCount, ShiftDown, ShiftUp
from .mul3 import Mul3
from .nodes import SATURATE, SUM, Dataflow, Growth, Limited, Node, Record, Within
from .quadratic import HalfAngle, Rsqrt

SECTIONS = {
    "guard": "exact squares and flags",
    "direction": "azimuth and elevation",
    "triangle": "shoulder angle, elbow",
    "turn": "shoulder quaternion",
    "results": "what leaves the datapath",
}
"""Section name -> description; the RTL module is ``ik_lean_<section>``, its instance ``u_<section>``."""

# Exact ranges of the nodes from geometry, with the reason.

SQUARES = "squares of words in [-2, 2)"
MOST_COUNT = 63.0  # largest shift count of six bits
MANTISSA = Within(0.0, 1.0, "mantissa", below=True)
INVERSE = Within(0.0, 1.0, "1/(2 sqrt m) with m >= 1/4")
INVERSES = Within(0.0, 1.0, "products of inverses")
COORDINATE = Within(-1.0, 1.0, "coordinates are no longer than the vector", below=True)
CIRCLE = Within(-1.0, 1.0, "a sine or cosine")
UPPER_HALF = Within(0.0, 1.0, "a sine or cosine")
ROOT = Within(0.0, 1.0, "the root of a mantissa")
SQUARED_LENGTH: Record = {"rounding": FLOOR, "within": Within(0.5, 1.0, "(1 + |c|)/2")}
HALF_ANGLE = Within(-1.0, 1.0, "half angles: squared length (1 + |c|)/2")
PAIR = Within(-1.5, 1.5, "sums of two parts of such, at most the root of 2, and products of them")
PART = Within(-1.0, 1.0, "parts of quaternions no longer than 1")
LENGTH_INVERSE = Within(0.0, 1.5, "1/(2 sqrt L) with L >= 1/8")
ELBOW_W, ELBOW_I = Within(0.0, 1.0, "a component of Qe"), Within(-1.0, 0.0, "a component of Qe")
RISES = "e_rho >= e_s, because rho <= |p|"
ARMS_UNIT = Within(0.0, 2.0, "sqrt A <= 2 sqrt(d1 d2), and root_far >= 1/2")
LAW = Within(0.0, 2.0, "inv_law = 2 inv_11 inv_s")
LAW_UNIT = Within(0.0, 2.0, "sin a <= 1, and root_ab >= 1/4, or 0 and |d1 - d2| a place or more")
K_UNIT = Within(-2.0, 2.0, "|K| <= 2 d1 |p|, and inv_law > 1/4", below=True)

# Saturation that is intended.

TWO = Limited("2, which powers of two can give, becomes the largest word")
ONE = Limited("1, which powers of two can give, becomes the largest word")
MOST = Limited("1 and more becomes the largest mantissa")

FOURFOLD, EIGHTFOLD = Growth((4.0,)), Growth((8.0,))

WIDTHS = range(3, 33)
"""Word lengths supported by the lean datapath; those below 16 serve only exhaustive tests."""

# Facts that several proofs use.

CASE = "case; =clamp; =too_far; =too_near; =bad_length; =at_shoulder"
LENGTHS = "=d1; =d2"
TARGET = "=s; =rho_sq; =x_sq; =y_sq; =z_sq"


def norm(*parts: str) -> str:
    """Return the sum of the squares of parts, as text."""
    return " + ".join(f"{part}**2" for part in parts)


def lean(d: Dataflow, target: dict[str, Node]) -> None:
    """Build all nodes of the datapath, from the input words ``target`` (keys ``FIELDS`` of :mod:`model.io.words`) to
    the results.  A node and its signal in the RTL have the same name."""
    formats = LeanFormats(d.width)
    guard(d, formats, target)
    direction(d, formats)
    triangle(d, formats)
    turn(d, formats, target["phi"])


def guard(d: Dataflow, f: LeanFormats, target: dict[str, Node]) -> None:
    """Compute exact integers from the input words, and from these integers the flags."""
    x, y, z, d1, d2 = (target[k] for k in ("x", "y", "z", "d1", "d2"))
    d.at("guard")
    bad_length = d.mask("bad_length", (d1 <= 0) | (d2 <= 0))
    d.mask("on_axis", zero(x) & zero(y))
    at_shoulder = d.mask("at_shoulder", zero(x) & zero(y) & zero(z))

    within = Within(0.0, 4.0, SQUARES, below=True)
    d_sum = d.node("d_sum", d1 + d2, f.length, within=within, proof=f"=d_sum; {LENGTHS}")
    d_dif = d.node("d_dif", d1 - d2, f.length, within=Within(-2.0, 2.0, SQUARES), proof=f"=d_dif; {LENGTHS}")

    def squared(word: Node, most: float, **record) -> Node:
        within = Within(0.0, most, SQUARES, below=most > 4)
        return d.node(f"{word.name}_sq", square(word), f.exact, "square", within=within, **record)

    x_sq, y_sq, z_sq = (squared(p, 4.0, proof=f"={p.name}_sq; ={p.name}_w") for p in (x, y, z))
    d_sum_sq, d_dif_sq = squared(d_sum, 16.0), squared(d_dif, 4.0)
    within, proof = Within(-4.0, 4.0, SQUARES), f"=sum_dif; =d_sum; =d_dif; {LENGTHS}"
    sum_dif = d.node("sum_dif", Product(d_sum, d_dif), f.exact, "product", within=within, proof=proof)  # d1^2 - d2^2
    rho_sq = d.node("rho_sq", x_sq + y_sq, f.exact, "wide", within=Within(0.0, 8.0, SQUARES))
    s = d.node("s", rho_sq + z_sq, f.exact, "wide", within=Within(0.0, 12.0, SQUARES))
    within, proof = Within(0.0, 16.0, SQUARES, below=True), f"{CASE}; {LENGTHS}; =a_far; d_sum_sq; s"
    a_far = d.node("a_far", d_sum_sq - s, f.exact, "wide", within=within, proof=proof)
    within, proof = Within(0.0, 12.0, SQUARES), f"{CASE}; {LENGTHS}; =b_near; s; d_dif_sq"
    b_near = d.node("b_near", s - d_dif_sq, f.exact, "wide", within=within, proof=proof)
    d.node("k_law", s + sum_dif, f.exact, "wide", within=Within(-4.0, 16.0, SQUARES))

    d.lemma("s > 0", "0 < s", f"{CASE}; {TARGET}")
    d.lemma("target", f"s == {norm('x_w', 'y_w', 'z_w')}", TARGET)
    d.lemma("rho <= |p|", "rho_sq <= s", "=s; =z_sq")
    sums = "=a_far; =b_near; =d_sum_sq; =d_dif_sq; =d_sum; =d_dif"
    d.lemma("A + B", "a_far + b_near == 4*d1*d2", sums)
    d.lemma("A <= 4 d1 d2", "a_far <= 4*d1*d2", "A + B; b_near")
    d.lemma("B <= 4 d1 d2", "b_near <= 4*d1*d2", "A + B; a_far")
    d.lemma("K^2 + A B", "k_law*k_law + a_far*b_near == 4*d1*d1*s", f"=k_law; =sum_dif; {sums}")
    d.lemma("A B <= 4 d1^2 s", "a_far*b_near <= 4*d1*d1*s", "K^2 + A B")

    too_far = d.mask("too_far", (a_far < 0) & ~bad_length)
    too_near = d.mask("too_near", (b_near < 0) & ~bad_length)
    # A clamped arm is straight or closed along the line to the target.
    d.mask("clamp", too_far | too_near | at_shoulder | bad_length)
    d.mask("closed", (too_near | at_shoulder) & ~bad_length)
    d.mask("away", too_near & (d_dif < 0))


def direction(d: Dataflow, f: LeanFormats) -> None:
    """Build (u_x, u_y) = (x, y)/rho, sin_el = z/|p|, cos_el = rho/|p|, and the half angles of azimuth and tilt."""
    n = d.nodes
    x, y, z, rho_sq, s = (n[name] for name in ("x", "y", "z", "rho_sq", "s"))
    d.at("direction")
    e_rho, m_rho, inv_rho = root(d, f, "rho", rho_sq, 2 * d.width)
    e_s, m_s, inv_s = root(d, f, "s", s, 2 * d.width)

    # Build a coordinate in the unit of its root: |x| <= rho, so no high bit is lost.
    def unit(name: str, word: Node, count: Node, proof: str) -> Node:
        return d.node(name, ShiftUp(word, count, -2), f.shifted, "shift", within=COORDINATE, proof=proof)

    x_n, y_n = (unit(name, word, e_rho, "direction; m_rho") for name, word in (("x_n", x), ("y_n", y)))
    z_n = unit("z_n", z, e_s, "elevation; m_s")
    d.lemma("direction", f"m_rho == {norm('x_n', 'y_n')}", "=x_n; =y_n; =m_rho; =rho_sq; =x_sq; =y_sq")
    d.lemma("elevation", "z_n*z_n <= m_s", f"=z_n; =m_s; {TARGET}")
    u_x = d.node("u_x", Mul3(x_n, inv_rho, scale=1), f.inner, within=CIRCLE, proof="|u| <= 1")
    u_y = d.node("u_y", Mul3(y_n, inv_rho, scale=1), f.inner, within=CIRCLE, proof="|u| <= 1")
    sin_el = d.node("sin_el", Mul3(z_n, inv_s, scale=1), f.inner, within=CIRCLE, proof="|el| = 1")
    proof = "=root_rho; inv_rho; root of m_rho; m_rho"
    root_rho = d.node("root_rho", Mul3(inv_rho, m_rho, scale=1), f.inner, within=ROOT, proof=proof)  # sqrt(m)
    proof = "=n_el; rho <= |p|; s > 0; rho_sq; =m_rho; =e_rho; =m_s; =e_s"
    n_el = d.node("n_el", Count((1, e_rho), (-1, e_s)), d.count, within=Within(0.0, MOST_COUNT, RISES), proof=proof)
    risen: Record = {"rounding": FLOOR, "within": Within(0.0, 1.0, RISES)}
    inv_s_el = d.node("inv_s_el", ShiftDown(inv_s, n_el), f.inner, "shift", **risen)
    proof = "=cos_el; root_rho; inv_s_el; |el| = 1"
    cos_el = d.node("cos_el", Mul3(root_rho, inv_s_el, scale=1), f.inner, "mul3_far", within=UPPER_HALF, proof=proof)
    d.lemma("|u| <= 1", f"{norm('u_x', 'u_y')} <= 1", "=u_x; =u_y; =inv_rho; direction")
    d.lemma("root of m_rho", "root_rho*root_rho == m_rho", "=root_rho; =inv_rho")
    uses = "root of m_rho; =n_el; =m_rho; =e_rho; =e_s; =m_s; =z_n; =s; =z_sq; s > 0"
    d.lemma("rho in p's unit", "root_rho*root_rho == n_el*n_el*(m_s - z_n*z_n)", uses)
    d.lemma("1/|p|", "4*m_s*inv_s*inv_s == 1", "=inv_s; =m_s; s > 0")
    uses = "=sin_el; =cos_el; =inv_s_el; =n_el; rho in p's unit; 1/|p|"
    d.lemma("|el| = 1", f"{norm('sin_el', 'cos_el')} == 1", uses)

    # The first rotation turns by the azimuth plus 90 degrees: cosine -u_y, sine u_x.  On the z axis both are 0, and the
    # azimuth counts as 0: the parts are (1, 1)/2.  The parts do not wait for the squared length.
    d.node("az_sq", ops.half_length(u_y), f.inner, **SQUARED_LENGTH)
    az: Record = {"rounding": FLOOR, "within": HALF_ANGLE, "proof": "az; az_sq"}
    d.node("az_c", ops.half_part(u_y, u_x, (u_y < 0) | n["on_axis"]), f.inner, **az)
    d.node("az_s", ops.half_part(u_y, u_x, u_y >= 0), f.inner, **az)
    # The second rotation turns by the angle between p and the z axis.  A target at the shoulder, where cosine and sine
    # are 0, counts as one on the +z axis: the parts are (1, 0).
    proof = f"{CASE}; =tilt_sq; sin_el"
    tilt_sq = d.node("tilt_sq", ops.half_length(sin_el, n["at_shoulder"]), f.inner, **SQUARED_LENGTH, proof=proof)
    tilt: Record = {"rounding": FLOOR, "within": HALF_ANGLE, "proof": "tilt; tilt_sq"}
    d.node("tilt_c", ops.half_part(sin_el, cos_el, sin_el >= 0, tilt_sq), f.inner, **tilt)
    d.node("tilt_s", ops.half_part(sin_el, cos_el, sin_el < 0, tilt_sq), f.inner, **tilt)
    d.lemma("az", f"{norm('az_c', 'az_s')} <= az_sq", "=az_c; =az_s; =az_sq; |u| <= 1; =on_axis; =u_y; =y_n")
    d.lemma("tilt", f"{norm('tilt_c', 'tilt_s')} <= tilt_sq", f"{CASE}; =tilt_c; =tilt_s; =tilt_sq; |el| = 1")


def triangle(d: Dataflow, f: LeanFormats) -> None:
    """Build Qe (14) and the half angle of a, the shoulder angle: cos a = K/(2 d1 |p|), sin a = sqrt(A B)/(2 d1 |p|)."""
    n = d.nodes
    e_s, inv_s, clamp, closed, away = (n[name] for name in ("e_s", "inv_s", "clamp", "closed", "away"))
    d.at("triangle")
    e_far, m_far, inv_far = root(d, f, "far", n["a_far"], 2 * d.width)
    e_near, m_near, inv_near = root(d, f, "near", n["b_near"], 2 * d.width)
    e_1, _, inv_1 = root(d, f, "1", n["d1"], f.even_width)
    e_2, _, inv_2 = root(d, f, "2", n["d2"], f.even_width)
    roots = {}
    for side, inverse, m in (("far", inv_far, m_far), ("near", inv_near, m_near)):
        proof = f"=root_{side}; inv_{side}; root of m_{side}; m_{side}"
        roots[side] = d.node(f"root_{side}", Mul3(inverse, m, scale=1), f.inner, within=ROOT, proof=proof)
        d.lemma(f"root of m_{side}", f"root_{side}*root_{side} == m_{side}", f"=root_{side}; =inv_{side}")
    # inv_12 = 1/(4 sqrt(m_1 m_2)) is shifted to the units of sqrt A and sqrt B below
    fine = Format(f.frac + 2, f.frac + 1, "FRAC + 1")
    d.node("inv_12_raw", Mul3(inv_1, inv_2), Format(f.frac + 3, f.frac + 1, "FRAC + 1"), within=INVERSES)
    inv_12 = limited(d, "inv_12", INVERSES, fine, ONE)
    for name in "12":
        d.lemma(f"1/d{name}", f"4*m_{name}*inv_{name}*inv_{name} == 1", f"=inv_{name}; =m_{name}; =d{name}")
    d.lemma("1/(d1 d2)", "16*m_1*m_2*inv_12*inv_12 == 1", "=inv_12; =inv_12_raw; 1/d1; 1/d2")

    elbow = {}
    for side, count, exact, root_of, half in (("far", e_far, "a_far", "A", "w"), ("near", e_near, "b_near", "B", "i")):
        sizes = f"=m_{side}; =e_{side}; =m_1; =e_1; =m_2; =e_2"
        shorter, total = f"{root_of} <= 4 d1 d2", Count((1, count), (-1, e_1), (-1, e_2), constant=2 + f.odd)
        within = Within(0.0, MOST_COUNT, f"sqrt {root_of} <= 2 sqrt(d1 d2)")
        proof = f"=n_{side}; {shorter}; {exact}; {LENGTHS}; {sizes}"
        steps = d.node(f"n_{side}", total, d.count, within=within, proof=proof)
        raw, name = f"inv_12_{side}_raw", f"inv_12_{side}"
        proof = f"={raw}; =n_{side}; n_{side}; inv_12; =elbow_{half}; ={name}; elbow_{half}; root_{side}; "
        proof += f"root of m_{side}; {exact}; {sizes}; {LENGTHS}"
        facts: Record = {"rounding": FLOOR, "within": ARMS_UNIT, "grows": EIGHTFOLD, "proof": proof}
        d.node(raw, ShiftDown(inv_12, steps, 3), f.raised, "shift", **facts)
        shifted = limited(d, name, ARMS_UNIT, f.inner)
        proof = f"=elbow_{half}; elbow {half}; {shorter}; ={name}; ={raw}; =n_{side}; inv_12; root_{side}; "
        proof += f"root of m_{side}; =m_{side}; =e_{side}; {exact}; {LENGTHS}"
        product = Mul3(roots[side], shifted)
        elbow[half] = d.node(f"elbow_{half}", product, f.inner, "mul3_far", within=ELBOW_W, proof=proof)
        uses = f"=elbow_{half}; ={name}; ={raw}; =n_{side}; root of m_{side}; 1/(d1 d2); {sizes}; {LENGTHS}"
        d.lemma(f"elbow {half}", f"4*d1*d2*elbow_{half}*elbow_{half} == {exact}", uses)

    # The clamped elbow is closed (1, 0) or straight (0, -1).
    d.at(equation="(14)")
    for half, sign, ends, within in (("w", 1, (1, 0), ELBOW_W), ("i", -1, (0, -1), ELBOW_I)):
        facts = {"rounding": HALF_UP, "within": within, "proof": f"case; =qe_{half}; elbow_{half}"}
        d.node(f"qe_{half}", ops.elbow(elbow[half], sign, clamp, closed, ends), f.result, **facts)
    d.at()

    # inv_law = 1/(4 m_1 sqrt(m_s)), which is 1/(4 d1 |p|) in the units of d1 and |p|
    inv_11 = d.node("inv_11", Mul3(inv_1, inv_1), f.inner, within=INVERSES)
    d.node("inv_law_raw", Mul3(inv_11, inv_s, scale=1), f.doubled, within=LAW, proof="=inv_law_raw; inv_11; inv_s")
    inv_law = limited(d, "inv_law", LAW, f.inner)
    # K in the same units; at most 2, because |K| <= 2 d1 |p|
    n_law = d.node("n_law", Count((2, e_1), (1, e_s)), d.count)
    k_unit: Record = {"rounding": FLOOR, "within": K_UNIT}
    proof = "cos_a; =cos_a; 1/(d1 |p|); 1/|p|; m_1; =m_1; =d1; m_s; inv_s"
    k_law = ShiftUp(n["k_law"], n_law, -4 - f.odd)
    k_scaled = d.node("k_scaled", k_law, f.inner, "shift3", proof=proof, **k_unit)
    cos_a = d.node("cos_a", Mul3(k_scaled, inv_law, scale=1), f.inner, within=CIRCLE, proof="|a| = 1")
    root_ab = d.node("root_ab", Mul3(roots["far"], roots["near"]), f.inner, within=ROOT)
    d.lemma("1/(d1 |p|)", "2*m_1*inv_law == inv_s", "=inv_law; =inv_law_raw; =inv_11; 1/d1")
    uses = "=cos_a; =k_scaled; =n_law; 1/(d1 |p|); 1/|p|; =m_1; =e_1; =m_s; =e_s; =d1; s > 0"
    d.lemma("cos a", "4*d1*d1*s*cos_a*cos_a == k_law*k_law", uses)

    total = Count((1, e_far), (1, e_near), (-2, e_1), (-1, e_s), constant=2 + f.odd)
    sizes = "=m_far; =e_far; =m_near; =e_near; =m_1; =e_1; =m_s; =e_s"
    proof = f"=n_ab; law; A + B; a_far; b_near; {sizes}; =ulp; {LENGTHS}"
    n_ab = d.node("n_ab", total, d.count, "sum2", within=Within(0.0, MOST_COUNT, "sin a <= 1"), proof=proof)
    proof = "=inv_law_ab_raw; =n_ab; inv_law; 1/(d1 |p|) by n_ab; law"
    facts = {"rounding": FLOOR, "within": LAW_UNIT, "grows": FOURFOLD, "proof": proof}
    d.node("inv_law_ab_raw", ShiftDown(inv_law, n_ab, 2), f.raised, "shift", **facts)
    inv_law_ab = limited(d, "inv_law_ab", LAW_UNIT, f.inner)
    proof = "|a| = 1; =sin_a; =root_ab; root_far; root_near; =inv_law_ab; =inv_law_ab_raw; =n_ab; inv_law"
    sin_a = d.node("sin_a", Mul3(root_ab, inv_law_ab, scale=1), f.inner, "mul3_far", within=UPPER_HALF, proof=proof)
    triangle_lemmas(d)

    # The last rotation turns by -a.  A clamped upper arm points to the target, (1, 0), or away from it, (0, 1).
    proof = "case; =bend_sq; cos_a"
    bend_sq = d.node("bend_sq", ops.half_length(cos_a, clamp), f.inner, **SQUARED_LENGTH, proof=proof)
    toward = Select(clamp, ~away, cos_a >= 0)
    facts = {"rounding": FLOOR, "within": HALF_ANGLE, "proof": "bend; bend_sq"}
    d.node("bend_c", ops.half_part(cos_a, sin_a, toward, bend_sq, clamp), f.inner, **facts)
    d.node("bend_s", ops.half_part(cos_a, sin_a, ~toward, bend_sq, clamp), f.inner, **facts)
    # Given c + s, and the larger part minus the smaller, the rotation takes three products instead of four.
    d.mask("bend_swap", Select(clamp, away, cos_a < 0))
    for name, sign in (("bend_dif", -1), ("bend_sum", 1)):
        facts = {"rounding": FLOOR, "within": PAIR, "grows": SUM, "proof": f"case; ={name}; bend_sq; sin_a"}
        d.node(name, ops.half_sum(bend_sq, sin_a, clamp, sign), f.inner, **facts)
    d.lemma("bend", f"{norm('bend_c', 'bend_s')} <= bend_sq", "case; =bend_c; =bend_s; =bend_sq; |a| = 1")
    swapped = "bend_sum == bend_c + bend_s and bend_dif == (bend_s - bend_c if bend_swap else bend_c - bend_s)"
    d.lemma("swap", swapped, "case; =bend_sum; =bend_dif; =bend_swap; =bend_c; =bend_s")


def triangle_lemmas(d: Dataflow) -> None:
    """State the lemmas on sin a.  n_ab >= 0, because sin a <= 1 or, for A B = 0, because lengths are whole ulps."""
    d.lemma("|a| = 1", f"{norm('cos_a', 'sin_a')} <= 1", "cos a; sin a; K^2 + A B; s > 0; =d1")
    uses = "=sin_a; =inv_law_ab; =inv_law_ab_raw; =n_ab; =root_ab; root of m_far; root of m_near; 1/(d1 |p|); 1/|p|; "
    uses += "=m_far; =m_near; =m_1; =m_s; =e_far; =e_near; =e_1; =e_s; =d1; s > 0"
    d.lemma("sin a", "4*d1*d1*s*sin_a*sin_a == a_far*b_near", uses)
    in_lengths = "n_ab*n_ab*m_1*m_1*m_s*16 == e_far*e_far*e_near*e_near*d1*d1*s"
    d.lemma("n_ab in lengths", in_lengths, "=n_ab; =m_1; =m_s; =e_1; =e_s")
    law = "1 <= 4*n_ab*n_ab*m_1*m_1*m_s"
    uses = "n_ab in lengths; A B <= 4 d1^2 s; =m_far; =m_near"
    d.lemma("n_ab, A B > 0", f"implies(0 < a_far and 0 < b_near, {law})", uses)
    # straight: B = 4 d1 d2
    uses = f"n_ab in lengths; A + B; =m_far; =m_near; =e_near; =a_far; =d_sum_sq; =d_sum; =ulp; {LENGTHS}"
    d.lemma("n_ab, A = 0", f"implies(a_far == 0, {law})", uses)
    # 1/e_far is less than an ulp or, like d1, a whole number of ulps, so it is not between d1 and d1 + ulp
    d.lemma("e_far of d1", "1 < ulp*e_far or 1 <= e_far*d1 or e_far*(d1 + ulp) <= 1")
    # A = 4 d1 d2; |d1 - d2| is one ulp, or at least two
    uses = f"A + B; =m_far; =e_far; =b_near; =d_dif_sq; =d_dif; s > 0; #d_dif; e_far of d1; =ulp; {LENGTHS}"
    d.lemma("not nearer than closed", "implies(b_near == 0, ulp*ulp <= e_far*e_far*d1*d1*s)", uses)
    d.lemma("n_ab, B = 0", f"implies(b_near == 0, {law})", "n_ab in lengths; not nearer than closed; =m_near; =ulp")
    d.lemma("law", law, "n_ab, A B > 0; n_ab, A = 0; n_ab, B = 0; a_far; b_near")
    by_n_ab = "inv_law_ab_raw*inv_law_ab_raw*n_ab*n_ab*m_1*m_1*m_s == 1"
    d.lemma("1/(d1 |p|) by n_ab", by_n_ab, "=inv_law_ab_raw; =n_ab; 1/(d1 |p|); 1/|p|")


def turn(d: Dataflow, f: LeanFormats, phi: Node) -> None:
    """Build Qs, the normalized product of four rotations: by the azimuth plus 90 degrees, the tilt, phi, and -a."""
    n = d.nodes
    d.at("turn")
    d.half_angle = "sin_h", "cos_h"
    d.lemma("phi", f"{norm('sin_h', 'cos_h')} == 1", "=sin_h")
    sin_h = d.node("sin_h", HalfAngle(phi, "sin"), f.inner, within=CIRCLE, proof="phi")
    cos_h = d.node("cos_h", HalfAngle(phi, "cos"), f.inner, within=UPPER_HALF, proof="phi; =cos_h")
    half = {"c": cos_h, "s": sin_h}
    parts = ((a + b, Mul3(n[f"az_{a}"], half[b])) for a, b in ("cc", "ss", "sc", "cs"))
    cc, ss, sc, cs = (d.node(name, product, f.inner, within=PART) for name, product in parts)
    # cosines and sines of half the sum and half the difference of azimuth and phi, not normalized
    for name, sign, cosine, sine in (("plus", "+", cc - ss, sc + cs), ("minus", "-", cc + ss, sc - cs)):
        facts: Record = {"within": PART, "grows": SUM, "proof": f"az {sign} phi; az_sq"}
        d.node(f"c_{name}", cosine, f.inner, **facts)
        d.node(f"s_{name}", sine, f.inner, **facts)
        uses = f"=c_{name}; =s_{name}; =cc; =ss; =sc; =cs; az; phi"
        d.lemma(f"az {sign} phi", f"{norm(f'c_{name}', f's_{name}')} <= az_sq", uses)
    for part, tilt, of in (("w", "c", "c_plus"), ("i", "s", "c_minus"), ("j", "s", "s_minus"), ("k", "c", "s_plus")):
        d.node(f"{part}_0", Mul3(n[f"tilt_{tilt}"], n[of]), f.inner, "mul3_far", within=PART)
    last_rotation(d, f, ("w", "i"), ("k", "j"))

    # The squared length, in [1/8, 1], is a product of three known lengths: the last root does not wait for Qs.
    within = Within(0.25, 1.0, "a product of such")
    az_tilt_sq = d.node("az_tilt_sq", Mul3(n["az_sq"], n["tilt_sq"]), f.inner, within=within)
    within = Within(0.125, 1.0, "a product of such")
    length_sq = d.node("length_sq", Mul3(az_tilt_sq, n["bend_sq"]), f.inner, within=within)
    low = d.mask("low", length_sq < 0.25, None)
    # Below 1/4, the mantissa is four times the squared length, and the root is doubled.
    facts = {"within": Within(0.25, 1.0, "mantissa"), "grows": FOURFOLD, "limited": MOST}
    m_q = d.node("m_q", ops.mantissa(length_sq, low), f.mantissa, ends=SATURATE, **facts)
    inv_q = d.node("inv_q", Rsqrt(m_q, twice=low), f.inner, within=LENGTH_INVERSE, proof="1/|q|; length_sq; =inv_q")
    uses = "=w_0; =i_0; =j_0; =k_0; =az_tilt_sq; az + phi; az - phi; tilt; az_sq"
    d.lemma("q_0", f"{norm('w_0', 'i_0', 'j_0', 'k_0')} <= az_tilt_sq", uses)
    d.lemma("1/|q|", "4*length_sq*inv_q*inv_q == 1", "=inv_q; =m_q; length_sq")
    length_lemmas(d)

    # The sign of Qs is free, and chosen so that the k part is nonnegative.
    k_minus = d.mask("minus", n["k_1"] < 0, None)
    for unit in "wijk":
        proof = f"={unit}_q; q_1; =wi_1_len; =kj_1_len; 1/|q|; length_sq"
        product = Mul3(n[f"{unit}_1"], inv_q, scale=1)
        unrounded = d.node(f"{unit}_q", product, f.inner, "mul3_far", within=PART, proof=proof)
        d.at(equation="(18)")
        d.node(f"qs_{unit}", ops.signed(unrounded, k_minus), f.result, rounding=HALF_UP, within=PART)
        d.at()


def last_rotation(d: Dataflow, f: LeanFormats, *pairs: tuple[str, str]) -> None:
    """Build w_1 and i_1 from three products, and likewise k_1 and j_1.  With c = bend_c and s = bend_s,
    w_1 = w_0 c + i_0 s = (w_0 + i_0) c - i_0 (c - s) and i_1 = i_0 c - w_0 s = (w_0 + i_0) c - w_0 (c + s)."""
    n = d.nodes
    part: Record = {"within": PART, "grows": SUM, "proof": "q_1; =wi_1_len; =kj_1_len; length_sq"}
    for one, two in pairs:
        both, first, second = one + two, n[f"{one}_0"], n[f"{two}_0"]
        proof = f"={both}_0; q_0; az_tilt_sq"
        total = d.node(f"{both}_0", first + second, f.inner, within=PAIR, grows=SUM, proof=proof)
        far: Record = {"latency": "mul3_far", "within": PAIR}
        whole = d.node(f"{both}_c", Mul3(total, n["bend_c"]), f.inner, **far)
        dif = d.node(f"{two}_dif", Mul3(second, n["bend_dif"]), f.inner, after=total, **far)
        # bend_dif, the larger part minus the smaller, is s - c where bend_swap is set.
        d.node(f"{one}_1", ops.add_sub(whole, dif, n["bend_swap"]), f.inner, **part)
        plus = d.node(f"{one}_sum", Mul3(first, n["bend_sum"]), f.inner, after=total, **far)
        d.node(f"{two}_1", whole - plus, f.inner, **part)
        for unit, other, sign, uses in ((one, two, "+", f"{two}_dif"), (two, one, "-", f"{one}_sum")):
            statement = f"{unit}_1 == {unit}_0*bend_c {sign} {other}_0*bend_s"
            d.lemma(f"{unit} turned", statement, f"={unit}_1; ={both}_c; ={uses}; ={both}_0; swap")


def length_lemmas(d: Dataflow) -> None:
    """State the lemmas on the length of the product of rotations.  Proofs treat each sum of squares as one number."""
    for name in ("wi", "kj"):
        d.definitions[f"{name}_len"] = norm(*(f"{part}_0" for part in name))
        d.definitions[f"{name}_1_len"] = norm(*(f"{part}_1" for part in name))
    d.definitions["bend_len"] = norm("bend_c", "bend_s")
    for one, two in ("wi", "kj"):
        uses = f"{one} turned; {two} turned; ={one}{two}_1_len; ={one}{two}_len; =bend_len"
        d.lemma(f"|{one}{two}_1|", f"{one}{two}_1_len == {one}{two}_len*bend_len", uses)
    d.lemma("|q_0|", "0 <= wi_len and 0 <= kj_len and wi_len + kj_len <= az_tilt_sq", "q_0; =wi_len; =kj_len")
    d.lemma("|bend|", "0 <= bend_len and bend_len <= bend_sq", "bend; =bend_len")
    d.lemma("|q_0| |bend|", "(wi_len + kj_len)*bend_len <= length_sq", "|q_0|; |bend|; =length_sq; az_tilt_sq; bend_sq")
    d.lemma("q_1", "wi_1_len + kj_1_len <= length_sq", "|wi_1|; |kj_1|; |q_0| |bend|")


# -- shared by the sections ------------------------------------------------------------------------------------------


def root(d: Dataflow, f: LeanFormats, name: str, value: Node, width: int) -> tuple[Node, Node, Node]:
    """Normalize the low ``width`` bits of ``value``; build and return the nodes e_<name> (count of shifts by two bits),
    m_<name> (mantissa) and inv_<name> = 1/(2 sqrt(m_<name>))."""
    whole = f"={value.name}" if value.kind == "input" else value.name  # an input's range is its equation
    even = Even(value, width)
    count = d.node(f"e_{name}", EvenCount(even), d.count)
    proof = f"=m_{name}; {whole}"
    mantissa = d.node(f"m_{name}", even, f.mantissa, rounding=FLOOR, within=MANTISSA, proof=proof)
    even.count, even.mantissa = count, mantissa
    facts: Record = {"within": INVERSE, "proof": f"=inv_{name}; {proof}"}
    return count, mantissa, d.node(f"inv_{name}", Rsqrt(mantissa), f.inner, "rsqrt_far", **facts)


def limited(d: Dataflow, name: str, within: Within, fmt: Format, why: Limited = TWO) -> Node:
    """Build the node ``name``: the node ``name``_raw, limited to the largest word of ``fmt``. If lengths are powers
    of two, ``name``_raw may be 2 (1 for inv_12), an ulp larger than that word."""
    return d.node(name, ops.limited(d.nodes[f"{name}_raw"]), fmt, ends=SATURATE, within=within, limited=why)
