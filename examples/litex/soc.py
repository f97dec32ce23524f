# SPDX-License-Identifier: Apache-2.0
"""The LiteX SoC, its program and its simulator. Only this module and ik_axi.py import LiteX."""

import subprocess
from collections.abc import Sequence
from pathlib import Path

from litex import get_data_mod
from litex.build.generic_platform import Pins, Subsignal
from litex.build.sim import SimPlatform
from litex.soc.cores.cpu.vexriscv import core as vexriscv
from litex.soc.integration.builder import Builder, soc_directory
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCCore, get_mem_data
from migen.genlib.io import CRG

from examples.litex.ik_axi import IkAxi
from tb.sim.env import ROOT, environment
from tb.sim.job import SimulationError
from tb.sim.runner import COMPACT, MAKE_ARGS, runtime

HERE = ROOT / "examples" / "litex"
EQUATIONS = ROOT / "scripts" / "paper" / "table6" / "equations.c"
ROM, SRAM, MAIN_RAM = 0x10000, 0x4000, 0x4000
"""Bytes of the memories. The core reads one half of main RAM and writes the other. With few targets, the CPU's cache
still holds results of the first job when the second job ends, so the program fails without `invalidate`."""
LATEST = 20_000_000  # clocks after which the simulation gives up

PICOLIBC = (
    *("libc/string/memcpy.c", "libc/string/memset.c"),
    *("libm/common/s_rint.c", "libm/math/s_sqrt.c", "libm/common/math_err_invalid.c"),
    *("libm/common/sf_rint.c", "libm/math/sf_sqrt.c", "libm/common/math_errf_invalidf.c"),
)
"""LiteX's sources of the C functions that the program calls. Debian's compiler comes without a C library."""

UNDECLARED = "long double rintl(long double), fabsl(long double), copysignl(long double, long double);\n"
"""Declarations that <tgmath.h> needs and LiteX's <math.h> lacks."""

PADS = [
    ("sys_clk", 0, Pins(1)),
    ("serial", 0, *(Subsignal(f"{side}_{name}", Pins(8 if name == "data" else 1))
                    for side in ("source", "sink") for name in ("valid", "ready", "data"))),
]  # fmt: skip


class Soc(SoCCore):
    """SoC with a VexRiscv, ROM, RAM, a UART, a timer, and ik_axi at word length `width`, for the whole arm if `arm`."""

    def __init__(self, width: int, bus: str, arm: bool) -> None:
        platform = SimPlatform("sim", list(PADS))
        self.crg = CRG(platform.request("sys_clk"))
        SoCCore.__init__(
            self,
            platform,
            clk_freq=int(1e6),
            cpu_type="vexriscv",
            uart_name="sim",
            timer_uptime=True,
            bus_standard=bus,
            integrated_rom_size=ROM,
            integrated_rom_init=[0] * (ROM // 4),  # replaced by load()
            integrated_sram_size=SRAM,
            integrated_main_ram_size=MAIN_RAM,
        )
        platform.add_debug(self)  # sim_finish
        self.ik = IkAxi(platform, data_width=self.bus.data_width, W=width, ARM=int(arm))
        self.bus.add_slave("ik", self.ik.registers, SoCRegion(size=IkAxi.SIZE, cached=False))
        self.bus.add_master("ik", self.ik.memory)
        self.irq.add("ik")


def called(words: Sequence[str | Path], log: Path, cwd: Path | None = None) -> None:
    """Run a tool and write its output to the file `log`. Raises SimulationError if the tool fails."""
    with open(log, "w", encoding="utf-8") as stream:
        if subprocess.run(words, stdout=stream, stderr=stream, cwd=cwd, env=environment(), check=False).returncode:
            raise SimulationError(f"{words[0]} failed: see {log}")


def build(out: Path, width: int, bus: str, arm: bool, optimize: bool) -> None:
    """Write the SoC's headers and Verilog to `out`, and compile the simulator."""
    soc = Soc(width, bus, arm)
    Builder(soc, output_dir=str(out), compile_software=False).build(run=False)
    files = [source for source, *_ in soc.platform.sources if source.endswith(".v")]
    folders = [f"-I{folder}" for folder in soc.platform.verilog_include_paths]
    made = out / "model"
    words = ["verilator", "--cc", "--exe", "--build", "--prefix", "Vtop", "--top-module", "sim", "--Mdir", made]
    words += ["-Wno-lint", "-Wno-style", "-Wno-fatal", "-CFLAGS", f"-std=gnu++20 -DLATEST={LATEST}", *COMPACT]
    flags = [*MAKE_ARGS, f"OPT_FAST=-O{int(optimize)}", "-j2"]
    words += ["-MAKEFLAGS", " ".join(flags), *folders, *files, HERE / "tb.cc"]
    made.mkdir(exist_ok=True)
    with runtime(made, "native"):
        called(words, out / "verilator.log", out / "gateware")


def load(out: Path, text: str) -> None:
    """Compile main.c with `text` as targets.h, the C driver and the lean equations, and write the ROM's contents."""
    picolibc = Path(get_data_mod("software", "picolibc").data_location) / "newlib"
    folder = out / "program"
    folder.mkdir(exist_ok=True)
    (folder / "targets.h").write_text(text)
    (folder / "picolibc.h").write_text(UNDECLARED)
    cpu = Path(vexriscv.__file__).parent
    includes = [folder, out / "software/include", cpu, f"{soc_directory}/software/include", ROOT / "examples/driver"]
    includes += [picolibc / name for name in ("libc/include", "libc/tinystdio", "libm/common")]
    flags = ["-misa-spec=2.2", "-march=rv32im", "-mabi=ilp32", "-O2", "-ffunction-sections", "-fno-math-errno"]
    flags += ["-D_IEEE_LIBM", *(f"-I{path}" for path in includes)]
    gcc, log, objects = "riscv64-unknown-elf-gcc", folder / "gcc.log", []
    driver = [ROOT / "examples/driver" / name for name in ("ik.c", "ik_words.c")]
    sources = [cpu / "crt0.S", HERE / "main.c", *driver, *(picolibc / name for name in PICOLIBC)]
    for source in sources:
        objects.append(folder / f"{source.stem}.o")
        called([gcc, *flags, "-ffreestanding", "-c", source, "-o", objects[-1]], log)
    for real in ("double", "float"):
        objects.append(folder / f"{real}.o")
        kind = [f"-DREAL={real}", "-DSOLVE=lean", f"-Dbatch=batch_{real}", f"-Dchain=chain_{real}"]
        called([gcc, *flags, *kind, "-c", EQUATIONS, "-o", objects[-1]], log)
    script = ["-nostdlib", "-Wl,--gc-sections", "-T", f"{soc_directory}/software/bios/linker.ld"]
    called([gcc, *flags, *objects, *script, f"-L{out / 'software/include'}", "-lgcc", "-o", folder / "main.elf"], log)
    called(["riscv64-unknown-elf-objcopy", "-O", "binary", folder / "main.elf", folder / "main.bin"], log)
    words = get_mem_data(str(folder / "main.bin"), data_width=32, endianness="little")
    (out / "gateware" / "sim_rom.init").write_text("".join(f"{word:08x}\n" for word in words))
