# SPDX-License-Identifier: Apache-2.0
"""The paper's and the lean datapath on the same targets: clocks, operations, errors of hand and angles.

    python -m scripts.compare [--targets 4000] [--seed 1] [--check]

writes docs/generated/compare.md and its picture.  With --check everything is done anew, nothing is written, and the
page is held against it.
"""

from __future__ import annotations

import argparse
import io
import sys
from collections import Counter
from dataclasses import dataclass

import numpy as np

from model.dataflow import fixed
from model.dataflow.datapaths import DATAPATHS
from model.dataflow.nodes import WIDTHS
from model.reference.kinematics import angle_between, forward
from model.reference.lean_equations import solve_lean
from model.targets.stimuli import REGIONS, SINGULAR, at_distance, region
from model.targets.words import RESULT_FIELDS, from_words, result_values
from scripts.pages import counts
from scripts.pages.wordlengths import differing
from tb.sim.env import GENERATED, ROOT, SIMULATORS
from tb.sim.simulate import Job, simulate

PAGE = GENERATED / "compare.md"
PLOT = GENERATED / "compare.svg"

WIDTH = 32
FIFO_CLOCKS = 2
"""What the output FIFO of ``ik_axis`` adds to the latency of a datapath."""

BATCH = 100
"""Targets of a trajectory."""

LATENCY_WIDTHS = (16, 18, 24, 27, 32)
DISTANCES = tuple(10.0 ** (-k / 2) for k in range(2, 21))
AT_DISTANCE = 400
"""Targets at each distance from each singular target."""

BARS = {18: 5e-5, 24: 1e-6, 32: 2e-8}
"""Hand error / reach that the lean datapath is to stay below, over the whole reachable workspace."""

COLOURS = {"paper": "#c2410c", "lean": "#1d4ed8"}
PATHS = tuple(COLOURS)

BEYOND = "most unequal arms"
"""The region that no bar is given for: arms more unequal than 1:20."""

# -- measuring -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Errors:
    """Of some targets (N,): the hand against the target / reach, the angles of the joints against double precision
    (rad), and abs(norm^2 - 1) of the longer of both quaternions."""

    hand: np.ndarray
    shoulder: np.ndarray
    elbow: np.ndarray
    norm: np.ndarray

    @classmethod
    def of(cls, words: np.ndarray, width: int, datapath: str) -> Errors:
        """What a datapath makes of reachable targets."""
        values = result_values(fixed.run(words, width, datapath).results, width)
        asked = from_words(words, 0, width, "words")
        pose = solve_lean(asked.x, asked.y, asked.z, asked.phi, asked.d1, asked.d2)
        pose = np.column_stack([pose[name] for name in RESULT_FIELDS])
        qs, qe = values[:, :4], values[:, 4:]
        wrist = forward(qs, qe, asked.d1, asked.d2)[1]
        rest = np.zeros_like(qe)
        return cls(
            np.linalg.norm(wrist - asked.position, axis=1) / asked.reach,
            angle_between(qs, pose[:, :4]),
            angle_between(np.hstack([qe, rest]), np.hstack([pose[:, 4:], rest])),
            np.maximum(*(np.abs((q**2).sum(axis=1) - 1) for q in (qs, qe))),
        )

    @classmethod
    def together(cls, parts: list[Errors]) -> Errors:
        """Those of all targets of several."""
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in cls.__dataclass_fields__))


def operations(datapath: str) -> Counter:
    """How many operations of each kind of table 4 the dataflow makes; not what is inside of one."""
    found = sum(counts.operations(DATAPATHS[datapath].flow).values(), Counter())
    return Counter({
        "multiplications": found["mul"] + found["mul3"] + found["square"],
        "of them exact squares and products of the flags": found["exact"],
        "additions": found["additions"],
        "square roots": found["root"],
        "reciprocal square roots": found["rsqrt"],
        "divisions": found["div"],
    })  # fmt: skip


OPERATIONS = (
    "multiplications", "of them exact squares and products of the flags", "additions", "square roots",
    "reciprocal square roots", "divisions",
)  # fmt: skip


def latency(datapath: str, width: int) -> int:
    """Clocks of ``ik_axis`` from a target in to its result out, when nobody stalls."""
    bits = fixed.run(region("anywhere", 1, width, 0), width, datapath).bits
    return max(node.time for node in bits.nodes.values()) + FIFO_CLOCKS


