# SPDX-License-Identifier: Apache-2.0
"""Lemmas that prove the exact ranges of the lean dataflow and the whole arm, and the facts that each question uses.

``=node`` is a node's equation, ``node`` its range, ``#node`` states that an exact word is 0, one ulp, or at least two,
``~node`` that the node's word is within its error. Other names are lemmas of :data:`GEOMETRY`: proved as well, or
assumed if they list no facts. Without an entry in :data:`USES`, a node's range follows from its equation and its
operands' ranges.
"""

CASE = ["case", "=clamp", "=too_far", "=too_near", "=bad_length", "=at_shoulder"]
LENGTHS = ["=d1", "=d2"]
TARGET = ["=s", "=rho_sq", "=x_sq", "=y_sq", "=z_sq"]


def _norm(*parts: str) -> str:
    return f"(+ {' '.join(f'(* {part} {part})' for part in parts)})"


def _each(before: str, after: str = "") -> list[str]:
    return [f"{before}{part}{after}" for part in "wijk"]


def _mantissas(*names: str) -> list[str]:
    return [fact for name in names for fact in (f"=m_{name}", f"=e_{name}")]


HAND = ["=bad_hand", "=hand_sq", "=hijk_sq", "=hij_sq", *_each("=h", "_sq"), *_each("=qh_")]

MOST_H = "(/ 66049.0 65536.0)"
"""Largest squared length of a good hand: (1 + 2^-8)^2."""

WORST_ERROR = {"qs": 0.004, "qe": 0.0001, "qw": 0.0001}
"""Largest error of a word at any word length. Each word's lemma follows from |w| <= |q| + e and |q| <= q^2 + 1/4."""

FRAME = "ww", "wi", "ii", "iw", "jj", "jk", "kk", "kj"
"""Products of G and Qe in Qw: f_ww is g_w times qe_i."""

SQUARES: dict[str, str] = {
    "wi_len": _norm("w_0", "i_0"),
    "kj_len": _norm("k_0", "j_0"),
    "arm_len": _norm("arm_c", "arm_s"),
    "wi_1_len": _norm("w_1", "i_1"),
    "kj_1_len": _norm("k_1", "j_1"),
    "qh_len": _norm(*_each("qh_")),
    "h_len": _norm(*_each("h_")),
    "qs_len": _norm(*_each("qs_", "_w")),
    "qe_len": _norm("qe_w_w", "qe_i_w"),
    "g_len": _norm(*_each("g_")),
    "qw_len": _norm(*_each("qw_")),
}
"""Sums of squares by name; a question treats each as one number."""

