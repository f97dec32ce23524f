# SPDX-License-Identifier: Apache-2.0
"""Write an HTML page that runs the core's Verilog (`make playground`).

    python -m scripts.playground [--out DIR] [--datapath NAME[,NAME]] [--width BITS]

Compiles the cores to WebAssembly (scripts/playground/machines.py). This takes a few minutes the first time; the result
is cached in build/playground. Writes OUT/index.html, a self-contained page that opens from disk without network. It
shares the 3D view (arm.js) and the style sheet with the report.
"""

import base64
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from model.io import trajectories
from model.io.files import write_atomically
from model.io.flags import FLAGS
from model.io.words import DEFAULT_D1, DEFAULT_D2, FIELDS, HEADROOM_BITS
from model.motion.arms import ROBOTS, Arm
from model.motion.pose import NAMED_AXES, hanging, to_z
from model.reference.joints import centred
from model.reference.kinematics import conjugate, matrix
from scripts.console import WORD_LENGTH, command, option, output, some_of
from scripts.generate.render import TEMPLATES
from scripts.playground.machines import NAMES, Machine, chosen, table, tools, wasm

HERE = Path(__file__).parent
REPORT = HERE.parent / "report"
SCRIPTS = ("machine", "solve", "lane", "waves", "hand", "playground")

HAND = (0.0, 0.5**0.5, 0.0, 0.5**0.5)  # of the hand: z axis forward, x axis up
ARMS = {"arm": Arm(DEFAULT_D1, DEFAULT_D2, names=[f"th{n}" for n in range(1, 8)])}
ARMS |= {name: ROBOTS[name] for name in ("iiwa14", "human")}


def _robot(name: str, arm: Arm) -> dict[str, Any]:
    """Return the page's data of an arm whose tool is along the tip's z axis, with a target that its limits allow."""
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
    """Return the page's data, except the WebAssembly of the cores."""
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
    "Write a page that runs the Verilog in a browser.",
    [
        option("--out", "folder for index.html", Path, default="build/playground", metavar="DIR"),
        option("--datapath", f"some of {', '.join(NAMES)}", some_of(NAMES, len(NAMES)), metavar="NAME[,NAME]"),
        option("--width", "word length of the cores", WORD_LENGTH, metavar="BITS"),
    ],
    passes="the page is written",
    fails="a tool failed",
)
def main(parsed: SimpleNamespace) -> int:
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
