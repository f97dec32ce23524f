# SPDX-License-Identifier: Apache-2.0
"""C header, Python constants, page and RTL agree with the register description."""

import re

from scripts.generate import registers


def test_files_are_up_to_date():
    stale = [str(path.relative_to(registers.ROOT)) for path in registers.stale()]
    assert not stale, f"run `python -m scripts.generate.registers`: out of date are {stale}"


def test_a_changed_description_is_found(tmp_path):
    changed = tmp_path / "ik_axi.rdl"
    changed.write_text(registers.SOURCE.read_text().replace("COUNT @ 0x1c", "COUNT @ 0x48"))
    assert registers.stale(changed) == list(registers.FILES)


def test_the_rtl_has_these_registers_and_no_other():
    """Names and offsets of the RTL localparams match; simulations test the behaviour."""
    text = (registers.SOURCE.parent / "ik_axi_regs.v").read_text()
    found = {name: 4 * int(word) for name, word in re.findall(r"\bA_(\w+) = (\d+)", text)}
    assert found == {register.name: register.offset for register in registers.description()["registers"]}
