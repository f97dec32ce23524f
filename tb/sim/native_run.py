# SPDX-License-Identifier: Apache-2.0
"""Native simulation of a core without Python in the loop: ``native_run.cpp`` compares every node of every target.

:func:`wrapper` generates Verilog that connects all named nodes of a datapath to one port; :func:`program` builds a
program from this Verilog. :func:`compare` streams targets and the bit-true model's words through the program.
"""

import contextlib
import hashlib
import re
import shlex
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from subprocess import PIPE, Popen

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import WIDTHS
from model.dataflow.nodes import Limits, Node
from tb.sim import coverage
from tb.sim.env import CORES, ROOT, cores, environment
from tb.sim.job import Difference, Run, SimulationError, answer, limits_port, report, usual_limits
from tb.sim.runner import COMPACT, alone, runtime
from tb.sim.sources import includes, sources
from tb.sim.subprocesses import compiled, full

TOP = "ik_native_run"

FRAME = 5000
"""Number of targets per model call. Arrays then fit the caches, and columns avoid cache-line conflicts."""


def nodes_of(datapath: str, width: int) -> list[Node]:
    """Return the named nodes of a datapath, in dataflow order."""
    return list(fixed.nodes(datapath, width).values())


def wrapper(datapath: str, width: int, digit: int, bounds: Limits | None = None) -> str:
    """Return the Verilog of a top around the core, or around the datapath alone for W < 16.

    Each word of a target or result has a 32-bit lane. For the whole arm, the lane above the target's words holds the
    branch, and the joints' limits ``bounds`` are constants. The port ``nodes`` holds every node, aligned to 32 bits."""
    path = MODELS[datapath]
    core = f"u_axis.g_{path.rtl}.u_core" if width in WIDTHS else "u_core"
    parameters = {**path.parameters, **({"DIGIT": 1} if digit else {})}
    chosen = ", ".join(f".{key}({value})" for key, value in parameters.items())
    parts, words = [], 0
    for node in nodes_of(datapath, width):
        bits = node.format.width
        pad = -bits % 32
        signal = ".".join(part for part in (core, path.instance(node), node.name) if part)
        parts.append(f"{{{pad}'d0, {signal}}}" if pad else signal)
        words += (bits + pad) // 32
    lanes, of_answer = range(len(path.inputs)), range(len(path.results))
    pad = f"{32 - width}'d0, " if width < 32 else ""
    asked = ", ".join(f"target[{32 * k + width - 1}:{32 * k}]" for k in reversed(lanes))
    side, limits = "", ""
    if path.side:
        side = f"target[{32 * len(lanes) + len(path.side) - 1}:{32 * len(lanes)}], "
        ends = limits_port(bounds or usual_limits(datapath, width), width)
        limits = f" .limits({14 * width}'h{ends:x}),"
    results = ", ".join(f"{pad}answer[{(k + 1) * width - 1}:{k * width}]" for k in reversed(of_answer))
    lines = ",\n      ".join(reversed(parts))
    if width in WIDTHS:
        instance = f"""\
  {path.top} #(
      .W({width}), .TAG_W(8), {chosen}
  ) u_axis (
      .clk(clk), .rst(rst),{limits}
      .s_axis_tdata({{{asked}}}), .s_axis_tuser({{{side}tag}}), .s_axis_tvalid(in_valid), .s_axis_tready(in_ready),
      .m_axis_tdata(answer), .m_axis_tuser({{out_flags, out_tag}}), .m_axis_tvalid(out_valid), .m_axis_tready(1'b1)
  );"""
    else:  # ik_axis does not support shorter words
        instance = f"""\
  ik_{path.rtl} #(
      .W({width}), .TAG_W(8)
  ) u_core (
      .clk(clk), .rst(rst), .in_valid(in_valid), .in_tag(tag), .in_data({{{asked}}}),
      .out_valid(out_valid), .out_tag(out_tag), .out_flags(out_flags), .out_data(answer)
  );
  assign in_ready = 1'b1;"""
    return f"""\
// Written by tb/sim/native_run.py: the {datapath} datapath, {width} bits.
module {TOP} (
    input wire clk, rst, in_valid,
    input wire [7:0] tag,
    input wire [{32 * (len(lanes) + bool(side)) - 1}:0] target,
    output wire in_ready, out_valid,
    output wire [7:0] out_tag,
    output wire [{path.flag_bits - 1}:0] out_flags,
    output wire [{32 * len(of_answer) - 1}:0] result,
    output wire [{32 * words - 1}:0] nodes
);
  wire [{len(of_answer) * width - 1}:0] answer;
{instance}
  assign result = {{{results}}};
  assign nodes = {{
      {lines}
  }};
endmodule
"""