GEOMETRY: dict[str, tuple[str, list[str]]] = {
    # lemma -> (formula, facts used)
    "case": ("", []),  # one of the assumptions of CASES
    "e_far of d1": (
        # assumed: d1 and, if at least an ulp, 1/e_far are whole ulps, so 1/e_far is not between d1 and d1 + ulp
        "(or (< 1.0 (* ulp e_far)) (<= 1.0 (* e_far d1)) (<= (* e_far (+ d1 ulp)) 1.0))",
        [],
    ),
    "s > 0": ("(< 0.0 s)", [*CASE, *TARGET]),
    "target": (f"(= s {_norm('x_w', 'y_w', 'z_w')})", TARGET),
    "direction": (f"(= m_rho {_norm('x_n', 'y_n')})", ["=x_n", "=y_n", "=m_rho", "=rho_sq", "=x_sq", "=y_sq"]),
    "elevation": ("(<= (* z_n z_n) m_s)", ["=z_n", "=m_s", *TARGET]),
    "rho <= |p|": ("(<= rho_sq s)", ["=s", "=z_sq"]),
    "|u| <= 1": (f"(<= {_norm('u_x', 'u_y')} 1.0)", ["=u_x", "=u_y", "=inv_rho", "direction"]),
    "root of m_rho": ("(= (* root_rho root_rho) m_rho)", ["=root_rho", "=inv_rho"]),
    "rho in p's unit": (
        "(= (* root_rho root_rho) (* n_el n_el (- m_s (* z_n z_n))))",
        ["root of m_rho", "=n_el", "=m_rho", "=e_rho", "=e_s", "=m_s", "=z_n", "=s", "=z_sq", "s > 0"],
    ),
    "1/|p|": ("(= (* 4.0 m_s inv_s inv_s) 1.0)", ["=inv_s", "=m_s", "s > 0"]),
    "|el| = 1": (
        f"(= {_norm('sin_el', 'cos_el')} 1.0)",
        ["=sin_el", "=cos_el", "=inv_s_el", "=n_el", "rho in p's unit", "1/|p|"],
    ),
    "az": (
        f"(<= {_norm('az_c', 'az_s')} az_sq)",
        ["=az_c", "=az_s", "=az_sq", "|u| <= 1", "=on_axis", "=u_y", "=y_n"],
    ),
    "tilt": (f"(<= {_norm('tilt_c', 'tilt_s')} tilt_sq)", [*CASE, "=tilt_c", "=tilt_s", "=tilt_sq", "|el| = 1"]),
    "A + B": ("(= (+ a_far b_near) (* 4.0 d1 d2))", ["=a_far", "=b_near", "=d_sum_sq", "=d_dif_sq", "=d_sum",
        "=d_dif"]),
    "A <= 4 d1 d2": ("(<= a_far (* 4.0 d1 d2))", ["A + B", "b_near"]),
    "B <= 4 d1 d2": ("(<= b_near (* 4.0 d1 d2))", ["A + B", "a_far"]),
    "K^2 + A B": (
        "(= (+ (* k_law k_law) (* a_far b_near)) (* 4.0 d1 d1 s))",
        ["=k_law", "=sum_dif", "=a_far", "=b_near", "=d_sum_sq", "=d_dif_sq", "=d_sum", "=d_dif"],
    ),
    "1/d1": ("(= (* 4.0 m_1 inv_1 inv_1) 1.0)", ["=inv_1", "=m_1", "=d1"]),
    "1/d2": ("(= (* 4.0 m_2 inv_2 inv_2) 1.0)", ["=inv_2", "=m_2", "=d2"]),
    "root of m_far": ("(= (* root_far root_far) m_far)", ["=root_far", "=inv_far"]),
    "root of m_near": ("(= (* root_near root_near) m_near)", ["=root_near", "=inv_near"]),
    "1/(d1 d2)": ("(= (* 16.0 m_1 m_2 inv_12 inv_12) 1.0)", ["=inv_12", "=inv_12_raw", "1/d1", "1/d2"]),
    "1/(d1 |p|)": ("(= (* 2.0 m_1 inv_law) inv_s)", ["=inv_law", "=inv_law_raw", "=inv_11", "1/d1"]),
    "|a| = 1": (f"(<= {_norm('cos_a', 'sin_a')} 1.0)", ["cos a", "sin a", "K^2 + A B", "s > 0", "=d1"]),
    "phi": (f"(= {_norm('sin_h', 'cos_h')} 1.0)", ["=sin_h"]),
    "arm": (f"(<= {_norm('arm_c', 'arm_s')} arm_sq)", ["case", "=arm_c", "=arm_s", "=arm_sq", "|a| = 1"]),
    "az + phi": (f"(<= {_norm('c_plus', 's_plus')} az_sq)", ["=c_plus", "=s_plus", "=cc", "=ss", "=sc", "=cs",
        "az", "phi"]),
    "az - phi": (
        f"(<= {_norm('c_minus', 's_minus')} az_sq)", ["=c_minus", "=s_minus", "=cc", "=ss", "=sc", "=cs", "az", "phi"],
    ),
    "q_0": (
        f"(<= {_norm('w_0', 'i_0', 'j_0', 'k_0')} az_tilt_sq)",
        ["=w_0", "=i_0", "=j_0", "=k_0", "=az_tilt_sq", "az + phi", "az - phi", "tilt", "az_sq"],
    ),
    "w turned": ("(= w_1 (+ (* w_0 arm_c) (* i_0 arm_s)))", ["=w_1", "=wi_c", "=i_dif", "=wi_0", "swap"]),
    "k turned": ("(= k_1 (+ (* k_0 arm_c) (* j_0 arm_s)))", ["=k_1", "=kj_c", "=j_dif", "=kj_0", "swap"]),
    "i turned": ("(= i_1 (- (* i_0 arm_c) (* w_0 arm_s)))", ["=i_1", "=wi_c", "=w_sum", "=wi_0", "swap"]),
    "j turned": ("(= j_1 (- (* j_0 arm_c) (* k_0 arm_s)))", ["=j_1", "=kj_c", "=k_sum", "=kj_0", "swap"]),
    "swap": (
        "(and (= arm_sum (+ arm_c arm_s)) (= arm_dif (ite arm_swap (- arm_s arm_c) (- arm_c arm_s))))",
        ["case", "=arm_sum", "=arm_dif", "=arm_swap", "=arm_c", "=arm_s"],
    ),
    "|wi_1|": ("(= wi_1_len (* wi_len arm_len))", ["w turned", "i turned", "=wi_1_len", "=wi_len", "=arm_len"]),
    "|kj_1|": ("(= kj_1_len (* kj_len arm_len))", ["k turned", "j turned", "=kj_1_len", "=kj_len", "=arm_len"]),
    "|q_0|": ("(and (<= 0.0 wi_len) (<= 0.0 kj_len) (<= (+ wi_len kj_len) az_tilt_sq))", ["q_0", "=wi_len", "=kj_len"]),
    "|arm|": ("(and (<= 0.0 arm_len) (<= arm_len arm_sq))", ["arm", "=arm_len"]),
    "|q_0| |arm|": (
        "(<= (* (+ wi_len kj_len) arm_len) length_sq)",
        ["|q_0|", "|arm|", "=length_sq", "az_tilt_sq", "arm_sq"],
    ),
    "q_1": ("(<= (+ wi_1_len kj_1_len) length_sq)", ["|wi_1|", "|kj_1|", "|q_0| |arm|"]),
    "1/|q|": ("(= (* 4.0 length_sq inv_q inv_q) 1.0)", ["=inv_q", "=m_q", "length_sq"]),
    "cos a": (
        "(= (* 4.0 d1 d1 s cos_a cos_a) (* k_law k_law))",
        ["=cos_a", "=k_scaled", "=n_law", "1/(d1 |p|)", "1/|p|", "=m_1", "=m_s", "=e_1", "=e_s", "=d1", "s > 0"],
    ),
    "sin a": (
        "(= (* 4.0 d1 d1 s sin_a sin_a) (* a_far b_near))",
        ["=sin_a", "=inv_law_ab", "=inv_law_ab_raw", "=n_ab", "=root_ab", "root of m_far", "root of m_near",
        "1/(d1 |p|)",
         "1/|p|", "=m_far", "=m_near", "=m_1", "=m_s", "=e_far", "=e_near", "=e_1", "=e_s", "=d1", "s > 0"],
    ),
    "A B <= 4 d1^2 s": ("(<= (* a_far b_near) (* 4.0 d1 d1 s))", ["K^2 + A B"]),
    "n_ab in lengths": (
        "(= (* n_ab n_ab m_1 m_1 m_s 16.0) (* e_far e_far e_near e_near d1 d1 s))",
        ["=n_ab", "=m_1", "=m_s", "=e_1", "=e_s"],
    ),
    "n_ab, A B > 0": (
        "(=> (and (< 0.0 a_far) (< 0.0 b_near)) (<= 1.0 (* 4.0 n_ab n_ab m_1 m_1 m_s)))",
        ["n_ab in lengths", "A B <= 4 d1^2 s", "=m_far", "=m_near"],
    ),
    "n_ab, A = 0": (  # straight: B = 4 d1 d2
        "(=> (= a_far 0.0) (<= 1.0 (* 4.0 n_ab n_ab m_1 m_1 m_s)))",
        ["n_ab in lengths", "A + B", "=m_far", "=m_near", "=e_near", "=a_far", "=d_sum_sq", "=d_sum", "=ulp", *LENGTHS],
    ),
    "not nearer than folded": (  # A = 4 d1 d2; |d1 - d2| is one ulp, or at least two
        "(=> (= b_near 0.0) (<= (* ulp ulp) (* e_far e_far d1 d1 s)))",
        ["A + B", "=m_far", "=e_far", "=b_near", "=d_dif_sq", "=d_dif", "s > 0", "#d_dif", "e_far of d1",
        "=ulp", *LENGTHS],
    ),
    "n_ab, B = 0": (
        "(=> (= b_near 0.0) (<= 1.0 (* 4.0 n_ab n_ab m_1 m_1 m_s)))",
        ["n_ab in lengths", "not nearer than folded", "=m_near", "=ulp"],
    ),
    "law": (
        "(<= 1.0 (* 4.0 n_ab n_ab m_1 m_1 m_s))",
        ["n_ab, A B > 0", "n_ab, A = 0", "n_ab, B = 0", "a_far", "b_near"],
    ),
    "1/(d1 |p|) by n_ab": (
        "(= (* inv_law_ab_raw inv_law_ab_raw n_ab n_ab m_1 m_1 m_s) 1.0)",
        ["=inv_law_ab_raw", "=n_ab", "1/(d1 |p|)", "1/|p|"],
    ),
    "elbow w": (
        "(= (* 4.0 d1 d2 elbow_w elbow_w) a_far)",
        ["=elbow_w", "=inv_12_far", "=inv_12_far_raw", "=n_far", "root of m_far", "1/(d1 d2)", "=m_far", "=m_1", "=m_2",
         "=e_far", "=e_1", "=e_2", *LENGTHS],
    ),
    "elbow i": (
        "(= (* 4.0 d1 d2 elbow_i elbow_i) b_near)",
        ["=elbow_i", "=inv_12_near", "=inv_12_near_raw", "=n_near", "root of m_near", "1/(d1 d2)", "=m_near",
        "=m_1", "=m_2",
         "=e_near", "=e_1", "=e_2", *LENGTHS],
    ),
    # the whole arm
    "good hand": ("(not bad_hand)", []),  # by assumption, of the hand's products only
    "|Qh|": (f"(=> (not bad_hand) (<= qh_len {MOST_H}))", ["=qh_len", *HAND]),
    "|h|": (f"(and (<= 0.0 h_len) (<= h_len {MOST_H}))", ["=h_len", "=qh_len", "|Qh|", *_each("=h_")]),
    "|w_q|": (
        f"(<= {_norm('w_q', 'i_q', 'j_q', 'k_q')} 1.0)",
        ["=w_q", "=i_q", "=j_q", "=k_q", "=wi_1_len", "=kj_1_len", "q_1", "1/|q|", "length_sq"],
    ),
    "|Qs|": (f"(<= {_norm(*_each('qs_'))} 1.0)", ["|w_q|", *_each("=qs_")]),
    "|Qe|": (f"(= {_norm('qe_w', 'qe_i')} 1.0)", [
        "case", "=qe_w", "=qe_i", "elbow w", "elbow i", "A + B", *LENGTHS]),
    **{
        f"word {n}": (f"(<= (* {n}_w {n}_w) (+ (* {1 + 2 * e} {n} {n}) {e / 2 + e * e:.9f}))", [n, f"~{n}"])
        for q, e in WORST_ERROR.items()
        for n in (f"{q}_{c}" for c in ("wi" if q == "qe" else "wijk"))
    },
    "words of Qs": ("(and (<= 0.0 qs_len) (<= qs_len 1.017))", ["=qs_len", "|Qs|", *_each("word qs_")]),
    "words of Qe": ("(and (<= 0.0 qe_len) (<= qe_len 1.001))", ["=qe_len", "|Qe|", "word qe_w", "word qe_i"]),
    "|G| = |Qs| |h|": (
        "(= g_len (* qs_len h_len))",
        ["=g_len", "=qs_len", "=h_len", *_each("=g_"), *(f"=g_{a}{b}" for a in "wijk" for b in "wijk")],
    ),
    "|G|": ("(and (<= 0.0 g_len) (<= g_len 1.025))", ["|G| = |Qs| |h|", "words of Qs", "|h|"]),
    "|Qw| = |G| |Qe|": (
        "(= qw_len (* g_len qe_len))",
        ["=qw_len", "=g_len", "=qe_len", *_each("=qw_"), *(f"=f_{p}" for p in FRAME)],
    ),
    "|Qw|": ("(<= qw_len 1.0265)", ["|Qw| = |G| |Qe|", "|G|", "words of Qe"]),
    "words of Qw": (f"(<= {_norm(*_each('qw_', '_w'))} 1.028)", ["=qw_len", "|Qw|", *_each("word qw_")]),
}  # fmt: skip


