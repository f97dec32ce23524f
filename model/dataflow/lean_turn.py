# SPDX-License-Identifier: Apache-2.0
"""Section "turn" of the lean dataflow, and the lean dataflow as a whole."""

from .annotations import SUM, Limited, Within
from .choices import add_sub, mantissa, signed
from .expressions import HALF_UP
from .lean import CIRCLE, FOURFOLD, PAIR, UPPER_HALF, Lean, direction, equations, guard, norm, triangle
from .mul3 import Mul3
from .nodes import SATURATE, Dataflow, Node, Record
from .quadratic import HalfAngle, Rsqrt

PART = Within(-1.0, 1.0, "parts of quaternions no longer than 1")
LENGTH_INVERSE = Within(0.0, 1.5, "1/(2 sqrt L) with L >= 1/8")
MOST = Limited("1 and more becomes the largest mantissa")


def lean(d: Dataflow, target: dict[str, Node]) -> None:
    """Build all nodes of the datapath, from the input words ``target`` (keys ``FIELDS`` of :mod:`model.io.words`) to
    the results.  A node and its signal in the RTL have the same name."""
    guard(d, target)
    sections(d, target["phi"])


def sections(d: Dataflow, phi: Node) -> None:
    """Build everything after :func:`.lean.guard`, whose nodes are in ``d.nodes``."""
    formats = Lean(d.width)
    direction(d, formats)
    triangle(d, formats)
    turn(d, formats, phi)


def turn(d: Dataflow, f: Lean, phi: Node) -> None:
    """Build Qs, the normalized product of four rotations: by the azimuth plus 90 degrees, the tilt, phi, and -a."""
    n = d.nodes
    az_c, az_s, tilt_c, tilt_s = (n[name] for name in ("az_c", "az_s", "tilt_c", "tilt_s"))
    d.at("turn")
    d.half_angle = "sin_h", "cos_h"
    d.lemma("phi", f"{norm('sin_h', 'cos_h')} == 1", "=sin_h")
    sin_h = d.node("sin_h", HalfAngle(phi, "sin"), f.inner, within=CIRCLE, proof=("phi",))
    cos_h = d.node("cos_h", HalfAngle(phi, "cos"), f.inner, within=UPPER_HALF, proof=("phi", "=cos_h"))
    cc = d.node("cc", Mul3(az_c, cos_h), f.inner, within=PART)
    ss = d.node("ss", Mul3(az_s, sin_h), f.inner, within=PART)
    sc = d.node("sc", Mul3(az_s, cos_h), f.inner, within=PART)
    cs = d.node("cs", Mul3(az_c, sin_h), f.inner, within=PART)
    # cosines and sines of half the sum and half the difference of azimuth and phi, not normalized
    plus: Record = {"within": PART, "grows": SUM, "proof": ("az + phi", "az_sq")}
    minus: Record = plus | {"proof": ("az - phi", "az_sq")}
    c_plus = d.node("c_plus", cc - ss, f.inner, **plus)
    s_plus = d.node("s_plus", sc + cs, f.inner, **plus)
    c_minus = d.node("c_minus", cc + ss, f.inner, **minus)
    s_minus = d.node("s_minus", sc - cs, f.inner, **minus)
    for sign, name in (("+", "plus"), ("-", "minus")):
        uses: tuple[str, ...] = equations(f"c_{name}", f"s_{name}", "cc", "ss", "sc", "cs")
        d.lemma(f"az {sign} phi", f"{norm(f'c_{name}', f's_{name}')} <= az_sq", *uses, "az", "phi")
    w_0 = d.node("w_0", Mul3(tilt_c, c_plus), f.inner, "mul3_far", within=PART)
    i_0 = d.node("i_0", Mul3(tilt_s, c_minus), f.inner, "mul3_far", within=PART)
    j_0 = d.node("j_0", Mul3(tilt_s, s_minus), f.inner, "mul3_far", within=PART)
    k_0 = d.node("k_0", Mul3(tilt_c, s_plus), f.inner, "mul3_far", within=PART)
    last_rotation(d, f, (w_0, i_0), (k_0, j_0))

    # The squared length, in [1/8, 1], is a product of three known lengths: the last root does not wait for Qs.
    within = Within(0.25, 1.0, "a product of such")
    az_tilt_sq = d.node("az_tilt_sq", Mul3(n["az_sq"], n["tilt_sq"]), f.inner, within=within)
    within = Within(0.125, 1.0, "a product of such")
    length_sq = d.node("length_sq", Mul3(az_tilt_sq, n["bend_sq"]), f.inner, within=within)
    low = d.mask("low", length_sq < 0.25, None)
    # Below 1/4, the mantissa is four times the squared length, and the root is doubled.
    facts: Record = {"within": Within(0.25, 1.0, "mantissa"), "grows": FOURFOLD, "limited": MOST}
    m_q = d.node("m_q", mantissa(length_sq, low), f.mantissa, ends=SATURATE, **facts)
    proof: tuple[str, ...] = ("1/|q|", "length_sq", "=inv_q")
    inv_q = d.node("inv_q", Rsqrt(m_q, twice=low), f.inner, within=LENGTH_INVERSE, proof=proof)
    uses = equations("w_0", "i_0", "j_0", "k_0", "az_tilt_sq")
    statement = f"{norm('w_0', 'i_0', 'j_0', 'k_0')} <= az_tilt_sq"
    d.lemma("q_0", statement, *uses, "az + phi", "az - phi", "tilt", "az_sq")
    d.lemma("1/|q|", "4*length_sq*inv_q*inv_q == 1", "=inv_q", "=m_q", "length_sq")
    length_lemmas(d)

    # The sign of Qs is free, and chosen so that the k part is nonnegative.
    k_minus = d.mask("minus", n["k_1"] < 0, None)
    for unit in "wijk":
        proof = (f"={unit}_q", "q_1", "=wi_1_len", "=kj_1_len", "1/|q|", "length_sq")
        product = Mul3(n[f"{unit}_1"], inv_q, scale=1)
        unrounded = d.node(f"{unit}_q", product, f.inner, "mul3_far", within=PART, proof=proof)
        d.at(equation="(18)")
        d.node(f"qs_{unit}", signed(unrounded, k_minus), f.result, rounding=HALF_UP, within=PART)
        d.at()


