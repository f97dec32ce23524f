# SPDX-License-Identifier: Apache-2.0
"""Tests of `pip install .`: it installs the model as the package cga_ik, which runs the documentation's examples."""

import os
import re
import subprocess
import sys

import pytest

from tb.sim.env import ROOT


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder with cga_ik installed, without network access."""
    folder = tmp_path_factory.mktemp("installed")
    options = ["--no-build-isolation", "--no-deps", "--quiet", "--target", folder]
    subprocess.run([sys.executable, "-m", "pip", "install", *options, ROOT], check=True)
    return folder


def python(installed, code):
    """Run code with the package but without the checkout; return its output."""
    environment = os.environ | {"PYTHONPATH": str(installed), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, "-W", "error", "-c", code]
    ran = subprocess.run(command, cwd=installed, env=environment, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.parametrize("page", ["README.md", "docs/targets.md"])
def test_examples(installed, page):
    blocks = re.findall(r"(?:^    .*\n|^\n)+", (ROOT / page).read_text(), re.M)
    (example,) = (re.sub("^    ", "", block, flags=re.M) for block in blocks if "import" in block)
    assert "nan" not in python(installed, example)


def test_what_is_installed(installed):
    """Only the model is installed; its core needs numpy and mpmath only."""
    assert sorted(path.name for path in installed.iterdir() if "dist-info" not in path.name) == ["cga_ik"]
    assert not [path for path in installed.rglob("*") if path.name == "tests"]
    assert (installed / "cga_ik" / "py.typed").exists(), "or no type checker looks at its annotations"
    loaded = python(installed, "import sys, cga_ik; print(*{name.partition('.')[0] for name in sys.modules})").split()
    assert not {"model", "cocotb", "sympy", "kingdon", "scipy", "pybvh", "matplotlib"} & set(loaded)
    assert {"numpy", "mpmath", "cga_ik"} <= set(loaded)


def test_clips_in_the_package(installed):
    python(installed, "from cga_ik.motion import clip, gltf")