def _inverse(name: str, value: str) -> dict[str, list[str]]:
    return {f"m_{name}": [f"=m_{name}", value], f"inv_{name}": [f"=inv_{name}", f"=m_{name}", value]}


ELBOW_W = [
    "=inv_12_far",
    "=inv_12_far_raw",
    "=n_far",
    "inv_12",
    "root_far",
    "root of m_far",
    "=m_far",
    "=e_far",
    "a_far",
]
ELBOW_I = [
    "=inv_12_near",
    "=inv_12_near_raw",
    "=n_near",
    "inv_12",
    "root_near",
    "root of m_near",
    "=m_near",
    "=e_near",
    "b_near",
]
SIN_A = ["=sin_a", "=root_ab", "root_far", "root_near", "=inv_law_ab", "=inv_law_ab_raw", "=n_ab", "inv_law"]

BY_WORDS = ("m_q",)
"""Nodes whose range depends on a decision taken on words: proved by :class:`tb.formal.lean_proofs.Rounded`."""

USES: dict[str, list[str]] = {
    "a_far": [*CASE, *LENGTHS, "=a_far", "d_sum_sq", "s"],
    "b_near": [*CASE, *LENGTHS, "=b_near", "s", "d_dif_sq"],
    "d_sum": ["=d_sum", *LENGTHS],
    "d_dif": ["=d_dif", *LENGTHS],
    "sum_dif": ["=sum_dif", "=d_sum", "=d_dif", *LENGTHS],
    "x_sq": ["=x_sq", "=x_w"],
    "y_sq": ["=y_sq", "=y_w"],
    "z_sq": ["=z_sq", "=z_w"],
    **_inverse("rho", "rho_sq"),
    **_inverse("s", "s"),
    **_inverse("far", "a_far"),
    **_inverse("near", "b_near"),
    **_inverse("1", "=d1"),
    **_inverse("2", "=d2"),
    "x_n": ["direction", "m_rho"],
    "y_n": ["direction", "m_rho"],
    "z_n": ["elevation", "m_s"],
    "u_x": ["|u| <= 1"],
    "u_y": ["|u| <= 1"],
    "sin_el": ["|el| = 1"],
    "cos_el": ["=cos_el", "root_rho", "inv_s_el", "|el| = 1"],
    "root_rho": ["=root_rho", "inv_rho", "root of m_rho", "m_rho"],
    "root_far": ["=root_far", "inv_far", "root of m_far", "m_far"],
    "root_near": ["=root_near", "inv_near", "root of m_near", "m_near"],
    "n_el": ["=n_el", "rho <= |p|", "s > 0", "rho_sq", *_mantissas("rho", "s")],
    "tilt_sq": [*CASE, "=tilt_sq", "sin_el"],
    "az_c": ["az", "az_sq"],
    "az_s": ["az", "az_sq"],
    "tilt_c": ["tilt", "tilt_sq"],
    "tilt_s": ["tilt", "tilt_sq"],
    "n_far": ["=n_far", "A <= 4 d1 d2", "a_far", *LENGTHS, *_mantissas("far", "1", "2")],
    "n_near": ["=n_near", "B <= 4 d1 d2", "b_near", *LENGTHS, *_mantissas("near", "1", "2")],
    "inv_12_far_raw": [
        "=inv_12_far_raw", "=n_far", "n_far", "inv_12", "=elbow_w", "=inv_12_far", "elbow_w", "root_far",
        "root of m_far",
        "a_far", *_mantissas("far", "1", "2"), *LENGTHS,
    ],
    "inv_12_near_raw": [
        "=inv_12_near_raw", "=n_near", "n_near", "inv_12", "=elbow_i", "=inv_12_near", "elbow_i", "root_near",
        "root of m_near", "b_near", *_mantissas("near", "1", "2"), *LENGTHS,
    ],
    "elbow_w": ["=elbow_w", "elbow w", "A <= 4 d1 d2", *ELBOW_W, *LENGTHS],
    "elbow_i": ["=elbow_i", "elbow i", "B <= 4 d1 d2", *ELBOW_I, *LENGTHS],
    "qe_w": ["case", "=qe_w", "elbow_w"],
    "qe_i": ["case", "=qe_i", "elbow_i"],
    "inv_law_raw": ["=inv_law_raw", "inv_11", "inv_s"],
    "k_scaled": ["cos_a", "=cos_a", "1/(d1 |p|)", "1/|p|", "m_1", "=m_1", "=d1", "m_s", "inv_s"],
    "cos_a": ["|a| = 1"],
    "n_ab": ["=n_ab", "law", "A + B", "a_far", "b_near", *_mantissas("far", "near", "1", "s"), "=ulp", *LENGTHS],
    "inv_law_ab_raw": ["=inv_law_ab_raw", "=n_ab", "inv_law", "1/(d1 |p|) by n_ab", "law"],
    "sin_a": ["|a| = 1", *SIN_A],
    "arm_sq": ["case", "=arm_sq", "cos_a"],
    "arm_c": ["arm", "arm_sq"],
    "arm_s": ["arm", "arm_sq"],
    "arm_dif": ["case", "=arm_dif", "arm_sq", "sin_a"],
    "arm_sum": ["case", "=arm_sum", "arm_sq", "sin_a"],
    "sin_h": ["phi"],
    "cos_h": ["phi", "=cos_h"],
    "c_plus": ["az + phi", "az_sq"],
    "s_plus": ["az + phi", "az_sq"],
    "c_minus": ["az - phi", "az_sq"],
    "s_minus": ["az - phi", "az_sq"],
    "wi_0": ["=wi_0", "q_0", "az_tilt_sq"],
    "kj_0": ["=kj_0", "q_0", "az_tilt_sq"],
    **{f"{part}_1": ["q_1", "=wi_1_len", "=kj_1_len", "length_sq"] for part in "wijk"},
    "inv_q": ["1/|q|", "length_sq", "=inv_q"],
    **{f"{part}_q": [f"={part}_q", "q_1", "=wi_1_len", "=kj_1_len", "1/|q|", "length_sq"] for part in "wijk"},
    **{f"h{c}_sq": [f"=h{c}_sq", "=qh_len", "good hand", "|Qh|"] for c in "wijk"},
    **{n: ["=qh_len", "good hand", "|Qh|", *HAND] for n in ("hij_sq", "hijk_sq", "hand_sq")},
    **{f"h_{p}": [f"=h_{p}", "=qh_len", "good hand", "|Qh|"] for p in ("ik", "wj", "jk", "wi", "ii", "jj")},
    **{
        f"r_{axis}": [f"=r_{axis}", f"=h_{p}", f"=h_{q}", "=qh_len", "good hand", "|Qh|"]
        for axis, p, q in (("x", "ik", "wj"), ("y", "jk", "wi"), ("z", "ii", "jj"))
    },
    **{f"h_{c}": ["=h_len", "|h|"] for c in "wijk"},
    "tool_h": ["=tool_h", "=tool"],
    **{f"g_{a}{b}": [f"=g_{a}{b}", "=qs_len", "=h_len", "words of Qs", "|h|"] for a in "wijk" for b in "wijk"},
    **{f"g_{c}": ["=g_len", "|G|"] for c in "wijk"},
    **{f"f_{p}": [f"=f_{p}", "=g_len", "=qe_len", "|G|", "words of Qe"] for p in FRAME},
    **{f"qw_{c}": ["=qw_len", "|Qw|"] for c in "wijk"},
    **{f"qs_{pair}": [f"=qs_{pair}", "=qs_len", "words of Qs"] for pair in ("ij", "wk")},
    **{f"qw_{pair}": [f"=qw_{pair}", "words of Qw"] for pair in ("ij", "wk")},
}  # fmt: skip

