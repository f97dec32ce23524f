# SPDX-License-Identifier: Apache-2.0
"""Tests of `make follow`: it prints every node of a target and names the wrong one; its VCD aligns nodes by target."""

import re
from pathlib import Path

import numpy as np
import pytest
from vcd.gtkw import GTKWColor
from vcd.reader import TokenKind, tokenize
from vcd.writer import VCDWriter

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.io import trajectories
from model.io.words import to_words
from scripts import follow, recording, run
from scripts.save_file import names as names_in
from scripts.save_file import place, signals
from tb.sim.env import SIMULATORS, simulator
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.simulate import Job, simulate

FIRST, GAP = 6, 3
"""Clock in which the simulator below admits target 0; idle clocks between targets 1 and 2."""

TOP = ("ik_axis",)
WIDTH = 18


def nodes_of(words, datapath="lean", width=32):
    return list(fixed.run(words, width, datapath).bits.nodes.values())


def reach(width=32):
    return to_words(trajectories.make("reach"), width)[0]


TIMES = {node.name: node.time for node in nodes_of(reach())}
"""Clock of each node of the lean datapath."""


class Simulator:
    """Replacement for the simulator: writes a VCD with the model's words, wrong at each (node, target) of `wrong`."""

    def __init__(self, monkeypatch, wrong=()):
        self.wrong = wrong
        monkeypatch.setattr(follow, "simulate", self)

    def __call__(self, jobs, *, datapath, width, waves, **_):
        (job,) = jobs
        nodes = nodes_of(job.words, datapath, width)
        admitted = [FIRST + k + GAP * (k > 1) for k in range(len(job.words))]
        with open(waves, "w", encoding="ascii") as stream, VCDWriter(stream, timescale="1 ps") as writer:
            plain = {
                name: writer.register_var(TOP, name, "wire", 1)
                for name in ("clk", "rst", "s_axis_tvalid", "s_axis_tready")
            }
            for name in STREAMS:
                bits = 6 * width if name.endswith("tdata") else 8
                writer.register_var(TOP, f"{name}[{bits - 1}:0]", "wire", bits)
            for name in ("m_axis_tvalid", "m_axis_tready"):
                writer.register_var(TOP, name, "wire", 1)
            core = (*TOP, f"g_{datapath}", "u_core")
            for name in ("in_valid", "out_valid"):
                writer.register_var(core, name, "wire", 1)
            lines = {}
            for node in nodes:
                place = (*core, *([node.instance] if node.instance else []))
                bits = node.format.width
                name = f"{node.name}[{bits - 1}:0]" if bits > 1 else node.name
                lines[node.name] = writer.register_var(place, name, "wire", bits)
            for clock in range(1, admitted[-1] + max(node.time for node in nodes) + 9):
                rise = 10_000 * clock - 5_000
                for name, bit in (
                    ("clk", 1),
                    ("rst", clock < 4),
                    ("s_axis_tready", 1),
                    ("s_axis_tvalid", clock in admitted),
                ):
                    writer.change(plain[name], rise, int(bit))
                for node in nodes:
                    if clock - node.time in admitted:
                        target = admitted.index(clock - node.time)
                        bits = recording.model_bits(node, target)
                        if (node.name, target) in self.wrong:
                            bits = format(int(bits, 2) ^ 1, f"0{len(bits)}b")
                        writer.change(lines[node.name], rise, bits)
                    else:
                        writer.change(lines[node.name], rise, "x")
                writer.change(plain["clk"], 10_000 * clock, 0)


STREAMS = [f"{side}_axis_{what}" for side in "sm" for what in ("tuser", "tdata")]


def columns(vcd):
    """Return the content of an aligned VCD: time of a change -> path -> bits or X."""
    names, scopes, now, shown = {}, [], {}, {}
    with open(vcd, "rb") as stream:
        time = 0
        for token in tokenize(stream):
            if token.kind is TokenKind.SCOPE:
                scopes.append(token.scope.ident)
            elif token.kind is TokenKind.UPSCOPE:
                scopes.pop()
            elif token.kind is TokenKind.VAR:
                names[token.var.id_code] = (".".join([*scopes, token.var.reference]), token.var.size)
            elif token.kind is TokenKind.CHANGE_TIME:
                time = token.time_change
            elif token.kind in (TokenKind.CHANGE_SCALAR, TokenKind.CHANGE_VECTOR):
                name, size = names[token.data.id_code]
                value = token.data.value
                now[name] = f"{value:0{size}b}" if isinstance(value, int) else str(value)
                shown[time] = dict(now)
    return shown


