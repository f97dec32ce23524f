# SPDX-License-Identifier: Apache-2.0
"""All proofs. A proof about RTL has modules, parameters and dependencies; a proof about numbers has questions."""

from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from functools import partial

from model.dataflow.datapaths import MODELS, PAPER
from tb.formal import accuracy, induction, lean_proofs, task
from tb.formal.bugs import BUGS
from tb.formal.floors import DIV, ROOT_DIGIT, floors
from tb.formal.induction import Proof
from tb.formal.lean_proofs import Questions, Rounded, Rules
from tb.formal.rsqrt_stages import QUADRATIC, RSQRT, TABLE, stages
from tb.formal.task import Task, digest_of
from tb.sim.env import ROOT
from tb.sim.sources import code

WORDS = "IK_IN=6 IK_OUT=6 IK_FLAGS=8"
CORE = {
    "lean": f"IK_CORE=ik_lean IK_LEAN=1 IK_IS_LEAN {WORDS}",
    "paper": f"IK_CORE=ik_paper IK_LEAN=0 {WORDS}",
    "arm": "IK_CORE=ik_lean_arm IK_ARM IK_IS_LEAN IK_IN=11 IK_OUT=17 IK_FLAGS=16",
}
"""Datapath -> Verilog macros for ik_core.v, which replaces the datapath."""

STORE = "rows_mark$ last_row count_written count_left memory_fits place_for_every_write tag_kept mark_or_stored "
STORE += "stored_was_taken done_was_taken done_was_stored somewhere"
AXIS_USES = {
    "within_places": "within_places counted credits_are_free_places nothing_invented count_written count_left "
    "memory_fits flight last_row rows_bound$ fifo_part fifo_fits place_for_every_write",
    "counted": "counted credits_are_free_places nothing_invented",
    "somewhere": "somewhere rows_mark$ last_row count_written count_left memory_fits ahead ahead_inside "
    "stored_was_taken done_was_stored place_for_every_write fifo_fits",
    "rows_bound": "rows_bound",
    "rows_counts": "rows_counts",
    "rows_below": "rows_below rows_bound",
    "rows_mark": "rows_mark",
    "rows_alone": "rows_alone rows_mark",
    "kept_in_memory": f"kept_in_memory {STORE}",
    "kept_in_register": f"kept_in_memory kept_in_register {STORE}",
}
AXIS_AFTER = {
    "rows_above_if": "rows_counts last_row",
    "rows_above": "rows_above_if*",
    "rows_waiting": "rows_above rows_mark",
    "not_yet_stored": "rows_waiting mark_or_stored",
    "in_order": "kept_in_register not_yet_stored somewhere ahead count_left fifo_fits ahead_inside memory_fits "
    "count_written",
}

# A row needs only a few properties of the row before it.
ROW = "in_range_ identity_ to_come_ result_"
FIRST = f"{ROW} first_flags first_divisor first_remainder first_word first_copies"

WHOLE_AFTER = {
    "f_got_some": "got_is read_before position counts_are areas_are quiet to_write_is place_for_every_record counted "
    "offered some_in_each core_is together",
    "f_answer": "bus_is offered_waits together",
    "read_inside": "inside_source within_4k whole_records quiet bases_are counts_are areas_are together",
    "written_inside": "inside_destination within_4k whole_records quiet bases_are counts_are areas_are together",
}
CONTROL = "ik_fold_fetch ik_fold_lap"
ENGINES = "ik_axi_job ik_axi_read ik_axi_records ik_axi_regs ik_axi_result ik_axi_target ik_axi_write"


def axis(name: str, width: int, depth: int = 0) -> Proof:
    """Return the proof of a core's top with its real FIFO and an arbitrary datapath that has the real latency."""
    path = MODELS.get(name, PAPER)
    sets = {"W": width, "DATAPATH": path.number}
    properties = {path.top: "ik_axis", "ik_fifo": "ik_fifo_port"}
    rest = {"depth": depth, "uses": AXIS_USES, "after": AXIS_AFTER}
    return Proof(f"axis_{name}", path.top, sets, "ik_core ik_credit_fifo ik_fifo", properties, CORE[path.name], **rest)


