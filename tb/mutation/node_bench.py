# SPDX-License-Identifier: Apache-2.0
"""Verilog bench of ``ik_axis`` or ``ik_arm`` that compares every node of a netlist: under stalls, with a full FIFO,
after a reset.

Under Icarus it finishes in the few seconds that cocotb takes to start. It stops at the first difference. A plusarg
selects a mutant.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from model.dataflow.datapaths import MODELS, Datapath
from model.io.stimuli import arithmetic_corners, arm_limits, arm_targets, mixed
from tb.mutation.netlists import BITS, SELECT
from tb.sim.job import answer, limits_port
from tb.sim.native_run import columns

TOP, DATA = "node_bench", "data.hex"
TAG_W = 8
RIGHT = "all right"  # start of the last output line of a run without differences


@dataclass(frozen=True)
class NodeBench:
    """A datapath, its word length, and the number of mixed targets; `corners` adds corner targets."""

    datapath: str
    width: int
    targets: int
    digit: int = 0
    corners: bool = False

    @property
    def name(self) -> str:
        return f"nodes {self.datapath} {self.width}{' digit' if self.digit else ''} {self.targets}"

    @property
    def path(self) -> Datapath:
        return MODELS[self.datapath]

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of the top."""
        digit = {} if self.path.side else {"DIGIT": self.digit}
        return {"W": self.width, "TAG_W": TAG_W, **digit, **self.path.parameters}

    def words(self) -> np.ndarray:
        """Return the targets as words, of the whole arm with their branch."""
        if self.path.side:
            return arm_targets(self.targets, self.width, 4)
        words = mixed(self.targets, self.width, 4)
        if self.corners:
            words = np.concatenate([words, arithmetic_corners(self.width, self.path.tile)])
        return words

    def write(self, folder: Path) -> Path:
        """Write the bench and its data into a folder; return the path of the bench."""
        words = self.words()
        answered = answer(words, self.width, self.datapath)
        nodes = list(answered.bits.nodes.values())
        rows, at = [0] * len(words), 0
        for values, bits in fields(words, answered, nodes, self.width, self.path):
            rows = [row | (int(v) & (1 << bits) - 1) << at for row, v in zip(rows, values.tolist(), strict=True)]
            at += bits
        (folder / DATA).write_text("\n".join(f"{row:x}" for row in rows) + "\n")
        bench = folder / f"{TOP}.v"
        bench.write_text(self._text(nodes, len(words), at))
        return bench

    def _text(self, nodes: list, count: int, bits: int) -> str:
        path, w = self.path, self.width
        core = f"u_axis.\\g_{path.rtl}.u_core "
        sizes = len(path.inputs) * w, len(path.side), len(path.results) * w, path.flag_bits
        at = sum(sizes)
        by_time: dict[int, list[str]] = {}
        for node in nodes:
            within = ".".join(part for part in (path.instance(node), node.name) if part)
            if path.times and node.instance:  # a named block of the folded core, not an instance
                within = f"\\{within} "
            compare = f"{core}.{within} !== want[{at}+:{node.format.width}]"
            line = f'if ({compare}) differs("{node.section}.{node.name}");'
            by_time.setdefault(node.time, []).append(line)
            at += node.format.width
        compared = "\n".join(
            f"      find({time});\n      if (target >= 0) begin\n        " + "\n        ".join(lines) + "\n      end"
            for time, lines in sorted(by_time.items())
        )
        latest = max(by_time)
        return BENCH.format(
            top=TOP,
            core=path.top,
            words=sizes[0],
            asked=sum(sizes[:2]),
            given=sizes[2],
            flags=sizes[3],
            limits=f", .limits({14 * w}'h{limits_port(arm_limits(w), w):x})" if path.side else "",
            user="{next[IN-1:WORDS], tag}" if path.side else "tag",
            n=count,
            bits=bits,
            tag=TAG_W,
            select=SELECT,
            select_bits=BITS,
            compared=compared,
            ring=1 << (latest + 2).bit_length(),
            go=f"{core}.go" if path.times else "1'b1",
            most=count * (path.period + 8) * 3 + 20 * latest + 4000,
            full=2 * latest + 200 if path.times else latest + (2 << (latest + 4).bit_length()),
        )


def fields(words: np.ndarray, answered, nodes: list, width: int, path: Datapath) -> Iterator[tuple[np.ndarray, int]]:
    """Yield the columns of the data with their widths: targets, branch, results, flags, nodes; the first in the low
    bits."""
    count = len(path.inputs)
    yield from ((column, width) for column in words[:, :count].T)
    yield from ((column, len(path.side)) for column in words[:, count:].T)
    yield from ((column, width) for column in answered.results.T)
    yield answered.flags, path.flag_bits
    for node in nodes:
        for number, limb in enumerate(columns(node)):
            yield limb, min(64, node.format.width - 64 * number)


