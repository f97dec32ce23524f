# SPDX-License-Identifier: Apache-2.0
"""FIFO depth against datapath latency, at every word length, as elaborated by Icarus.

A FIFO slot is reserved from a target's admission until its result leaves: T_OUT clocks, two for the FIFO, and the clock
of departure. With fewer slots the stream has gaps.
"""

import subprocess

from model.dataflow.datapaths import CONFIGURATIONS
from model.dataflow.nodes import WIDTHS
from tb.sim.env import environment
from tb.sim.seeded_bugs import Bug, copy_rtl
from tb.sim.sources import header, includes, sources

WHOLE = ("ik_axis", "ik_axi", "ik_lean", "ik_paper")
"""Modules that define T_OUT and LOG2; of the others only the header is compiled."""

PIPELINES = [path for path in CONFIGURATIONS.values() if path.period == 1]
FORMULA = "clog2(datapath_latency(DATAPATH, W, TILE) + 3)"

ONE_TOO_FEW = Bug("one place too few", "rtl/ik_axis.v", FORMULA, FORMULA.replace("+ 3", "+ 1"))


def wrong(place, root) -> list[str]:
    """Return a line for each mismatch in a copy of the RTL; `place` is a working folder."""
    lines, count = ["module top;"], 0
    for path in PIPELINES:
        core = "g_lean.u_core" if path.parameters["DATAPATH"] else "g_paper.u_core"
        for width in (w for w in path.widths if w in WIDTHS):
            values = {"W": width, **path.parameters}
            u, v, count = f"{path.name}_{width}", f"memory_{path.name}_{width}", count + 2
            lines += [
                f"ik_axis #({', '.join(f'.{k}({v})' for k, v in values.items())}) {u} ();",
                f'initial $display("{u}: T_OUT %0d, places %0d", {u}.{core}.T_OUT, 1 << {u}.LOG2,,',
                f"  {u}.{core}.T_OUT + 3 <= 1 << {u}.LOG2 && 1 << {u}.LOG2 < 2 * ({u}.{core}.T_OUT + 3));",
                f"ik_axi #({', '.join(f'.{k}({n})' for k, n in values.items())}) {v} ();",
                f'initial $display("{v}: LATENCY %0d, LOG2_PLACES %0d", {v}.LATENCY, {v}.LOG2_PLACES,,',
                f"  {v}.LATENCY == {v}.u_axis.{core}.T_OUT + 2 && {v}.LOG2_PLACES == {v}.u_axis.LOG2);",
            ]
    (place / "top.v").write_text("\n".join([*lines, "endmodule", ""]))
    files = [place / "top.v"]
    for path in sources(root):
        files.append(path)
        if path.stem not in WHOLE:
            files[-1] = place / path.name
            files[-1].write_text(header(path.read_text()))
    folders = [f"-I{folder}" for folder in includes(root)]
    build = ["iverilog", "-g2001", "-s", "top", "-o", place / "top", *folders, *files]
    subprocess.run(build, env=environment(), check=True, capture_output=True)
    done = subprocess.run(["vvp", "-n", place / "top"], env=environment(), check=True, capture_output=True, text=True)
    said = done.stdout.splitlines()
    assert len(said) == count, done.stdout
    return [line for line in said if not line.endswith(" 1")]


def test_places_are_as_many_as_clocks_and_not_twice(tmp_path):
    assert wrong(tmp_path, copy_rtl(tmp_path)) == []


def test_one_place_too_few_is_detected(tmp_path):
    assert wrong(tmp_path, copy_rtl(tmp_path, ONE_TOO_FEW)) != []