def check_aligned(vcd, nodes, targets, first, wrong=()):
    """Check each column against the model's words, and names and scopes against the design."""
    paths = {node.name: ".".join(("ik_axis", *place("lean", node))) for node in nodes}
    shown = columns(vcd)
    last = max(node.time for node in nodes)
    seen, gaps = [], []
    for time, column in shown.items():
        assert set(column) == {*paths.values(), "ik_axis.target", "ik_axis.differs"}
        if "x" in column["ik_axis.target"]:
            assert all(set(bits) == {"x"} for bits in column.values())
            gaps.append(time)
            continue
        target = int(column["ik_axis.target"], 2)
        seen.append(target)
        assert time == (first[target] + last) * 10_000 - 5_000
        for node in nodes:
            differs = (node.name, target) in wrong
            assert (column[paths[node.name]] != recording.model_bits(node, target)) == differs, (node.name, target)
        assert int(column["ik_axis.differs"]) == (target in {each for _, each in wrong})
    assert seen == list(range(targets))
    # X from the beginning, and in the clock after a target that has no neighbour
    lonely = [clock for clock in first if clock + 1 not in first]
    assert gaps == [0, *((clock + last) * 10_000 + 5_000 for clock in lonely)]


def marker(save_file):
    """Return the time of a save file's marker and the label of the trace in red."""
    lines = save_file.read_text().splitlines()
    (at,) = [int(line.split()[1]) for line in lines if re.match(r"\*-?\d", line)]
    red = [label(lines[k + 1 :]) for k, line in enumerate(lines) if line == f"[color] {GTKWColor.red.value}"]
    return at, red


def label(lines):
    """Return the label of the first trace in lines of a save file."""
    return next(re.search(r"{(.*?)}", line)[1] for line in lines if line[0] in "+#")


# -- the command, with the model as simulator ------------------------------------------------------


@pytest.mark.parametrize("datapath", ["lean", "paper"])
def test_every_node_stands_in_its_line(command, files, monkeypatch, datapath):
    """Lines are in dataflow order: clock, equation, both words, both values, operands. No file is written."""
    Simulator(monkeypatch)
    status, out, err = command(follow.main, "--target", "42", "--datapath", datapath)
    nodes = nodes_of(reach(), datapath)
    assert (status, err, files()) == (0, [], [])
    admitted = FIRST + 42 + GAP
    assert f"target 42 of reach: {datapath} datapath, 32 bits, icarus; admitted in clock {admitted}" in out[0]
    assert out[-1] == f"all {len(nodes)} nodes equal the model"
    sections = dict.fromkeys(node.section for node in nodes if node.op != "input")
    titles = [f"{section}: {DATAPATHS[datapath].sections[section]}" for section in sections]
    assert [line for line in out if line[0] != " "][1:-1] == ["inputs", *titles]
    rows = [line.split() for line in out if re.match(r"  +\d+ +\+\d", line)]
    assert len(rows) == len(nodes)
    for row, node in zip(rows, nodes, strict=True):
        bits = recording.model_bits(node, 42)
        word = f"{int(bits, 2):0{-(-len(bits) // 4)}x}"
        value = f"{int(node.value[42]) / 2**node.format.frac:.10g}"
        given = [str(admitted + node.time), f"+{node.time}", *([node.equation] if node.equation else []), node.name]
        assert row[: len(given) + 5] == [*given, word, word, value, value, node.op], node.name
        assert all(operand.name in " ".join(row) for operand in node.operands if operand.op != "constant")


def test_a_node_that_differs_is_marked_and_explained(command, monkeypatch):
    """The first difference in dataflow order is shown with its operands; for another target one line names it."""
    Simulator(monkeypatch, wrong=[("qs_w", 3), ("w_1", 3), ("wi_c", 3)])
    status, out, err = command(follow.main, "--target", "3")
    assert (status, err) == (1, [])
    assert [line.split()[4] for line in out if line.startswith("!")] == ["wi_c", "w_1", "qs_w"]
    told = out[[line.startswith("first difference") for line in out].index(True) :]
    admitted = FIRST + 3 + GAP
    clock = admitted + TIMES["wi_c"]
    assert told[0].startswith(f"first difference: turn.wi_c (L52) of target 3 at clock {clock}: RTL ")
    assert told[1].strip() == "made of: mul3 wi_0, triangle.arm_c; in RTL and model alike"
    for line, name in zip(told[2:4], ("wi_0", "triangle.arm_c"), strict=True):
        (node,) = (node for node in nodes_of(reach()) if node.name == name.split(".")[-1])
        bits = recording.model_bits(node, 3)
        assert line.split()[:-1] == [*f"{name} at clock {admitted + node.time}:".split(), f"{int(bits, 2):09x}"]
    assert told[4] == "            then: 2 more nodes of this target, marked with !"
    status, out, err = command(follow.main, "--target", "4")
    assert (status, err) == (0, ["follow: the first target that differs is 3"])
    assert out[-1] == f"all {len(TIMES)} nodes equal the model"


def test_aligned_vcd(command, monkeypatch):
    """Each target has a column, with X between them; the first difference is marked."""
    wrong = [("w_1", 3), ("u_x", 5)]
    Simulator(monkeypatch, wrong)
    status, out, _ = command(follow.main, "--target", "3", "--waves", "--out", "o")
    assert status == 1
    written = [f"o/{name}" for name in ("waves.vcd", "waves.gtkw", "aligned.vcd", "aligned.gtkw")]
    assert out[-4:] == [f"wrote {name}" for name in written] and all(map(Path.exists, map(Path, written)))
    admitted = [FIRST + k + GAP * (k > 1) for k in range(100)]
    nodes = nodes_of(reach())
    check_aligned(Path("o/aligned.vcd"), nodes, 100, admitted, wrong)
    label = f"w_1 (L52) +{TIMES['w_1']}"
    assert marker(Path("o/waves.gtkw")) == ((admitted[3] + TIMES["w_1"]) * 10_000, [label])
    assert marker(Path("o/aligned.gtkw")) == ((admitted[3] + max(TIMES.values())) * 10_000, [label])
    known = set(signals(Path("o/aligned.vcd")).values())
    named = set(names_in(Path("o/aligned.gtkw")))
    assert named == known


