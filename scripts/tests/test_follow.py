# SPDX-License-Identifier: Apache-2.0
"""Test `make follow` and its files (VCDs, aligned VCDs, save files) with the fake simulator and with the RTL."""

import re
from pathlib import Path

import numpy as np
import pytest

from model.dataflow.datapaths import DATAPATHS
from model.io import trajectories
from model.io.stimuli import random_reachable
from model.io.words import to_words
from scripts import follow, waves
from scripts.conftest import admissions, nodes_of
from scripts.waves import TOPS, place
from tb.sim.env import simulator as simulator_of_tests
from tb.sim.simulate import simulate
from tb.sim.waves import Signals


def reach():
    return to_words(trajectories.make("reach"), 32)[0]


TIMES = {node.name: node.time for node in nodes_of(reach())}
"""Node of the lean datapath -> clocks from admission to its word."""


def check_aligned(vcd, nodes, first, wrong=(), datapath="lean"):
    """Check the words of an aligned VCD against the model, and its names and scopes against the design."""
    paths = {node.name: place(datapath, node) for node in nodes}
    last = max(node.time for node in nodes)
    seen, gaps, signals = [], [], Signals(vcd, TOPS)
    assert set(signals) == {*paths.values(), ("target",), ("differs",)}
    for time, bits in signals.changes():
        column = {path: bits[signal.code] for path, signal in signals.items()}
        if "x" in column["target",]:
            assert all(set(bits) == {"x"} for bits in column.values())
            gaps.append(time)
            continue
        target = int(column["target",], 2)
        seen.append(target)
        assert time == (first[target] + last) * 10_000 - 5_000
        for node in nodes:
            differs = (node.name, target) in wrong
            assert (column[paths[node.name]] != waves.model_bits(node, target)) == differs, (node.name, target)
        assert int(column["differs",]) == (target in {number for _, number in wrong})
    assert seen == list(range(len(first)))
    # all X from the beginning, and in the clock after a target that no target follows directly
    assert gaps == [0, *((clock + last) * 10_000 + 5_000 for clock in first if clock + 1 not in first)]


def traced(save_file):
    """Return the names of the signals in a save file."""
    return set(re.findall(r"^[+#]\{.*?\} (?:\(\d+\))?(\S+)", save_file.read_text(encoding="utf-8"), re.M))


def marker(save_file):
    """Return the time of a save file's marker, and the labels of its red traces."""
    text = save_file.read_text(encoding="utf-8")
    (at,) = re.findall(r"^\*\S+ (-?\d+)", text, re.M)
    return int(at), re.findall(r"^\[color\] 1\n(?:[@\[].*\n)*[+#]\{(.*?)\}", text, re.M)


def name_of(line: str) -> str:
    """Return the name of the node in a line that is marked by `!`."""
    _, _, _, name, *others = line.split()
    return others[0] if name.startswith("(") else name  # skip the number of the paper's equation


@pytest.mark.parametrize("datapath", ["lean", "paper"])
def test_every_node_stands_in_its_line(command, files, simulator, datapath):
    """Check each node's line (clocks, number in the paper, name, words, values, equation); no file is written."""
    status, out, err = command(follow.main, "--target", "42", "--datapath", datapath)
    nodes = nodes_of(reach(), datapath)
    assert (status, err, files()) == (0, [], [])
    admitted = admissions(100)[42]
    assert f"admitted in clock {admitted}" in out[0] and f"all {len(nodes)} nodes" in out[-1]
    sections = dict.fromkeys(node.section for node in nodes if node.kind != "input")
    titles = [f"{section}: {DATAPATHS[datapath].sections[section]}" for section in sections]
    assert [line for line in out if line[0] != " "][1:-1] == ["inputs", *titles]
    rows = [line.split() for line in out if re.match(r"  +\d+ +\+\d", line)]
    for row, node in zip(rows, nodes, strict=True):
        bits = waves.model_bits(node, 42)
        word = f"{int(bits, 2):0{-(-len(bits) // 4)}x}"
        value = f"{int(node.value[42]) / 2**node.format.frac:.10g}"
        clocks, number = [str(admitted + node.time), f"+{node.time}"], [node.equation] if node.equation else []
        assert row == [*clocks, *number, node.name, word, word, value, value, *node.right_side.split()], node.name


def test_a_node_that_differs_is_marked_and_explained(command, simulator):
    """Check that target 3's first differing node is shown with its operands; with --target 4, stderr names 3."""
    simulator.wrong = [("qs_w", 3), ("w_1", 3), ("wi_c", 3)]
    status, out, err = command(follow.main, "--target", "3")
    assert (status, err) == (1, [])
    marked = [line for line in out if line.startswith("!")]
    assert [name_of(line) for line in marked] == ["wi_c", "w_1", "qs_w"]
    assert marked[1].endswith("  bend_swap ? wi_c + i_dif : wi_c - i_dif")
    shown = out[[line.startswith("first difference") for line in out].index(True) :]
    admitted = admissions(100)[3]
    assert f"turn.wi_c of target 3 at clock {admitted + TIMES['wi_c']}: RTL " in shown[0]
    assert "equation: wi_c = wi_0 * bend_c" in shown[1]
    for line, name in zip(shown[2:4], ("wi_0", "triangle.bend_c"), strict=True):
        (node,) = (node for node in nodes_of(reach()) if node.name == name.split(".")[-1])
        bits = waves.model_bits(node, 3)
        assert line.split()[:-1] == [*f"{name} at clock {admitted + node.time}:".split(), f"{int(bits, 2):09x}"]
    assert "2 more nodes" in shown[4]
    status, out, (err,) = command(follow.main, "--target", "4")
    assert status == 0 and "target that differs is 3" in err and f"all {len(TIMES)} nodes" in out[-1]