def handshake(datapath: str) -> Proof:
    """Return the proof that no gates lead from s_axis_tvalid or m_axis_tready to s_axis_tready or m_axis_tvalid."""
    gates = ("i:m_axis_tready i:s_axis_tvalid", "o:m_axis_tvalid o:s_axis_tready", 2, 2)
    core, path = "ik_core" if datapath in CORE else f"ik_{datapath} {CONTROL}", MODELS[datapath]
    others = f"{core} ik_credit_fifo ik_fifo"
    rest = {"defines": CORE.get(datapath, ""), "part": datapath not in CORE, "gates": gates}
    return Proof(f"handshake_{datapath}", path.top, {"W": 32, "DATAPATH": path.number}, others, **rest)


def valid(datapath: str) -> Proof:
    """Return the proof of valid's latency in the real datapath and, except in the arm, of the tag's latency."""
    top, others = ("ik_lean_arm", "ik_lean") if datapath == "arm" else (f"ik_{datapath}", "ik_delay")
    return Proof(f"valid_{datapath}", top, {}, others, {top: "ik_valid"}, CORE[datapath], part=True)


def rows(kind: str, width: int, shift: int, rest: dict[str, int], depth: int, uses: str) -> Proof:
    """Return the proof of a divider or root of the paper's datapath, row by row."""
    sets, others = {"NW": width, "SH": shift, "QW": 32, **rest}, f"ik_checks ik_delay ik_{kind}_row"
    needs = dict.fromkeys(ROW.split(), uses)
    return Proof(f"{kind}_{width}_{shift}", f"ik_{kind}_digit", sets, others, depth=depth, uses=needs)


def engine(name: str, others: str = "", size: int = 5) -> Proof:
    sets, depth = {"DATA_W": 64} | ({"LOG2_RECORD": size} if size > 5 else {}), 32 if size > 5 else 20
    return Proof(f"axi_{name}_{'arm' if size > 5 else 64}", f"ik_axi_{name}", sets, others, depth=depth)


def whole(name: str, sets: dict[str, int], others: str, defines: str = "") -> Proof:
    """Return the proof of what the engines of ``ik_axi`` assume about each other; ik_stream.v replaces the core."""
    properties = {f"ik_axi{engine}": f"ik_axi{engine}" for engine in ("", "_job", "_read", "_write")}
    claims = "chformal -assume2assert t:$assume c:u_read.f_data %d c:f_answered %d c:f_length %d"
    return Proof(f"axi_whole_{name}", "ik_axi", {"DATA_W": 64} | sets, f"{others} {ENGINES}", properties, defines,
                 depth=40, script=("chformal -lower", "chformal -cover -remove t:$cover c:job_done %d"),
                 claims=(claims, "select -assert-count 3 t:$assume"), after=WHOLE_AFTER)  # fmt: skip


def gates(name: str, sets: dict[str, int], others: str, defines: str = "") -> Proof:
    """Return the proof that no combinational path leads from a bus input of ``ik_axi`` to an output. ``rst`` is left
    out: it drives ready of the register port."""
    gates = ("i:s_axi_* i:m_axi_*", "o:*", 22, 31)
    rest = {"defines": defines, "part": not defines, "gates": gates}
    return Proof(f"axi_gates_{name}", "ik_axi", {"DATA_W": 64} | sets, f"{others} {ENGINES}", **rest)


