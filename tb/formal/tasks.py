# SPDX-License-Identifier: Apache-2.0
"""All proofs, in the order of docs/generated/proofs.md."""

from collections.abc import Callable, Iterable
from functools import partial

from tb.formal import arithmetic, induction, lean_proofs
from tb.formal.arithmetic import Question
from tb.formal.bugs import BUGS
from tb.formal.floors import DIV, ROOT_DIGIT, floors
from tb.formal.lean_proofs import Questions, Rounded, Rules
from tb.formal.proofs import PROOFS
from tb.formal.rsqrt_stages import QUADRATIC, RSQRT, TABLE, stages
from tb.formal.task import Task, digest_of
from tb.sim.env import ROOT
from tb.sim.sources import code

FLOORS = (DIV, ROOT_DIGIT, "tb/formal/floors.py", "tb/formal/smt.py")
STAGES = (RSQRT, QUADRATIC, TABLE, "rtl/lib/ik_delay.v", "model/dataflow/quadratic.py")

Asked = Callable[[], Iterable[Question]]


def _numbers(name: str, what: str, digest: Callable[[], str], questions: Asked, wrong: Asked) -> Task:
    return Task(name, what, "z3", digest, lambda pool, say: arithmetic.run(questions(), wrong(), pool, say))


def _ranges(name: str, what: str, kind: type[Questions]) -> Task:
    parts = (partial(part, kind) for part in (lean_proofs.digest, lean_proofs.questions, lean_proofs.too_narrow))
    return _numbers(name, f"{what}, W = 16 to 32", *parts)


def _seeded(name: str, what: str, files: Iterable[str], questions: Callable) -> Task:
    def wrong() -> Iterable[Question]:
        return (question for question in questions(BUGS[name]) if question.name == BUGS[name].fails)

    return _numbers(name, what, lambda: digest_of(*(code(ROOT / file) for file in files)), questions, wrong)


TASKS = (
    *(Task(p.name, p.claim, p.engine, partial(induction.digest, p), partial(induction.run, p)) for p in PROOFS),
    _ranges("rules", "exact ranges of the whole arm's dataflow", Rules),
    _ranges("errors", "errors of the whole arm's words", Rounded),
    _seeded("floors", "from rows to the floor, divider and root, all widths", FLOORS, floors),
    _seeded("rsqrt", "`ik_rsqrt` equals its model, W = 16 to 32", STAGES, stages),
)