def last_rotation(d: Dataflow, f: Lean, *pairs: tuple[Node, Node]) -> None:
    """Build w_1 .. k_1, each pair from three products: w c + i s = (w + i) c - i (c - s), and
    i c - w s = (w + i) c - w (c + s)."""
    n = d.nodes
    part: Record = {"within": PART, "grows": SUM, "proof": ("q_1", "=wi_1_len", "=kj_1_len", "length_sq")}
    for first, second in pairs:
        one, two = first.name[0], second.name[0]
        both, proof = one + two, (f"={one}{two}_0", "q_0", "az_tilt_sq")
        total = d.node(f"{both}_0", first + second, f.inner, within=PAIR, grows=SUM, proof=proof)
        far: Record = {"latency": "mul3_far", "within": PAIR}
        whole = d.node(f"{both}_c", Mul3(total, n["bend_c"]), f.inner, **far)
        dif = d.node(f"{two}_dif", Mul3(second, n["bend_dif"]), f.inner, after=total, **far)
        # bend_dif, the larger part minus the smaller, is s - c where bend_swap is set.
        d.node(f"{one}_1", add_sub(whole, dif, n["bend_swap"]), f.inner, **part)
        plus = d.node(f"{one}_sum", Mul3(first, n["bend_sum"]), f.inner, after=total, **far)
        d.node(f"{two}_1", whole - plus, f.inner, **part)
        for unit, other, sign, uses in ((one, two, "+", f"{two}_dif"), (two, one, "-", f"{one}_sum")):
            statement = f"{unit}_1 == {unit}_0*bend_c {sign} {other}_0*bend_s"
            d.lemma(f"{unit} turned", statement, *equations(f"{unit}_1", f"{both}_c", uses, f"{both}_0"), "swap")


def length_lemmas(d: Dataflow) -> None:
    """State the lemmas on the length of the product.  Proofs treat each sum of squares in them as one number."""
    for name in ("wi", "kj"):
        d.definitions[f"{name}_len"] = norm(*(f"{part}_0" for part in name))
        d.definitions[f"{name}_1_len"] = norm(*(f"{part}_1" for part in name))
    d.definitions["bend_len"] = norm("bend_c", "bend_s")
    for one, two in ("wi", "kj"):
        uses: tuple[str, ...] = equations(f"{one}{two}_1_len", f"{one}{two}_len", "bend_len")
        statement = f"{one}{two}_1_len == {one}{two}_len*bend_len"
        d.lemma(f"|{one}{two}_1|", statement, f"{one} turned", f"{two} turned", *uses)
    statement = "0 <= wi_len and 0 <= kj_len and wi_len + kj_len <= az_tilt_sq"
    d.lemma("|q_0|", statement, "q_0", "=wi_len", "=kj_len")
    d.lemma("|bend|", "0 <= bend_len and bend_len <= bend_sq", "bend", "=bend_len")
    uses = ("|q_0|", "|bend|", "=length_sq", "az_tilt_sq", "bend_sq")
    d.lemma("|q_0| |bend|", "(wi_len + kj_len)*bend_len <= length_sq", *uses)
    d.lemma("q_1", "wi_1_len + kj_1_len <= length_sq", "|wi_1|", "|kj_1|", "|q_0| |bend|")