def test_a_hand_pose(command, simulator):
    """Check that all nodes of the whole arm and of its core are printed, and that the robot's limits are used."""
    simulator.wrong = [("w_1", 2), ("th6", 2)]
    words = "--trajectory", "pick_and_place", "--target", "2", "--waves", "--out", "o"
    status, out, _ = command(follow.main, *words)
    (call,) = simulator.calls
    words = np.delete(call["jobs"][0], np.s_[11:18], axis=1)  # without reference joints
    nodes = nodes_of(words, "arm", 32, call["limits"])
    assert status == 1 and call["limits"] != [(-(2**31), 2**31 - 1)] * 7
    assert [name_of(line) for line in out if line.startswith("!")] == ["w_1", "th6"]
    rows = [line for line in out if re.match(r"[ !] +\d+ +\+\d", line)]
    assert len(rows) == len(nodes) and all(f" {node.name} " in row for node, row in zip(nodes, rows, strict=True))
    assert "joints: angles" in out
    admitted, time_of = admissions(100), {node.name: node.time for node in nodes}
    check_aligned(Path("o/aligned.vcd"), nodes, admitted, simulator.wrong, "arm")
    label = f"w_1 +{time_of['w_1']}"
    assert marker(Path("o/waves.gtkw")) == ((admitted[2] + time_of["w_1"]) * 10_000, [label])
    assert marker(Path("o/aligned.gtkw")) == ((admitted[2] + max(time_of.values())) * 10_000, [label])
    assert traced(Path("o/aligned.gtkw")) <= {signal.name for signal in Signals(Path("o/aligned.vcd"), TOPS).values()}
    assert Path("o/aligned.gtkw").read_text().startswith('[dumpfile] "aligned.vcd"\n')


def test_x_is_a_difference(tmp_path, simulator):
    """Check that an abbreviated X is extended (VCDs omit leading digits) and that words after the end are X."""
    words = np.stack([reach()[0]] * 3)
    nodes = nodes_of(words)
    vcd = tmp_path / "x.vcd"
    simulator.record(vcd, [words], "lean", 32)
    code = re.search(r"\$var wire 35 (\S+) w_1", vcd.read_text())[1]
    vcd.write_text(re.sub(rf"^b[01]+ {re.escape(code)}$", f"bx01 {code}", vcd.read_text(), flags=re.M))
    read = waves.read(vcd, "lean", nodes)
    differences = [(differs.node.name, differs.target, differs.rtl) for differs in waves.differences(read, nodes)]
    assert differences == [("w_1", k, "x" * 33 + "01") for k in range(3)]
    read.admitted.append(len(read.words["w_1"]))
    assert read.word(nodes[-1], 3) == "x" * nodes[-1].format.width


SHOWN = {
    "lean": (),
    "paper": (
        "[fpshift_count] 34\n+{pp_sq ",  # an unrounded product
        "[fpshift_count] 31\n@40000024\n+{h4_p ",  # unsigned
        "[fpshift_count] 58\n@40800420\n#{x_sq +4} (0)ik_axis",  # more than 64 bits
        "@24\n+{lz_p ",  # a count
        "@28\n+{flat ",  # a bit
    ),
}
"""Datapath -> lines of its save file."""


@pytest.mark.sim
@pytest.mark.cost(10)
@pytest.mark.parametrize("datapath", ["lean", pytest.param("paper", marks=pytest.mark.slow)])
def test_a_recording_of_the_rtl(command, tmp_path, datapath):
    """Check that all nodes are recorded at their clocks, that internals of delay lines and operators are not, and that
    save files name signals of the VCD and show words as numbers."""
    words, vcd = random_reachable(3, 32, seed=3), tmp_path / "waves.vcd"
    nodes = nodes_of(words, datapath)
    (ran,) = simulate([words], simulator=simulator_of_tests(), datapath=datapath, width=32, waves=vcd)
    assert ran.bit_mismatches == 0
    read = waves.read(vcd, datapath, nodes)
    assert len(read.admitted) == 3 and not list(waves.differences(read, nodes))
    known = Signals(vcd, TOPS)
    assert vcd.stat().st_size < 30e6 and not {"line", "mem"} & {path[-1] for path in known}
    waves.align(vcd, words, 32, datapath)
    check_aligned(tmp_path / "aligned.vcd", nodes, read.admitted, datapath=datapath)
    assert marker(tmp_path / "waves.gtkw") == (-1, [])
    save_file = tmp_path / "again.gtkw"
    assert command(waves.main, str(vcd), datapath, "32", str(save_file)) == (0, [], [])
    assert save_file.read_bytes() == (tmp_path / "waves.gtkw").read_bytes()
    assert {known[place(datapath, node)].name for node in nodes} <= traced(save_file)
    assert traced(save_file) <= {signal.name for signal in known.values()}
    assert all(lines in save_file.read_text() for lines in SHOWN[datapath])
