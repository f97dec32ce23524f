# SPDX-License-Identifier: Apache-2.0
"""ik_axi as a LiteX module: AXI4-Lite registers, an AXI4 master, an interrupt.

    self.ik = IkAxi(platform, data_width=32)
    self.bus.add_slave("ik", self.ik.registers, SoCRegion(size=IkAxi.SIZE, cached=False))
    self.bus.add_master("ik", self.ik.memory)
    self.irq.add("ik")

The SoC's headers define the registers' address IK_BASE (mem.h) and the interrupt's number IK_INTERRUPT (soc.h).
ik_ev_enable_write(1) (csr.h) enables the interrupt. If the CPU caches main RAM, set `invalidate` of the C driver.
"""

from pathlib import Path

from litex.gen import ClockSignal, Instance, LiteXModule, ResetSignal
from litex.soc.interconnect.axi import AXIInterface, AXILiteInterface
from litex.soc.interconnect.csr_eventmanager import EventManager, EventSourceLevel

RTL = Path(__file__).resolve().parents[2] / "rtl"
LISTS = ("ik_axis.f", "ik_arm.f", "ik_axi.f")


class IkAxi(LiteXModule):
    """LiteX module of ik_axi. `parameters` are further parameters of rtl/ik_axi.v, such as W."""

    SIZE = 0x1000

    def __init__(self, platform, data_width=32, address_width=32, **parameters):
        self.registers = AXILiteInterface(data_width=32, address_width=32)
        self.memory = AXIInterface(data_width=data_width, address_width=address_width, id_width=1, bursting=True)
        self.ev = EventManager()
        self.ev.job = EventSourceLevel(description="A job has ended or was refused: IRQ_STATUS of the core.")
        self.ev.finalize()
        self.specials += Instance(
            "ik_axi",
            **{f"p_{name}": value for name, value in parameters.items()},
            p_DATA_W=data_width,
            p_ADDR_W=address_width,
            i_clk=ClockSignal("sys"),
            i_rst=ResetSignal("sys"),
            o_irq=self.ev.job.trigger,
            **_ports("s_axi_", self.registers, ax="addr prot", x="", slave=True),
            **_ports("m_axi_", self.memory, ax="id addr len size burst cache prot", x="id ", slave=False),
        )
        for name in LISTS:
            for line in (RTL / name).read_text(encoding="utf-8").splitlines():
                if line.startswith("+incdir+"):
                    platform.add_verilog_include_path(str(RTL / line.removeprefix("+incdir+")))
                elif line and not line.startswith("//"):
                    platform.add_source(str(RTL / line))


def _ports(prefix, bus, ax, x, slave):
    """Return the keyword arguments of Instance, port -> signal, for one AXI interface. `ax`: fields of the address
    channels; `x`: fields that precede resp in the write response channel."""
    w, r = ("data strb", "data resp") if slave else ("data strb last", "id data resp last")
    ports = {}
    for channel, fields in {"aw": ax, "w": w, "b": f"{x}resp", "ar": ax, "r": r}.items():
        to_core = slave == (channel in ("aw", "w", "ar"))
        for field in ("valid", "ready", *fields.split()):
            way = "i" if to_core != (field == "ready") else "o"
            signal = getattr(getattr(bus, channel), field)
            ports[f"{way}_{prefix}{channel}{field}"] = signal[:12] if slave and field == "addr" else signal
    return ports
