# SPDX-License-Identifier: Apache-2.0
"""Pages of scores and latency, pictures of the pipelines (make docs).

python -m scripts.generate.pages [--sim icarus|verilator]     runs all trajectories through the RTL, then writes
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

from model.bounds import tolerances
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.fixed import FIFO_CLOCKS
from model.dataflow.nodes import Latency
from model.io import trajectories
from model.io.stimuli import REGIONS
from scripts import run
from scripts.console import command, sim_option
from scripts.generate import accuracy
from scripts.generate.flow import design, longest_path, start
from scripts.generate.pipeline import pipeline_svg
from scripts.generate.render import render
from tb.sim.env import GENERATED, ROOT

SCORES = GENERATED / "scores.md"


def scores_page(scores: dict[str, list[dict]]) -> str:
    """Return scores.md. scores: datapath -> objects of its score.json."""
    return render(
        "scores",
        scores=scores,
        lean_bar=f"{tolerances.LEAN[32]:.0e}",
        regular_bar=f"{tolerances.REGULAR:.0e}",
        region_targets=accuracy.TARGETS,
        by_region=accuracy.by_region(),
        regions=REGIONS,
        described=[(name, trajectories.describe(name)) for name in trajectories.TRAJECTORIES],
    )


def latency_page() -> str:
    """Return latency.md."""
    paths = []
    for datapath, width in (("lean", 32), ("paper", 32)):
        path = [node for node in longest_path(design(datapath, width)) if node.latency]
        rows = []
        for node in path:
            begin, does = start(node, width), Latency.TABLE[node.latency][2]
            rows.append((begin, node.time, node.time - begin, f"`{node.name}`", node.equation or "-", does))
        end = path[-1].time
        rows.append((end, end + FIFO_CLOCKS, FIFO_CLOCKS, "output FIFO", "-", "memory, output register"))
        paths.append({"datapath": datapath, "width": width, "rows": rows})
    return render("latency", paths=paths)


def pages() -> dict[Path, str]:
    """Return the files that need no simulation: path -> text."""
    pictures = {GENERATED / f"pipeline-{name}.svg": pipeline_svg(name) for name in DATAPATHS}
    return {GENERATED / "latency.md": latency_page(), **pictures}


@command("generate.pages", __doc__.splitlines()[0], [sim_option()], fails="a trajectory fails")
def main(options: SimpleNamespace) -> int:
    scores = {}
    for datapath in DATAPATHS:
        with tempfile.TemporaryDirectory() as out:
            status = run.main(["--trajectory", "all", "--datapath", datapath, "--out", out, "--sim", options.sim])
            if status:
                return status
            scores[datapath] = json.loads((Path(out) / "score.json").read_text())
    files = {SCORES: scores_page(scores), **pages()}
    for path, text in files.items():
        path.write_text(text)
    print(f"wrote {', '.join(str(path.relative_to(ROOT)) for path in files)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
