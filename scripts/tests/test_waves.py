# SPDX-License-Identifier: Apache-2.0
"""Tests of the core's VCD (every node at its clock), save files (only signals of the VCD) and scripts/waves.py."""

import pytest
from vcd.gtkw import GTKWFlag
from vcd.reader import TokenKind, tokenize

from model.dataflow import fixed
from model.io.stimuli import random_reachable
from scripts import waves
from scripts.save_file import names, place, signals, write_save_file
from tb.sim.env import simulator
from tb.sim.simulate import Job, simulate

pytestmark = pytest.mark.sim

WIDTH = 32
TARGETS = 3
MOST_BYTES = 30e6


@pytest.fixture(scope="module")
def words():
    return random_reachable(TARGETS, WIDTH, seed=3)


@pytest.fixture(scope="module")
def vcd(words, tmp_path_factory):
    """The VCD of a short simulation."""
    path = tmp_path_factory.mktemp("waves") / "ik_axis.vcd"
    (run,) = simulate([Job("waves", words)], simulator=simulator(), datapath="paper", width=WIDTH, waves=path)
    assert run.bit_mismatches == 0
    return path


@pytest.fixture(scope="module")
def save_file(vcd):
    path = vcd.with_suffix(".gtkw")
    write_save_file(vcd, "paper", WIDTH, path)
    return path


def clocks(vcd, wanted):
    """Return, for each clock from 1, the values at its falling edge: path below ik_axis -> bits, or None for X."""
    scopes, code_of, value, samples, fell = [], {}, {}, [], False
    with open(vcd, "rb") as stream:
        for token in tokenize(stream):
            if token.kind is TokenKind.SCOPE:
                scopes.append(token.scope.ident)
            elif token.kind is TokenKind.UPSCOPE:
                scopes.pop()
            elif token.kind is TokenKind.VAR and "ik_axis" in scopes:
                path = (*scopes[scopes.index("ik_axis") + 1 :], token.var.reference)
                if path in wanted:
                    code_of[path] = token.var.id_code
            elif token.kind in (TokenKind.CHANGE_SCALAR, TokenKind.CHANGE_VECTOR):
                change = token.data
                bits = int(change.value) if str(change.value).isdecimal() else None
                fell |= change.id_code == code_of[("clk",)] and bits == 0 and value.get(change.id_code) == 1
                value[change.id_code] = bits
            elif token.kind is TokenKind.CHANGE_TIME and fell:
                samples.append({path: value.get(code) for path, code in code_of.items()})
                fell = False
    return samples


def test_vcd_holds_every_node_at_its_clock(vcd, words):
    nodes = fixed.run(words, WIDTH).bits.nodes
    paths = {name: place("paper", node) for name, node in nodes.items()}
    assert paths["tmp1"] == ("g_paper", "u_core", "u_elbow", "tmp1")
    assert paths["c3"] == ("g_paper", "u_core", "u_to_wrist", "c3")
    stream = [("clk",), ("rst",), ("s_axis_tvalid",), ("s_axis_tready",)]
    samples = clocks(vcd, {*paths.values(), *stream})
    admitted = [k for k, sample in enumerate(samples) if [sample[path] for path in stream[1:]] == [0, 1, 1]]
    assert len(admitted) == TARGETS
    for name, node in nodes.items():
        mask = (1 << node.format.width) - 1
        expected = [int(v) & mask for v in node.value.tolist()]
        assert [samples[k + node.time][paths[name]] for k in admitted] == expected, name


def test_vcd_is_small(vcd):
    """Sections and streams are recorded; internals of delay lines and operators are not."""
    assert vcd.stat().st_size < MOST_BYTES
    assert not {"line", "mem"} & {path[-1] for path in signals(vcd)}


def test_save_file_names_signals_of_the_vcd(vcd, save_file):
    known = signals(vcd)
    named = set(names(save_file))
    assert named <= set(known.values())
    for node in fixed.run(random_reachable(1, WIDTH, seed=1), WIDTH).bits.nodes.values():
        assert known[place("paper", node)] in named, node.name


def test_save_file_shows_each_word_in_its_format(vcd, save_file):
    """Check flags and fixed-point shift of a word, an unrounded product, an unsigned word and one over 64 bits."""
    signed, unsigned = GTKWFlag.signed | GTKWFlag.fpdecshift, GTKWFlag.dec | GTKWFlag.fpdecshift
    for name, flags, frac in (
        ("elbow.p_e_x", signed, 30),
        ("elbow.pp_sq", signed, 34),
        ("guard.p_w_x", signed, 31),
        ("elbow_q.h4_p", unsigned, 31),
        ("guard.x_sq", signed | GTKWFlag.grp_begin, 58),
    ):
        assert shown(save_file, name) == (flags | GTKWFlag.rjustify, frac), name
    assert shown(save_file, "guard.lz_p") == (GTKWFlag.dec | GTKWFlag.rjustify, None)
    assert shown(save_file, "elbow.flat") == (GTKWFlag.bin | GTKWFlag.rjustify, None)


def shown(save_file, name):
    """Return the flags and the fixed-point shift in force at a node of a section."""
    section, node = name.split(".")
    group, flags, shift = "", None, None
    for line in save_file.read_text().splitlines():
        if line.startswith("@"):
            flags = GTKWFlag(int(line[1:], 16))
        elif line.startswith("[fpshift_count]"):
            shift = int(line.split()[1])
        elif line.startswith("-"):
            group = line[1:].split(":")[0]
        elif line.startswith(("+", "#")):
            label = line[line.index("{") + 1 : line.index("}")]
            if label.split(" ")[0] == node and f"u_{section}.{node}" in line:
                return flags, shift
            shift = None
    raise AssertionError(f"{name} is not in {save_file.name}: last group {group}")


def test_save_file_is_the_same_every_time(vcd, save_file, tmp_path):
    write_save_file(vcd, "paper", WIDTH, tmp_path / "again.gtkw")
    assert (tmp_path / "again.gtkw").read_bytes() == save_file.read_bytes()
    assert str(vcd.parent) not in save_file.read_text()


def test_command(vcd, save_file, tmp_path, command):
    status, out, err = command(waves.main, *map(str, (vcd, "paper", WIDTH, tmp_path / "own.gtkw")))
    assert (status, out, err) == (0, [], [])
    assert (tmp_path / "own.gtkw").read_bytes() == save_file.read_bytes()


@pytest.mark.parametrize(
    ("datapath", "content", "message"),
    [
        ("lean", None, "no ik_axis.g_lean.u_core.x in this VCD"),
        ("peper", None, "datapath: 'peper'"),
        ("paper", "x y z\n", "own.vcd: 1:2: Expected id code"),
        (
            "paper",
            "$scope module top $end\n$var wire 1 ! clk $end\n$upscope $end\n$enddefinitions $end\n",
            "no module ik_axis in this VCD",
        ),
        ("paper", "", "own.vcd: cannot be read: No such file or directory"),
    ],
)
def test_command_refuses(vcd, tmp_path, command, datapath, content, message):
    file = vcd if content is None else tmp_path / "own.vcd"
    if content:
        file.write_text(content)
    status, out, (err,) = command(waves.main, *map(str, (file, datapath, WIDTH, tmp_path / "own.gtkw")))
    assert (status, out) == (2, []) and err.startswith("waves: ") and message in err
    assert not list(tmp_path.glob("*.gtkw"))
