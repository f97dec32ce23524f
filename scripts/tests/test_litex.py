# SPDX-License-Identifier: Apache-2.0
"""examples/litex: the driver on a VexRiscv gets the model's words, and its program fails for another word."""

import re
import shutil
from importlib.util import find_spec

import pytest


@pytest.mark.slow
@pytest.mark.cost(20)
@pytest.mark.skipif(
    not (find_spec("litex") and shutil.which("riscv64-unknown-elf-gcc")),
    reason="the tools of requirements/litex.lock are not installed: `make -C examples/litex`",
)
def test_every_word(tmp_path, capsys):
    from examples.litex.run import header, load, main, run

    assert main(["--targets", "5", "--width", "18", "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    found = re.findall(r"^(.+): 0 of 5 targets differ from the model; interrupts: (\d)$", printed, re.MULTILINE)
    assert found == [("polling", "0"), ("interrupt", "1")], printed
    right = header(5, 18)
    word = re.search(r"0x\w+(?=, .*0x00a50003)", right)[0]
    load(tmp_path, right.replace(word, f"0x{int(word, 16) ^ 1 << 14:08x}"))
    assert not run(tmp_path)
    assert capsys.readouterr().out.count(": 1 of 5 targets differ") == 2