CLAMPED = {
    "arm": ["case", "=arm_c", "=arm_s", "=arm_sq"],
    "arm_sq": ["case", "=arm_sq"],
    "arm_dif": ["case", "=arm_dif", "=arm_sq"],
    "arm_sum": ["case", "=arm_sum", "=arm_sq"],
    "qe_w": ["case", "=qe_w"],
    "qe_i": ["case", "=qe_i"],
    "|Qe|": ["case", "=qe_w", "=qe_i"],
}
ON_SHOULDER = ["case", *(f"={n}_sq" for n in "xyz"), "=rho_sq", "=s", "=m_rho", "=m_s", "=at_shoulder"]
CASES: dict[str, tuple[str, dict[str, list[str]]]] = {
    # case of the target -> (assumption, overrides of USES and GEOMETRY)
    "reachable": ("(not clamp)", {}),
    "clamped": ("(and clamp (not at_shoulder))", CLAMPED),
    "at the shoulder": (
        "(and clamp at_shoulder)",
        CLAMPED
        | {
            "tilt": [*ON_SHOULDER, "=tilt_c", "=tilt_s", "=tilt_sq", "=cos_el", "=root_rho"],
            "tilt_sq": ["case", "=tilt_sq"],
            "sin_el": [*ON_SHOULDER, "=sin_el", "=z_n"],
            "cos_el": [*ON_SHOULDER, "=cos_el", "=root_rho"],
            "n_el": [*ON_SHOULDER, "=n_el", "=e_rho", "=e_s"],
        },
    ),
}
"""Qs and Qe are outputs for clamped targets too; the triangle's other words are then unused."""
