# SPDX-License-Identifier: Apache-2.0
"""All proofs, in the order of docs/generated/proofs.md."""

from collections.abc import Callable, Iterable
from functools import partial

from tb.formal import arithmetic, induction, lean_proofs
from tb.formal.arithmetic import Question
from tb.formal.bugs import BUGS
from tb.formal.floors import DIV, ROOT_DIGIT, floors
from tb.formal.lean_proofs import Rounded, Rules
from tb.formal.proofs import PROOFS
from tb.formal.rsqrt_stages import QUADRATIC, RSQRT, TABLE, stages
from tb.formal.task import Task, digest_of
from tb.sim.env import ROOT
from tb.sim.sources import code

FLOORS = (DIV, ROOT_DIGIT, "tb/formal/floors.py", "tb/formal/smt.py")
STAGES = (RSQRT, QUADRATIC, TABLE, "rtl/lib/ik_delay.v", "model/dataflow/quadratic.py")


def _files(names: Iterable[str]) -> str:
    return digest_of(*(code(ROOT / name) for name in names))


Questions = Callable[[], Iterable[Question]]


def _numbers(name: str, what: str, digest: Callable[[], str], questions: Questions, wrong: Questions) -> Task:
    return Task(name, what, "z3", digest, lambda pool, say: arithmetic.run(questions(), wrong(), pool, say))


def _seeded(name: str, questions: Callable) -> Questions:
    bug = BUGS[name]
    return lambda: (question for question in questions(bug) if question.name == bug.fails)


TASKS = (
    *(Task(p.name, p.claim, p.engine, partial(induction.digest, p), partial(induction.run, p)) for p in PROOFS),
    _numbers("rules", "exact ranges of the whole arm's dataflow, W = 16 to 32", partial(lean_proofs.digest, Rules),
             partial(lean_proofs.questions, Rules), partial(lean_proofs.too_narrow, Rules)),
    _numbers("errors", "errors of the whole arm's words, W = 16 to 32", partial(lean_proofs.digest, Rounded),
             partial(lean_proofs.questions, Rounded), partial(lean_proofs.too_narrow, Rounded)),
    _numbers("floors", "from rows to the floor, divider and root, all widths", partial(_files, FLOORS),
             floors, _seeded("floors", floors)),
    _numbers("rsqrt", "`ik_rsqrt` equals its model, W = 16 to 32", partial(_files, STAGES),
             stages, _seeded("rsqrt", stages)),
)  # fmt: skip
