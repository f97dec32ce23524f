# SPDX-License-Identifier: Apache-2.0
"""Write the pages of scores, latency and memory-to-memory clocks, and pictures of the pipelines: `make docs`.

Runs all trajectories through the RTL; with --memory also `ik_axi` with buses of 32, 64 and 128 bits.
"""

import json
import sys
import tempfile
from collections.abc import Iterable, Iterator
from itertools import groupby
from pathlib import Path

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.fixed import FIFO_CLOCKS
from model.dataflow.formats import Latency
from model.dataflow.nodes import Node
from model.io.scoring import model_errors
from model.io.stimuli import REGIONS, hand_poses, region
from scripts import run
from scripts.console import Options, command, sim_option, switch
from scripts.generate.flow import KINDS, WIDTH, kind, longest_path, start
from scripts.generate.render import error, render, update
from scripts.soak import hand_errors
from tb.axi.instances import run_in_process
from tb.axi.test_ik_axi import BATCH, LONG
from tb.sim.env import GENERATED

SCORES = GENERATED / "scores.md"
BUSES = (32, 64, 128)
TARGETS, ARM_WIDTHS = 4000, (32, 24, 18)  # targets of a region, word lengths of the arm

BARS = ("root", "div", "sincos", "mul", "add", "scale", "choose")
"""Kinds of operations in the order in which they are drawn."""

NAMES = {of: name for of, (name, *_) in KINDS.items()} | {"fifo": "output FIFO"}


def by_region() -> Iterator[tuple[str, ...]]:
    """Yield a row per region: its name, then three numbers for each datapath: median of hand error / reach, maximum of
    hand error / reach, largest angle error (rad)."""
    for name in REGIONS:
        errors = [model_errors(region(name, TARGETS, WIDTH, 1), WIDTH, path) for path in DATAPATHS]
        yield name, *(error(v) for hand, angle in errors for v in (np.median(hand), hand.max(), angle))


def arm_by_region(widths: Iterable[int]) -> Iterator[tuple[str, ...]]:
    """Yield a row per region: its name, then for each word length the whole arm's largest hand error / reach and
    largest orientation error (rad). Hand poses with a reach below 1 in the core's format are left out."""
    for name in (name for name in REGIONS if name != "short lengths"):
        poses = [(hand_poses(region(name, TARGETS, width, 1), width, 1), width) for width in widths]
        yield name, *(error(errors.max()) for words, width in poses for errors in hand_errors(words, width, "arm")[0])


def scores_page(scores: dict[str, list[dict]]) -> str:
    """Return scores.md. scores: datapath -> contents of its score.json, one object per trajectory."""
    named = {"lean_tolerance": f"{tolerances.LEAN[32]:.0e}", "regular_tolerance": f"{tolerances.REGULAR:.0e}"}
    regions = {"region_targets": TARGETS, "by_region": by_region(), "regions": REGIONS}
    regions |= {"arm_by_region": arm_by_region(ARM_WIDTHS), "arm_widths": ARM_WIDTHS}
    return render("scores", scores=scores, **named, **regions)


def measured(sim: str, parameters: dict[str, int], latency: int | None = None) -> list[dict]:
    """Run test `rates` of tb/axi/test_ik_axi.py at `latency` (None: all); return its rows. Raises SimulationError."""
    with tempfile.TemporaryDirectory(prefix="ik_") as folder:
        path = Path(folder) / "rates.json"
        env = {"IK_AXI_RATES": str(path), "COCOTB_TEST_FILTER": f"latency={latency or ''}" + ("$" if latency else "")}
        run_in_process("tb.axi.test_ik_axi", sim, env, parameters=parameters)
        return [json.loads(line) for line in path.read_text().splitlines()]


def lanes(nodes: Iterable[Node]) -> list[list[tuple[str, int, int, list[str]]]]:
    """Join operations of equal kind and clocks into a bar (kind, from, to, names). Return lanes of bars that do not
    overlap, with kinds in the order of ``BARS``. Selections that take no clock are wiring and are omitted."""

    def key(node: Node) -> tuple[int, int, int]:
        return BARS.index(kind(node)), start(node), node.time

    lanes: list[list] = []
    working = sorted((node for node in nodes if node.time > start(node)), key=key)
    for (of, begin, end), operations in groupby(working, key):
        bar = (BARS[of], begin, end, [node.name for node in operations])
        free = (lane for lane in lanes if all(begin >= last or end <= first for _, first, last, _ in lane))
        if (lane := next(free, None)) is None:
            lanes.append(lane := [])
        lane.append(bar)
    return lanes


def pipeline_svg(datapath: str) -> str:
    """Return pipeline-<datapath>.svg: every clock from a target's admission to its result at `ik_axis`."""
    nodes = fixed.nodes(datapath, WIDTH).values()
    ready = max(node.time for node in nodes)
    sections = {name: title for name, title in DATAPATHS[datapath].sections.items() if name != "results"}
    drawn = [(title, lanes(node for node in nodes if node.section == name)) for name, title in sections.items()]
    drawn.append(("output FIFO", [[("fifo", ready, ready + FIFO_CLOCKS, ["ik_fifo"])]]))
    used = {what for _, lanes in drawn for lane in lanes for what, *_ in lane}
    more = {"drawn": drawn, "kinds": NAMES, "used": used}
    return render("pipeline.svg", datapath=datapath, width=WIDTH, total=ready + FIFO_CLOCKS, **more)


def texts() -> dict[Path, str]:
    """Return a dict: path -> text of each file that needs no simulation."""
    paths = {name: [node for node in longest_path(fixed.nodes(name, WIDTH)) if node.latency] for name in DATAPATHS}
    used = {node.latency for nodes in paths.values() for node in nodes}
    does = {kind: text for kind, (*_, text) in Latency.TABLE.items() if kind in used}
    latency = render("latency", paths=paths, width=WIDTH, start=start, does=does, fifo=FIFO_CLOCKS)
    pictures = {GENERATED / f"pipeline-{name}.svg": pipeline_svg(name) for name in DATAPATHS}
    return {GENERATED / "latency.md": latency, **pictures}


@command(
    "generate.pages",
    [sim_option(), switch("--memory", "write memory.md too, which takes several minutes")],
    fails="a simulation or a trajectory fails",
)
def main(options: Options) -> int:
    scores = {}
    for datapath in DATAPATHS:
        with tempfile.TemporaryDirectory() as out:
            status = run.main(["--trajectory", "all", "--datapath", datapath, "--out", out, "--sim", options.sim])
            if status:
                return status
            scores[datapath] = json.loads((Path(out) / "score.json").read_text())
    update({SCORES: scores_page(scores), **texts()})
    if options.memory:
        rates = [[measured(options.sim, {"DATA_W": bus, "ARM": arm}) for bus in BUSES] for arm in (0, 1)]
        tables = [list(zip(*rows, strict=True)) for rows in rates]
        update({GENERATED / "memory.md": render("memory", tables=tables, buses=BUSES, short=BATCH, long=LONG)})
    return 0


if __name__ == "__main__":
    sys.exit(main())