def program(
    datapath: str, width: int, root: Path = ROOT, name: str = "", kind: str | None = None, limits: Limits | None = None
) -> Path:
    """Build the program of a datapath if necessary; return its path.

    The parameters are those of :func:`tb.sim.simulate.simulate`, where ``kind`` is named ``cores``. Raises
    :class:`SimulationError` with the compilers' messages.
    """
    digit = CORES.index(cores(kind)) if MODELS[datapath].rtl == "paper" else 0
    parts = [datapath, f"W{width}", *(["digit"] if digit else []), *([name] if name else [])]
    parts += [hashlib.sha1(str(limits).encode()).hexdigest()[:10]] if limits else []
    folder, text = coverage.build("native") / "-".join(parts), wrapper(datapath, width, digit, limits)
    top = folder / f"{TOP}.v"
    command = ["verilator", "--cc", "--exe", "--build", "-O3", "-Wno-fatal", "--x-initial", "unique"]
    command += [*(coverage.FLAGS if coverage.folder() else []), "--prefix", "Vtop", "--top-module", TOP]
    command += [*(f"-I{path}" for path in includes(root)), "-CFLAGS", "-std=gnu++20", "--Mdir", str(folder)]
    command += [*COMPACT, *map(str, sources(root)), str(top), str(Path(__file__).with_suffix(".cpp"))]
    # -O2 compiles twice as long as -O1 and simulates as fast
    with alone(folder), runtime(folder, "native") as shared:
        if not (top.exists() and top.read_text() == text):
            top.write_text(text)
        done = compiled([*command, "-MAKEFLAGS", shlex.join([*shared, "OPT_FAST=-O1"])])
    if done.returncode:
        message = full(folder) or done.stderr[-4000:] or done.stdout[-4000:]
        raise SimulationError(f"the Verilator build failed: {message}")
    return folder / "Vtop"


def answered(
    words: np.ndarray, width: int, datapath: str, limits: Limits | None = None
) -> Iterator[tuple[np.ndarray, fixed.Answer]]:
    """Yield frames of at most :data:`FRAME` targets, each with the model's answer."""
    for start in range(0, len(words), FRAME):
        piece = words[start : start + FRAME]
        yield piece, answer(piece, width, datapath, limits)


def columns(node: Node) -> Iterator[np.ndarray]:
    """Yield the words of a node as columns of 64 bits, lowest bits first."""
    for low in range(0, node.format.width, 64):
        limb = node.value >> low
        if limb.dtype == object:
            limb = (limb & ((1 << 64) - 1)).astype(np.uint64)
        yield limb.astype("<i8")


def compare(
    path: Path, frames: Iterable[tuple[np.ndarray, fixed.Answer]], width: int, datapath: str, root: Path = ROOT
) -> Run:
    """Run the targets of all frames in order, without stalls, and compare every node; return the run.

    ``root`` is the RTL copy that the program was built from. Raises :class:`SimulationError` for lost or reordered
    results, wrong results although all nodes are right, a changing latency, or a program that stops early.
    """
    nodes, of = nodes_of(datapath, width), MODELS[datapath]
    header = [width, len(of.inputs) + bool(of.side), len(of.results), len(nodes)]
    header += (fact for node in nodes for fact in (node.time, node.format.width))
    sizes = []
    with coverage.counting(root) as counts, tempfile.NamedTemporaryFile(prefix="ik_") as file:
        process = Popen([path, file.name, *counts], env=environment(), stdin=PIPE, stdout=PIPE, stderr=PIPE)
        try:
            with contextlib.suppress(BrokenPipeError):  # stderr has the reason
                process.stdin.write(np.array(header, dtype="<u8").tobytes())
                for words, answer in frames:
                    process.stdin.write(np.array([len(words)], dtype="<u8").tobytes())
                    named = (column for node in answer.shown for column in columns(node))
                    for column in (*words.T, *answer.results.T, answer.flags, *named):
                        process.stdin.write(np.ascontiguousarray(column, dtype="<i8"))
                    sizes.append(len(words))
                process.stdin.write(bytes(8))
            out, err = process.communicate()
        finally:
            process.kill()
            process.wait()
        if process.returncode:
            raise SimulationError(f"the native simulation failed: {err.decode(errors='replace').strip()[-1000:]}")
        back = np.fromfile(file.name, dtype="<i8")
    return _run(out.decode(), back, sizes, nodes, width, len(of.results) + 1)


def _run(said: str, back: np.ndarray, sizes: list[int], nodes: list[Node], width: int, count: int) -> Run:
    """Return the run. ``said``: the program's text output; ``back``: results and flags, ``count`` words a target."""
    done, *differs = said.splitlines()
    targets, latency, clocks, bits = map(int, done.split()[1:])
    if targets != sum(sizes) or len(back) != count * targets:
        raise SimulationError(f"{sum(sizes)} targets were sent, {targets} results came back")
    ends = np.cumsum(sizes)[:-1] * count
    rows = np.concatenate([part.reshape(count, -1).T for part in np.split(back, ends)])
    half = 1 << (width - 1)
    differences = []
    for line in differs:
        node, target, clock, rtl, model = re.fullmatch(r"differs (\d+) (\d+) (\d+) (\w+) (\w+)", line).groups()
        of = nodes[int(node)]
        texts = (format(int(word, 16), f"0{of.format.width}b") for word in (rtl, model))
        differences.append(Difference(of, int(target), int(clock), *texts))
    first = report(differences, nodes) or None
    return Run((rows[:, :-1] ^ half) - half, rows[:, -1].copy(), latency, clocks, bits, first)