def test_x_is_a_difference(tmp_path, command, monkeypatch):
    """Leading digits are omitted in a VCD, so a short X value must be extended."""
    words = np.stack([reach()[0]] * 3)
    nodes = nodes_of(words)
    Simulator(monkeypatch)
    vcd = tmp_path / "x.vcd"
    follow.simulate([Job("x", words)], simulator="icarus", datapath="lean", width=32, waves=vcd)
    code = re.search(r"\$var wire 35 (\S+) w_1", vcd.read_text())[1]
    vcd.write_text(re.sub(rf"^b[01]+ {re.escape(code)}$", f"bx01 {code}", vcd.read_text(), flags=re.M))
    read = recording.read(vcd, "lean", nodes)
    found = [(each.node.name, each.target, each.rtl) for each in recording.differences(read, nodes)]
    assert found == [("w_1", k, "x" * 33 + "01") for k in range(3)]


def test_a_recording_that_ends_early_is_x():
    node = nodes_of(reach()[:1])[-1]
    read = recording.Recording({node.name: ["0" * node.format.width] * 9}, [6], "1 ps", 10_000, 10_000)
    assert read.word(node, 0) == "x" * node.format.width


# -- a simulation ----------------------------------------------------------------------------------


@pytest.mark.sim
@pytest.mark.cost(25)
def test_a_bug_in_the_rtl(command, tmp_path, monkeypatch):
    """The listing marks the node that the scoreboard names; the aligned VCD holds the model's words elsewhere."""
    bug = Bug("follow", "rtl/lean/ik_lean_turn.v", "i_1 <= wi_c - w_sum;", "i_1 <= wi_c + w_sum;")
    root = copy_rtl(tmp_path / "copy", bug)
    runs = []

    def simulated(jobs, **options):
        runs.extend(simulate(jobs, **options, root=root, name="follow"))
        return runs

    monkeypatch.setattr(follow, "simulate", simulated)
    words = "--target", "7", "--waves", "--out", "o", "--sim", simulator(), "--width", str(WIDTH)
    status, out, _ = command(follow.main, *words)
    assert status == 1
    nodes = nodes_of(reach(WIDTH), width=WIDTH)
    marked = [line.split()[4] for line in out if line.startswith("!")]
    assert marked[0] == "i_1" and set(marked) <= {"i_1", "i_q", "qs_i"}
    read = recording.read(Path("o/waves.vcd"), "lean", nodes)
    found = list(recording.differences(read, nodes))
    (ran,) = runs
    assert ran.bit_mismatches == sum(each.bits() for each in found)
    assert ran.first_mismatch.splitlines()[0] == f"first difference: {found[0]}"
    wrong = {(each.node.name, each.target) for each in found}
    check_aligned(Path("o/aligned.vcd"), nodes, 100, read.admitted, wrong)
    at, red = marker(Path("o/aligned.gtkw"))
    assert at == (read.admitted[0] + max(node.time for node in nodes)) * 10_000 and red[0].startswith("i_1 (L53) +")
    assert marker(Path("o/waves.gtkw"))[0] == found[0].clock * 10_000


@pytest.mark.sim
@pytest.mark.parametrize(
    "main, more", [(follow.main, ("--target", "99")), (run.main, ("--datapath", "lean"))], ids=["follow", "run"]
)
def test_the_rtl_as_it_is(command, main, more):
    words = *more, "--waves", "--out", "o", "--sim", simulator(), "--width", str(WIDTH)
    status, out, err = command(main, *words)
    assert status == 0 and not any(line.startswith("!") for line in out)
    assert main is run.main or err == []
    nodes = nodes_of(reach(WIDTH), width=WIDTH)
    check_aligned(Path("o/aligned.vcd"), nodes, 100, recording.read(Path("o/waves.vcd"), "lean", nodes).admitted)


if simulator() == "verilator":

    @pytest.mark.sim
    @pytest.mark.cost(20)
    def test_both_simulators_give_the_same(command):
        """Listing, aligned VCD and save files are byte-identical."""
        options = "--target", "42", "--waves", "--width", str(WIDTH)
        outs = []
        for sim in SIMULATORS:
            status, out, err = command(follow.main, *options, "--sim", sim, "--out", sim)
            assert (status, err) == (0, [])
            outs.append([line.replace(sim, "SIM") for line in out])
        assert outs[0] == outs[1]
        for name in ("aligned.vcd", "aligned.gtkw", "waves.gtkw"):
            one, other = (Path(sim, name).read_bytes() for sim in SIMULATORS)
            assert one == other, name
