# SPDX-License-Identifier: Apache-2.0
"""Power-up test of ``ik_axis`` and ``ik_axi``: valid and irq are low before the first clock, and ready under reset."""

import cocotb
from cocotb.triggers import Timer

ALWAYS_READY = ("m_axi_rready", "m_axi_bready")

DRIVEN = {"s_axis_tvalid", "m_axis_tready", *(f"s_axi_{c}valid" for c in ("aw", "w", "ar")), "s_axi_bready"}
DRIVEN |= {"s_axi_rready", "m_axi_rvalid", "m_axi_bvalid", *(f"m_axi_{c}ready" for c in ("aw", "w", "ar"))}
"""Inputs of the core."""


@cocotb.test()
async def power_up(dut):
    names = [handle._name for handle in dut if handle._name.islower()]
    ports = [name for name in names if name[:3] in ("s_a", "m_a") or name == "irq"]
    offers = [name for name in ports if name.endswith("valid") or name == "irq"]
    takes = [name for name in ports if name.endswith("ready") and name not in ALWAYS_READY]
    assert set(offers) - DRIVEN and set(takes) - DRIVEN
    if dut.clk.value == 1:
        return  # the initial clock level is random, and Verilator treats 1 as the first edge
    for name in set(ports) & DRIVEN:
        getattr(dut, name).value = 0
    dut.clk.value = 0
    await Timer(1, unit="ns")
    for name in set(offers) - DRIVEN:
        assert getattr(dut, name).value == 0, f"{name} before the first clock"
    dut.rst.value = 1
    await Timer(1, unit="ns")
    for name in {*offers, *takes} - DRIVEN:
        assert getattr(dut, name).value == 0, f"{name} under reset, before the first clock"