@dataclass
class Measured:
    """Everything that the page and the picture show.

    ``same``: datapath -> region -> errors, W = 32; ``lean``: width -> region -> errors; ``near``: datapath -> singular
    target -> errors at each of ``DISTANCES``; ``clocks``: datapath -> width -> latency.
    """

    same: dict[str, dict[str, Errors]]
    lean: dict[int, dict[str, Errors]]
    near: dict[str, dict[str, list[Errors]]]
    clocks: dict[str, dict[int, int]]

    @classmethod
    def now(cls, targets: int, seed: int) -> Measured:
        """Measures."""
        lean = {
            width: {name: Errors.of(region(name, targets, width, seed), width, "lean") for name in REGIONS}
            for width in WIDTHS
        }
        paper = {name: Errors.of(region(name, targets, WIDTH, seed), WIDTH, "paper") for name in REGIONS}
        words = {
            kind: [at_distance(kind, d, AT_DISTANCE, WIDTH, seed) for d in DISTANCES] for kind in SINGULAR
        }
        near = {
            path: {kind: [Errors.of(w, WIDTH, path) for w in rows] for kind, rows in words.items()}
            for path in PATHS
        }
        clocks = {path: {width: latency(path, width) for width in LATENCY_WIDTHS} for path in PATHS}
        return cls({"paper": paper, "lean": lean[WIDTH]}, lean, near, clocks)


# -- the page --------------------------------------------------------------------------------------------------------


def _figure(value: float) -> str:
    return f"{value:.1e}"


def _row(*cells) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def _table(head: tuple, rows) -> list[str]:
    left = ["---"] + ["--:"] * (len(head) - 1)
    return [_row(*head), _row(*left), *(_row(*row) for row in rows), ""]


def _three(values: np.ndarray) -> tuple[str, str, str]:
    return _figure(np.median(values)), _figure(np.quantile(values, 0.999)), _figure(values.max())


def page(measured: Measured, targets: int, seed: int) -> str:
    """docs/generated/compare.md."""
    out = [
        "# The paper's and the lean datapath",
        "",
        f"Written by `make compare` (`python -m scripts.compare --targets {targets} --seed {seed}`); `make test` fails",
        "when it is out of date.",
        "",
        "Errors are those of the bit-true model, which the RTL equals in every bit, against the input words: the hand",
        "against the target in parts of the reach d1 + d2, angles of the joints (rad) against double precision. There",
        f"are {targets} reachable targets of each of the regions below, the same ones for both. They are a sample: a",
        "search for bad targets finds worse ones (`WORST` in `model/dataflow/tests/test_lean.py`).",
        "",
        "## Side by side",
        "",
        f"W = {WIDTH}. Clocks are those of `ik_axis`, from the schedule, and a new target starts in every clock.",
        "",
        *_table(("", *PATHS), _side_by_side(measured)),
        f"*Anywhere* is the first region below; *all but one* leaves out the {BEYOND}.",
        "",
        "Latency by word length (clocks):",
        "",
        *_table(
            ("datapath", *(f"W = {w}" for w in LATENCY_WIDTHS)),
            ((path, *clocks.values()) for path, clocks in measured.clocks.items()),
        ),
        f"## By region, W = {WIDTH}",
        "",
        *_table(
            ("region", "hand, paper: median", "99.9 %", "largest", "hand, lean: median", "99.9 %", "largest"),
            (
                (name, *_three(measured.same["paper"][name].hand), *_three(measured.same["lean"][name].hand))
                for name in REGIONS
            ),
        ),
        *_table(
            ("region", "shoulder angle, paper: 99.9 %", "largest", "lean: 99.9 %", "largest",
             "elbow angle, paper: 99.9 %", "largest", "lean: 99.9 %", "largest"),
            (
                (name, *(f for angle in ("shoulder", "elbow") for path in PATHS
                         for f in _three(getattr(measured.same[path][name], angle))[1:]))
                for name in REGIONS
            ),
        ),
        *(f"- *{name}*: {what}" for name, what in REGIONS.items()),
        "",
        "## Toward singular targets",
        "",
        "![Errors of hand and angles against the distance from singular targets](compare.svg)",
        "",
        f"W = {WIDTH}, {AT_DISTANCE} targets at each distance: the angle to the z axis (rad); what the reach, or the "
        "folded",
        "arm, leaves of the distance from the shoulder, and that distance itself, in parts of the reach. A median of 0",
        "is drawn at 1e-11. Largest error of the shoulder's angle (rad):",
        "",
        *_growth(measured, "shoulder"),
        "and of the elbow's:",
        "",
        *_growth(measured, "elbow"),
        *_conclusion(measured),
        "",
        "## The lean datapath by word length",
        "",
        "All regions together. An ulp is the last place of a result, 2^(2 - W). *Norm*: abs(norm^2 - 1) of the worse",
        "quaternion.",
        "",
        *_table(
            ("W", "hand: median", "99.9 %", "largest", "ulps", "bar", "shoulder angle: largest", "elbow angle: largest",
             "norm: largest (ulps)"),
            _by_width(measured),
        ),
        "Largest hand error by region:",
        "",
        *_table(
            ("region", *(f"W = {w}" for w in LATENCY_WIDTHS)),
            ((name, *(_figure(measured.lean[w][name].hand.max()) for w in LATENCY_WIDTHS)) for name in REGIONS),
        ),
    ]  # fmt: skip
    return "\n".join(out).rstrip("\n") + "\n"


