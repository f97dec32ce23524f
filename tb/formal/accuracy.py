# SPDX-License-Identifier: Apache-2.0
"""Proof of the accuracy of lean and of the whole arm; docs/generated/accuracy.md states its steps.

z3 proves that the dataflow, in exact arithmetic, is the product of rotations that the page describes (:data:`NODES`,
with lemmas of the dataflow). z3 also proves the algebra of the page's steps (:data:`ALGEBRA`).
:mod:`model.bounds.accuracy` computes the constants; the last questions compare them with their stated limits.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial

from model.bounds.accuracy import STATED, accuracy
from model.bounds.ranges import LeanRanges
from model.dataflow.fixed import dataflow
from model.dataflow.formats import WIDTHS
from tb.formal import lean_proofs
from tb.formal.lean_proofs import LIMIT, REACHABLE, SOLVER, Exact, Rules
from tb.formal.smt import formula, smt
from tb.formal.task import Question, digest_of
from tb.formal.tools import Answer, ask
from tb.sim.env import ROOT
from tb.sim.sources import code

FILES = (
    *(f"model/{name}.py" for name in ("bounds/accuracy", "dataflow/angles", "dataflow/mul3", "dataflow/quadratic")),
    "tb/formal/accuracy.py",
)

# ---- the dataflow in exact arithmetic --------------------------------------------------------------------------------

Lemma = tuple[str, tuple[str, ...]]


def equations(names: str) -> tuple[str, ...]:
    """Return the facts that state the equations of nodes. ``names``: the nodes, separated by spaces."""
    return tuple(f"={name}" for name in names.split())


def pair(name: str, cosine: str, sine: str, small: str, large: str, *facts: str) -> Lemma:
    """Return the lemma on a half angle's parts c and s. The sign of ``cosine``'s word decides which one is large."""
    parts = (f"({name}_{one} == {name}_sq and 2*{name}_{two} == {sine})" for one, two in (small + large, large + small))
    choice = " if {} else ".join(parts).format(f"neg_{cosine}")
    size = f"2*{name}_sq == 1 + (-{cosine} if {cosine} < 0 else {cosine})"
    return f"{size} and ({choice})", (*facts, *equations(f"{name}_c {name}_s {name}_sq"))


SQUARES = equations("k_law sum_dif a_far b_near d_sum_sq d_dif_sq d_sum d_dif d1 d2")
HALVES = equations("w_0 i_0 j_0 k_0 c_plus c_minus s_plus s_minus cc ss sc cs")
G = "=qs_len", *equations(" ".join(f"g_{a} " + " ".join(f"g_{a}{b}" for b in "wijk") for a in "wijk"))
QW = "=qe_len", *equations("qw_w qw_i qw_j qw_k f_ww f_wi f_iw f_ii f_jj f_jk f_kk f_kj")

NODES: dict[str, Lemma] = {
    "R": ("R*R == rho_sq and 0 <= R", ()),
    "P": ("P*P == s and 0 < P", ()),
    "1/R": ("implies(0 < R, inv_rho*e_rho*R == 2)", ("R", *equations("inv_rho m_rho e_rho"))),
    "1/P": ("inv_s*e_s*P == 2", ("P", *equations("inv_s m_s e_s"))),
    "root R": ("4*root_rho == R*e_rho", ("R", *equations("root_rho inv_rho m_rho e_rho"))),
    "x/R": ("implies(0 < R, u_x*R == x_w)", ("1/R", *equations("u_x x_n"))),
    "y/R": ("implies(0 < R, u_y*R == y_w)", ("1/R", *equations("u_y y_n"))),
    "z/P": ("sin_el*P == z_w", ("1/P", *equations("sin_el z_n"))),
    "R/P": ("cos_el*P == R", ("root R", "1/P", *equations("cos_el inv_s_el n_el e_rho"))),
    "K/P": ("2*d1*P*cos_a == k_law", ("1/P", "1/(d1 |p|)", *equations("cos_a k_scaled n_law m_1 d1 e_1"))),
    "Qe along": ("2*d1*(d1 + d2*(elbow_i*elbow_i - elbow_w*elbow_w)) == k_law", ("elbow w", "elbow i", *SQUARES)),
    "Qe across": ("16*d1*d1*d2*d2*elbow_w*elbow_w*elbow_i*elbow_i == a_far*b_near", ("elbow w", "elbow i")),
    "|elbow|": ("elbow_w*elbow_w + elbow_i*elbow_i == 1", ("elbow w", "elbow i", "A + B", *equations("d1 d2"))),
    "qe": ("qe_w == elbow_w and qe_i == -elbow_i", ("case", *equations("qe_w qe_i"))),
    "not on_axis": ("not on_axis", ()),
    "off the shoulder": ("not at_shoulder", ()),
    "pair az": pair("az", "u_y", "u_x", "c", "s", "not on_axis", "=u_y"),
    "pair tilt": pair("tilt", "sin_el", "cos_el", "s", "c", "off the shoulder"),
    "pair bend": pair("bend", "cos_a", "sin_a", "s", "c", "case"),
    "four products": (
        "w_0 == tilt_c*(az_c*cos_h - az_s*sin_h) and i_0 == tilt_s*(az_c*cos_h + az_s*sin_h)"
        " and j_0 == tilt_s*(az_s*cos_h - az_c*sin_h) and k_0 == tilt_c*(az_s*cos_h + az_c*sin_h)",
        HALVES,
    ),
    "lengths": ("length_sq == az_sq*tilt_sq*bend_sq", equations("length_sq az_tilt_sq")),
    "target is clamped": ("clamp", ()),
    "clamped": (
        "bend_sq == 1 and ((bend_swap and bend_c == 0 and bend_s == 1) if away else"
        " (not bend_swap and bend_c == 1 and bend_s == 0))"
        " and ((qe_w == 1 and qe_i == 0) if closed else (qe_w == 0 and qe_i == -1))",
        ("target is clamped", *equations("bend_sq bend_c bend_s bend_swap qe_w qe_i")),
    ),
    "Qs G, w": ("qs_w_w*g_w - qs_i_w*g_i - qs_j_w*g_j - qs_k_w*g_k == qs_len*h_w", G),
    "Qs G, i": ("qs_w_w*g_i + qs_i_w*g_w + qs_j_w*g_k - qs_k_w*g_j == qs_len*h_i", G),
    "Qs G, j": ("qs_w_w*g_j + qs_j_w*g_w + qs_k_w*g_i - qs_i_w*g_k == qs_len*h_j", G),
    "Qs G, k": ("qs_w_w*g_k + qs_k_w*g_w + qs_i_w*g_j - qs_j_w*g_i == qs_len*h_k", G),
    "e Qw, w": ("-qe_i_w*qw_w - qe_w_w*qw_i == qe_len*g_w", QW),
    "e Qw, i": ("-qe_i_w*qw_i + qe_w_w*qw_w == qe_len*g_i", QW),
    "e Qw, j": ("-qe_i_w*qw_j - qe_w_w*qw_k == qe_len*g_j", QW),
    "e Qw, k": ("-qe_i_w*qw_k + qe_w_w*qw_j == qe_len*g_k", QW),
    "tool, x": ("off_x == tool_h*(qh_i*qh_k + qh_w*qh_j)", equations("off_x r_x h_ik h_wj")),
    "tool, y": ("off_y == tool_h*(qh_j*qh_k - qh_w*qh_i)", equations("off_y r_y h_jk h_wi")),
    "tool, z": ("off_z == tool_h*(0.5 - qh_i*qh_i - qh_j*qh_j)", equations("off_z r_z h_ii h_jj")),
} | {
    f"Qs {unit}": (
        f"qs_{unit} == (-2 if minus else 2)*{unit}_1*inv_q",
        (*equations(f"qs_{unit} {unit}_q"), f"{unit} turned", "1/|q|"),
    )
    for unit in "wijk"
}
"""Lemma -> statement about exact values of nodes, and the facts that prove it (:mod:`model.dataflow.lean`).  A lemma
without facts is an assumption.  R is rho, P is |p|; a count e stands for 2^e, n_w for the word of node n, and neg_n for
the sign of this word."""

GIVEN = ("sin a", "1/|q|")
"""Lemmas of the dataflow that the page uses, besides those on which :data:`NODES` rest."""


class Steps(Rules):
    """Questions about :data:`NODES` and the lemmas on which they rest, at one word length."""

    cases = (REACHABLE,)

    def __init__(self, exact: Exact, case: str) -> None:
        exact.lemmas |= {name: (smt(text), uses) for name, (text, uses) in NODES.items()}
        super().__init__(exact, case)

    def _proved(self) -> list[str]:
        left, needed = [*NODES, *GIVEN], dict[str, bool]()
        while left:
            name = left.pop()
            if name not in needed and self.exact.lemmas.get(name, ("", ()))[1]:
                needed[name] = True
                left += self.uses(name)
        return list(needed)


# ---- algebra ---------------------------------------------------------------------------------------------------------

HALF = ("0 < L0", "0 < L", "L0*(1 + g*g) == 1", "s0 == g*L0", "L == L0 + l", "s == s0 + t")
SIDES = ("C*(1 + g*g) == 1 - g*g", "S*(1 + g*g) == 2*g")
UNIT = ("x*x + y*y + z*z == 1", "u*u + v*v + w*w == 1")

ALGEBRA: dict[str, tuple[Sequence[str], str]] = {
    "half angle": ((*HALF, *SIDES), "2*L0 == 1 + C and 2*s0 == S and L0*L0 + s0*s0 == L0 and L0*L0 - s0*s0 == L0*C"),
    "stretch": (HALF, "L*L + s*s == L*(1 + (1 - g*g)*l + 2*g*t) + (t - g*l)*(t - g*l)"),
    "quotient": (HALF, "L*L0 + s*s0 == L0*(1 + l + g*t) and s*L0 - L*s0 == L0*(t - g*l)"),
    "errors": (
        (*SIDES, "2*l == C*r + c", "2*t == S*((1 + r)*(1 + o) - 1) + e"),
        "(1 - g*g)*l + 2*g*t == 0.5*r*(1 + g*g) + 0.5*c*(1 - g*g) + (1 + r)*o*S*g + e*g"
        " and 2*(t - g*l) == (r - c)*g + (1 + r)*o*S + e",
    ),
    "wrong sign": ((SIDES[0], "-f <= C", "f < 1", "0 <= f"), "g*g*(1 - f) <= 1 + f"),
    "truncated": (("y*y == 1 - v", "0 <= y", "0 <= v", "v <= 1"), "1 - 0.5*v - 0.5*v*v <= y and y <= 1"),
    "scaled": (
        UNIT,
        "(m*u - x)**2 + (m*v - y)**2 + (m*w - z)**2 == (m - 1)**2 + m*((u - x)**2 + (v - y)**2 + (w - z)**2)",
    ),
    "two angles": (("c*c + s*s == 1",), "(q*c - p)**2 + (q*s)**2 == (q - p)**2 + p*q*((c - 1)**2 + s*s)"),
    "Qe": (("c*c + s*s == 1", "-m <= a", "a <= m", "-m <= b", "b <= m"), "(c*a)**2 + (s*b)**2 <= m*m"),
    "unequal": (("0 < m",), "4*m*t*t <= (1 + m*t*t)*(1 + m*t*t)"),
    "column": (("w*w + i*i + j*j + k*k == n",), "1 - 2*i*i - 2*j*j == w*w - i*i - j*j + k*k + 1 - n"),
    "step 1": (
        ("a*a + b*b <= m", "c*c + d*d <= m"),
        "(p*a)**2 + (q*c)**2 + (q*d)**2 + (p*b)**2 <= (p*p + q*q)*m",
    ),
}
"""Step -> facts, and the claim that follows for real numbers."""

FALSE = ("stretch", HALF, "L*L + s*s == L*(1 + (1 - g*g)*l + 2*g*t)")
"""False claim (seeded bug): "stretch" without its second-order term."""


def algebra(name: str, facts: Sequence[str], claim: str) -> Question:
    goals = (formula([smt(fact) for fact in facts], goal, lambda name: "Real") for goal in (smt(claim), "false"))
    return Question(name, claim, *(partial(ask, question, SOLVER, LIMIT) for question in goals))


# ---- the constants ---------------------------------------------------------------------------------------------------


def stated(width: int, datapath: str) -> dict[str, Fraction]:
    """Return constant -> its stated limit."""
    return {name: limits[width] for (path, name), limits in STATED.items() if path == datapath}


def holds(width: int, datapath: str) -> Answer:
    """Return "unsat" if every word of the datapath fits its format and no constant exceeds its stated limit; otherwise
    "sat" or the error."""
    try:
        fits, constants = not LeanRanges(width, datapath).failed, accuracy(width, datapath)
    except (TypeError, ValueError, ZeroDivisionError) as error:  # the dataflow is not of the form that is bounded
        return Answer(str(error), 0.0)
    small = all(constants[name] <= limit for name, limit in stated(width, datapath).items())
    return Answer("unsat" if fits and small else "sat", 0.0)


def questions(widths: Sequence[int] = WIDTHS) -> Iterator[Question]:
    """Yield all questions; yield a question only once if word lengths share it."""
    yield from lean_proofs.questions(Steps, widths)
    yield from (algebra(name, *step) for name, step in ALGEBRA.items())
    for datapath, width in sorted({(path, w) for (path, _), limits in STATED.items() for w in limits if w in widths}):
        says = ", ".join(f"{name} <= {float(limit)}" for name, limit in stated(width, datapath).items())
        yield Question(f"{datapath}, W={width}", says, partial(holds, width, datapath))


def digest() -> str:
    """Return a digest of the questions, and of the code and the nodes' attributes that the constants depend on."""
    texts = [lean_proofs.digest(Steps), *(code(ROOT / file) for file in FILES)]
    for (datapath, _), limits in STATED.items():
        for width in limits:
            nodes = dataflow(datapath, width).nodes.values()
            texts += [f"{node.right_side} {node.format} {node.error}" for node in nodes]
    return digest_of(*texts)