BENCH = """\
// Written by tb/mutation/node_bench.py.
`timescale 1ns / 1ps
module {top};
  localparam WORDS = {words}, IN = {asked}, OUT = {given}, FLAGS = {flags}, N = {n}, FULL = {full};
  reg clk, rst, in_valid, out_ready;
  reg [{bits}-1:0] data[0:N-1];
  reg [{bits}-1:0] want, next, owed;
  wire in_ready, out_valid;
  wire [OUT-1:0] result;
  wire [{tag}+FLAGS-1:0] user;
  integer sent, left, clock, ran, target, first, blocked, held, k, seed;
  integer ring[0:{ring}-1];
  reg stalled;
  reg [8*1000-1:0] file;
  reg [OUT+{tag}+FLAGS-1:0] stood;
  reg [{tag}-1:0] tag;
  reg [{select_bits}-1:0] selected;
  {core} u_axis (
      .clk(clk), .rst(rst), .{select}(selected){limits},
      .s_axis_tdata(next[WORDS-1:0]), .s_axis_tuser({user}), .s_axis_tvalid(in_valid), .s_axis_tready(in_ready),
      .m_axis_tdata(result), .m_axis_tuser(user), .m_axis_tvalid(out_valid), .m_axis_tready(out_ready)
  );
  task fails(input [8*40-1:0] why);
    begin
      $display("%0s: target %0d in, %0d out, clock %0d", why, sent, left, clock);
      $finish(0);
      forever #1000;
    end
  endtask
  task differs(input [8*40-1:0] node);
    begin
      $display("%0s of target %0d differs in clock %0d", node, target, clock);
      $finish(0);
      forever #1000;
    end
  endtask
  // the target admitted `ago` clocks ago, and its words
  task find(input integer ago);
    begin
      target = ran >= ago ? ring[(ran - ago) % {ring}] : -1;
      if (target >= 0) want = data[target];
    end
  endtask
  task step;
    begin
      #4 clk = 0;
      #4;
      clock = clock + 1;
      if (clock > {most}) fails("no end");
      if (rst) begin
        for (k = 0; k < {ring}; k = k + 1) ring[k] = -1;
        stalled = 0;
        left = sent;
      end else begin
        if ((in_ready ^ out_valid) === 1'bx) fails("X of a handshake");
        if (in_valid && in_ready) begin
          ring[ran%{ring}] = sent;
          sent = sent + 1;
          if (first < 0) first = clock;
          blocked = 0;
        end else blocked = blocked + 1;
        if (stalled && {{out_valid, result, user}} !== {{1'b1, stood}}) fails("changed while stalled");
        stood = {{result, user}};
        stalled = out_valid && !out_ready;
        if (out_valid && out_ready) begin
          if (left >= sent) fails("result without a target");
          owed = data[left];
          k = left;
          if (user[{tag}-1:0] !== k[{tag}-1:0]) fails("tag");
          if (result !== owed[IN+:OUT]) fails("result");
          if (user[{tag}+:FLAGS] !== owed[IN+OUT+:FLAGS]) fails("flags");
          if (left == 0) $display("latency %0d", clock - first);
          left = left + 1;
        end
{compared}
        if ({go} !== 1'b0) begin
          ran = ran + 1;
          ring[ran%{ring}] = -1;
        end
      end
      #1 clk = 1;
      #1 next = data[sent < N ? sent : N-1];  // the caller sets the other inputs
      tag = sent;
    end
  endtask
  initial begin
    if (!$value$plusargs("data=%s", file)) fails("no data");
    if (!$value$plusargs("{select}=%d", selected)) selected = 0;
    $readmemh(file, data);
    {{clk, in_valid, stalled}} = 0;
    {{rst, out_ready}} = 3;
    {{sent, left, clock, ran, blocked, held}} = 0;
    first = -1;
    seed = 1;
    next = data[0];
    tag = 0;
    for (k = 0; k < {ring}; k = k + 1) ring[k] = -1;
    repeat (4) step;
    rst = 0;
    // no stalls
    in_valid = 1;
    while (sent < N / 2) step;
    in_valid = 0;
    while (left < sent) step;
    $display("clocks %0d", clock);
    // stalls on both sides
    while (sent < 3 * N / 4) begin
      if (held == 0) begin
        held = $dist_uniform(seed, 1, 8);
        in_valid = $random(seed) | (in_valid && blocked != 0);  // an offer stays
        out_ready = $random(seed);
      end else held = held - 1;
      step;
    end
    // no result is taken until the FIFO is full, then a reset
    in_valid = 1;
    out_ready = 0;
    blocked = 0;
    while (sent < N - 12 && blocked < FULL) step;
    $display("full at %0d", sent);
    out_ready = 1;
    repeat (3) step;
    rst = 1;
    repeat (3) step;
    rst = 0;
    while (sent < N) step;
    in_valid = 0;
    while (left < sent) step;
    repeat (8 + {ring}) step;
    $display("{right}: %0d targets, %0d clocks", left, clock);
    $finish(0);
  end
endmodule
""".replace("{right}", RIGHT)