def _side_by_side(measured: Measured):
    clocks = [measured.clocks[path][WIDTH] for path in PATHS]
    yield "latency (clocks)", *clocks
    yield f"clocks for {BATCH} targets", *(c + BATCH for c in clocks)
    both = [operations(path) for path in PATHS]
    for kind in OPERATIONS:
        yield kind, *(of_it[kind] for of_it in both)
    anywhere = {path: parts["anywhere"] for path, parts in measured.same.items()}
    everywhere = {
        path: Errors.together([errors for name, errors in parts.items() if name != BEYOND])
        for path, parts in measured.same.items()
    }
    for what, source in (("anywhere", anywhere), ("all regions but one", everywhere)):
        for name, label in (("hand", "hand error"), ("shoulder", "shoulder angle"), ("elbow", "elbow angle")):
            three = [_three(getattr(source[path], name)) for path in PATHS]
            yield f"{label}, {what}: median, 99.9 %, largest", *(", ".join(t) for t in three)


def _growth(measured: Measured, name: str) -> list[str]:
    head = ("distance", *(f"{kind}, {path}" for kind in SINGULAR for path in PATHS))
    rows = (
        (f"1e{round(np.log10(d))}", *(
            _figure(getattr(measured.near[path][kind][n], name).max()) for kind in SINGULAR for path in PATHS
        ))
        for n, d in enumerate(DISTANCES) if n % 2 == 0
    )  # fmt: skip
    return _table(head, rows)


def _conclusion(measured: Measured) -> list[str]:
    """Where the angles are within 1e-7 rad."""
    worst = {
        path: [max(max(getattr(measured.near[path][kind][n], a).max() for a in ("shoulder", "elbow"))
                   for kind in SINGULAR) for n in range(len(DISTANCES))]
        for path in PATHS
    }  # fmt: skip
    lean = max(worst["lean"])
    return [
        f"The lean datapath's angles are within {_figure(lean)} rad at every distance: its error does not grow. What",
        "does is the angle that an lsb of the input word stands for, such as an lsb over the distance from the z axis.",
        f"The paper's largest error is {_figure(worst['paper'][0])} rad at a distance of {_figure(DISTANCES[0])} and "
        f"{_figure(max(worst['paper']))} rad at the worst.",
    ]


def _by_width(measured: Measured):
    for width, regions in measured.lean.items():
        e = Errors.together(list(regions.values()))
        ulp = 2.0 ** (2 - width)
        yield (
            width, *_three(e.hand), f"{e.hand.max() / ulp:.1f}", f"{BARS[width]:.0e}" if width in BARS else "",
            _figure(e.shoulder.max()), _figure(e.elbow.max()), f"{e.norm.max() / ulp:.1f}",
        )  # fmt: skip


# -- the picture -----------------------------------------------------------------------------------------------------


