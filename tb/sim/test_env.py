# SPDX-License-Identifier: Apache-2.0
"""Tests of the environment for simulators and compilers."""

import shutil

import pytest

from tb.sim.env import ROOT, environment, simulator, verilator_root


@pytest.fixture
def program(tmp_path):
    """Return a function that writes a shell script of a given name."""

    def make(name, text):
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)

    return make


def test_environment_puts_the_packaged_verilator_first(tmp_path, program):
    program("verilator", "echo Verilator 5.006")
    base = {"PATH": f"{tmp_path}:/usr/bin", "MAKEFLAGS": " -- OUT=x", "WAVES": "1", "VERILATOR_ROOT": "/old"}
    env = environment(base)
    assert env["VERILATOR_ROOT"] == str(verilator_root())
    assert shutil.which("verilator", path=env["PATH"]) == str(verilator_root() / "bin" / "verilator")
    assert "MAKEFLAGS" not in env and "WAVES" not in env
    assert environment(env) == env
    assert base["WAVES"] == "1"


def test_compiler_cache_is_used_where_there_is_one(tmp_path, program):
    assert "OBJCACHE" not in environment({"PATH": str(tmp_path)})
    program("ccache", "exit 0")
    env = environment({"PATH": str(tmp_path)})
    assert (env["OBJCACHE"], env["CCACHE_DIR"]) == ("ccache", str(ROOT / "build" / "ccache"))
    assert environment({"PATH": str(tmp_path), "CCACHE_DIR": "mine"})["CCACHE_DIR"] == "mine"


def test_simulator_name(monkeypatch):
    monkeypatch.delenv("SIM", raising=False)
    assert simulator() == "icarus" and simulator("verilator") == "verilator"
    monkeypatch.setenv("SIM", "verilator")
    assert simulator() == "verilator" and simulator("icarus") == "icarus"
    with pytest.raises(ValueError, match="questa.*icarus or verilator"):
        simulator("questa")
