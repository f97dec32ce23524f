# SPDX-License-Identifier: Apache-2.0
"""Register tests of ``ik_axi`` against rtl/axi/ik_axi.rdl: every field of every register is read and written."""

import cocotb
from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiResp
from cocotbext.axi.axil_channels import AxiLiteAWTransaction, AxiLiteWTransaction
from systemrdl.node import FieldNode

from tb.axi.bench import ARM, Bench, bench_test
from tb.axi.ik_regs import FIELDS, OFFSETS, access

ALL = 0xFFFFFFFF


def mask(field: FieldNode) -> int:
    return (2 << field.high) - (1 << field.low)


def masks(register: str, kind: str) -> int:
    return sum(mask(field) for field in FIELDS[register].values() if access(field) == kind)


def after_reset(bench: Bench) -> dict[str, int]:
    """Return register name -> value after a reset. Values that depend on parameters come from the instance."""
    parameters = {name: getattr(bench, name) for name in ("width", "data_width", "addr_width", "latency", "places")}
    parameters |= {"lean": int(bench.datapath != "paper"), "fold": int(bench.datapath.startswith("fold"))}
    parameters |= {"digit": int(bench.dut.DIGIT.value), "arm": int(ARM)}
    return {
        register: sum(f.get_property("reset", default=parameters.get(name)) << f.low for name, f in fields.items())
        for register, fields in FIELDS.items()
        if register in bench.registers
    }


async def raw(bench: Bench, address: int, data: int, strobes: int, data_first: int = 0) -> AxiResp:
    """Write with any strobes. Send the data ``data_first`` clocks before the address, or after it if negative."""
    bus = bench.lite.write_if
    if data_first < 0:
        await bus.aw_channel.send(AxiLiteAWTransaction(awaddr=address, awprot=0))
        await ClockCycles(bench.dut.clk, -data_first)
    await bus.w_channel.send(AxiLiteWTransaction(wdata=data, wstrb=strobes))
    if data_first >= 0:
        await ClockCycles(bench.dut.clk, data_first)
        await bus.aw_channel.send(AxiLiteAWTransaction(awaddr=address, awprot=0))
    return AxiResp(int((await bus.b_channel.recv()).bresp))


@bench_test()
async def after_a_reset(bench):
    for register, value in after_reset(bench).items():
        got = await bench.read(register)
        assert got == value, f"{register}: {got:#x}, expected {value:#x}"


@bench_test()
async def every_field(bench):
    """Write all ones, all zeros and a random word to each register except CONTROL.

    Only the writable bits of the written register change. A write to a read-only register returns SLVERR.
    """
    values = after_reset(bench)
    for register in bench.registers:
        if register == "CONTROL":
            continue
        keeps = masks(register, "rw")
        writable = keeps | masks(register, "w1c")
        for data in (ALL, 0, bench.random.getrandbits(32)):
            answer = await bench.write(register, data)
            assert answer == (AxiResp.OKAY if writable else AxiResp.SLVERR), f"{register} written: {answer}"
            values[register] = values[register] & ~keeps | data & keeps
            for other in values if data in (ALL, 0) else (register,):
                got, value = await bench.read(other), values[other]
                assert got == value, f"{data:#x} to {register}: {other} is {got:#x}, expected {value:#x}"


@bench_test()
async def pulses(bench):
    """A job sets IRQ_STATUS.done or .error; only a 1 in the same bit clears it. CONTROL reads 0 and ignores zeros."""
    await bench.write("CONTROL", 0)
    await bench.write("CONTROL", ALL & ~masks("CONTROL", "w1"))
    assert await bench.read("CONTROL") == 0 and await bench.read("STATUS") == 0
    jobs = {"done": (0x1000, 0x2000, 0), "error": (0x1001, 0x2000, 1)}
    for name, job in jobs.items():
        field = FIELDS["IRQ_STATUS"][name]
        for enabled in (0, 7 & ~mask(field), mask(field)):
            await bench.write("IRQ_ENABLE", enabled)
            await bench.start(*job)
            status = await bench.ended(20)
            assert status[name] == 1
            await ClockCycles(bench.dut.clk, 3)
            assert await bench.read("IRQ_STATUS") == mask(field), name
            assert bench.dut.irq.value == bool(enabled & mask(field)), f"irq with {enabled:#x} enabled"
            await bench.write("IRQ_STATUS", ALL & ~mask(field))
            assert await bench.read("IRQ_STATUS") == mask(field), "cleared by a 1 in another bit"
            await bench.write("IRQ_STATUS", mask(field))
            assert await bench.read("IRQ_STATUS") == 0
            await ClockCycles(bench.dut.clk, 3)
            assert bench.dut.irq.value == 0


@bench_test()
async def strobes(bench):
    """Write with every strobe pattern to every read/write register, with address and data in any order."""
    for register in bench.registers:
        offset = OFFSETS[register]
        keeps = masks(register, "rw")
        value = await bench.read(register)
        for lanes in bench.random.sample(range(16), 16) if keeps else ():
            data = bench.random.getrandbits(32)
            answer = await raw(bench, offset, data, lanes, bench.random.choice((-5, -1, 0, 0, 1, 5)))
            assert answer == AxiResp.OKAY
            bits = sum(0xFF << 8 * k for k in range(4) if lanes >> k & 1) & keeps
            value = value & ~bits | data & bits
            got = await bench.read(register)
            assert got == value, f"{data:#x} with strobes {lanes:04b} to {register}: {got:#x}, expected {value:#x}"
    # a pulse needs the strobe of its byte
    for lanes in (0, 14):
        await raw(bench, OFFSETS["CONTROL"], 1, lanes)
    assert await bench.read("STATUS") == 0 and await bench.read("IRQ_STATUS") == 0


@bench_test()
async def queued_accesses(bench):
    """Queue writes, then reads, while no response is accepted: accesses wait for the previous ones; none is lost."""
    whole = [register for register in bench.registers if masks(register, "rw") == ALL]
    words = {register: bench.random.getrandbits(32) for register in whole}
    bench.lite.write_if.b_channel.pause = bench.lite.read_if.r_channel.pause = True
    writes = [cocotb.start_soon(bench.write(register, word)) for register, word in words.items()]
    await ClockCycles(bench.dut.clk, 20)
    bench.lite.write_if.b_channel.pause = False
    assert [await task for task in writes] == [AxiResp.OKAY] * len(whole)
    reads = [cocotb.start_soon(bench.read(register)) for register in whole]
    await ClockCycles(bench.dut.clk, 20)
    bench.lite.read_if.r_channel.pause = False
    assert [await task for task in reads] == list(words.values())


@bench_test()
async def unmapped_address(bench):
    """An access to an unmapped address returns SLVERR; a read returns 0, a write changes no register."""
    bench.stall("lite")
    mapped = {OFFSETS[register] for register in bench.registers}
    tried = {0xFFC, 0x800 + OFFSETS["COUNT"], 0x400, 0x100, 0xC8, 0x80, max(mapped) + 8, max(mapped) + 4}
    before = [await bench.read(register) for register in bench.registers]
    for address in sorted(tried - mapped, reverse=True):  # from all ones down: bits rise and fall
        assert (await bench.lite.write(address, b"\xff\xff\xff\xff")).resp == AxiResp.SLVERR, f"write to {address:#x}"
        answer = await bench.lite.read(address, 4)
        assert (answer.resp, answer.data) == (AxiResp.SLVERR, bytes(4)), f"read of {address:#x}: {answer}"
    assert [await bench.read(register) for register in bench.registers] == before