def plot(near: dict[str, dict[str, list[Errors]]], form: str = "svg") -> bytes:
    """Errors against distance: a row an error, a column a singular target, a colour a datapath."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    titles = {
        "the z axis": "angle to the z axis (rad)", "full stretch": "to full stretch / reach",
        "full fold": "to full fold / reach", "the shoulder": "to the shoulder / reach",
    }  # fmt: skip
    rows = {
        "shoulder": "shoulder angle (rad)", "elbow": "elbow angle (rad)", "hand": "hand error / reach",
    }  # fmt: skip
    style = {"svg.hashsalt": "cga-ik", "svg.fonttype": "path", "font.family": "DejaVu Sans", "font.size": 10}
    with matplotlib.rc_context(style):
        shape = len(rows), len(SINGULAR)
        figure, grid = plt.subplots(*shape, figsize=(13, 8.6), sharex=True, sharey="row", facecolor="white")
        for axes_row, (name, label) in zip(grid, rows.items(), strict=True):
            for axes, kind in zip(axes_row, SINGULAR, strict=True):
                for path, colour in COLOURS.items():
                    values = [getattr(e, name) for e in near[path][kind]]
                    axes.plot(DISTANCES, [v.max() for v in values], color=colour, label=f"{path}, largest")
                    middle = [np.maximum(np.median(v), 1e-11) for v in values]
                    axes.plot(DISTANCES, middle, color=colour, linestyle=":", label=f"{path}, median")
                bar = BARS[WIDTH] if name == "hand" else 1e-7
                axes.axhline(bar, color="#666", linestyle="--", linewidth=1, label="lean's bar: 1e-7 rad, 2e-8")
                axes.set(xscale="log", yscale="log")
                axes.grid(True, which="major", color="#ddd")
                axes.spines[["top", "right"]].set_visible(False)
            axes_row[0].set_ylabel(label)
        for axes, kind in zip(grid[-1], SINGULAR, strict=True):
            axes.set_xlabel(titles[kind])
        grid[0, 0].set_xlim(min(DISTANCES), max(DISTANCES))
        figure.suptitle(f"Errors toward singular targets, W = {WIDTH}")
        lines = grid[0, 0].get_legend_handles_labels()
        figure.legend(*lines, loc="upper center", bbox_to_anchor=(0.5, 0.965), ncols=5, frameon=False)
        figure.tight_layout(rect=(0, 0, 1, 0.96))
        out = io.BytesIO()
        figure.savefig(out, format=form, metadata={"Date": None, "Creator": None} if form == "svg" else {}, dpi=110)
        plt.close(figure)
    return out.getvalue()


def simulated(width: int) -> list[str]:
    """The clocks that the RTL takes for a batch, a line a datapath.  RuntimeError where the schedule is wrong."""
    words, lines = region("anywhere", BATCH, width, 1), []
    for path in PATHS:
        (run,) = simulate([Job(path, words)], simulator=SIMULATORS[0], datapath=path, width=width)
        seen = run.latency_cycles, run.total_cycles, run.bit_mismatches
        said = latency(path, width)
        if seen != (said, said + BATCH, 0):
            raise RuntimeError(f"{path}: the RTL takes {seen}, the schedule says {(said, said + BATCH, 0)}")
        lines.append(f"{path} RTL: latency {seen[0]} clocks, {BATCH} targets in {seen[1]}, no bit unlike the model's")
    return lines


def main(arguments: list[str] | None = None) -> int:
    """The command; 0, or 1 where the page is stale."""
    parser = argparse.ArgumentParser(description="Both datapaths on the same targets: clocks, operations, errors.")
    parser.add_argument("--targets", type=int, default=4000, help="targets of a region (default: 4000)")
    parser.add_argument("--seed", type=int, default=1, help="of everything random (default: 1)")
    parser.add_argument("--check", action="store_true", help="write nothing; 1 when the page is out of date")
    options = parser.parse_args(arguments)
    if options.targets < 1 or options.seed < 0:
        parser.error("--targets is at least 1 and --seed at least 0")
    print(f"seed {options.seed}, {options.targets} targets a region", flush=True)
    measured = Measured.now(options.targets, options.seed)
    text = page(measured, options.targets, options.seed)
    if options.check:
        wrong = differing(PAGE.read_text(encoding="utf-8"), text)
        print("\n".join(wrong) if wrong else f"{PAGE.relative_to(ROOT)} is up to date", file=sys.stderr)
        return 1 if wrong else 0
    for line in simulated(WIDTH):
        print(line)
    PAGE.write_text(text, encoding="utf-8")
    PLOT.write_bytes(plot(measured.near))
    print(f"wrote {PAGE.relative_to(ROOT)} and {PLOT.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