PROOFS = (
    *(Proof(f"fifo_{1 << log2}", "ik_fifo", {"W": 208, "LOG2": log2}, depth=n) for log2, n in ((6, 148), (9, 0))),
    axis("lean", 32, depth=84),
    handshake("lean"),
    valid("lean"),
    axis("paper", 32),
    handshake("paper"),
    valid("paper"),
    axis("256", 22),  # the largest word length for which the paper's datapath has 256 FIFO slots
    Proof("div_row_31", "ik_div_row", {"W": 31}, depth=1),
    *(Proof(f"root_row_{k}", "ik_root_row", {"K": k}, depth=1) for k in (15, 30)),
    *(rows("div", *kind, {"LAT": 34, "DW": 32}, 46, FIRST) for kind in ((32, 29), (32, 30), (40, 22), (40, 23))),
    *(rows("root", *kind, {"LAT": 32}, 44, ROW) for kind in ((32, 30), (32, 31), (33, 29))),
    # the program is the same at all word lengths
    Proof("fold_24", "ik_fold", {"W": 24}, f"{CONTROL} ik_fold_results", part=True, depth=220),
    handshake("fold"),
    axis("arm", 32),
    handshake("arm"),
    valid("arm"),
    Proof("fold_arm_24", "ik_fold_arm", {"W": 24}, f"{CONTROL} ik_fold_arm_results",
          properties={"ik_fold_arm": "ik_fold"}, defines="IK_ARM", part=True, depth=480),
    handshake("fold_arm"),
    Proof("choose", "ik_choose", {"W": 16}, "ik_delay", part=True),
    engine("read", "ik_bursts"),
    engine("write", "ik_bursts"),
    engine("result"),
    engine("regs"),
    engine("job"),
    *(engine(name, "ik_bursts", 6) for name in ("read", "write")),
    *(engine(name, size=6) for name in ("result", "job")),
    whole("64", {}, "ik_bursts ik_stream"),
    whole("fold", {"DATAPATH": 2}, "ik_bursts ik_stream ik_fifo", "IK_FOLD"),
    gates("64", {}, "ik_core ik_credit_fifo ik_fifo ik_axis", CORE["lean"]),
    gates("fold", {"DATAPATH": 2}, f"ik_fold {CONTROL} ik_fold_results ik_fifo ik_axis"),
)  # fmt: skip
"""All proofs by induction and about gates; a test compares the parameters with the model and the RTL."""

FLOORS = (DIV, ROOT_DIGIT, "tb/formal/floors.py", "tb/formal/smt.py")
STAGES = (RSQRT, QUADRATIC, TABLE, "rtl/lib/ik_delay.v", "model/dataflow/quadratic.py")


def _ranges(name: str, what: str, kind: type[Questions]) -> Task:
    def run(pool: Executor, say: task.Say) -> task.Outcome:
        return task.run(lean_proofs.questions(kind), lean_proofs.too_narrow(kind), pool, say)

    return Task(name, f"{what}, W = 16 to 32", "z3", partial(lean_proofs.digest, kind), run)


def _seeded(name: str, what: str, files: Iterable[str], questions: Callable) -> Task:
    def run(pool: Executor, say: task.Say) -> task.Outcome:
        bug = BUGS[name]
        return task.run(questions(), (asked for asked in questions(bug) if asked.name == bug.fails), pool, say)

    return Task(name, what, "z3", lambda: digest_of(*(code(ROOT / file) for file in files)), run)


def _accuracy(pool: Executor, say: task.Say) -> task.Outcome:
    return task.run(accuracy.questions(), [accuracy.algebra(*accuracy.FALSE)], pool, say)


TASKS = (
    *(Task(p.name, p.claim, p.engine, partial(induction.digest, p), partial(induction.run, p)) for p in PROOFS),
    _ranges("rules", "exact ranges of the whole arm's dataflow", Rules),
    _ranges("errors", "errors of the whole arm's words", Rounded),
    Task("accuracy", "errors of lean and of the whole arm: [accuracy](accuracy.md)", "z3", accuracy.digest, _accuracy),
    _seeded("floors", "from rows to the floor, divider and root, all widths", FLOORS, floors),
    _seeded("rsqrt", "`ik_rsqrt` equals its model, W = 16 to 32", STAGES, stages),
)
"""All proofs, in the order of docs/generated/proofs.md."""
