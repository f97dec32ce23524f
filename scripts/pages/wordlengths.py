# SPDX-License-Identifier: Apache-2.0
"""Word lengths (section 4.3 of the paper): proved and observed ranges, errors, and what each node costs the hand.

    python -m scripts.pages.wordlengths [--targets 1000000] [--seed 1]

writes docs/generated/wordlengths.md and its picture.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from model.bounds import affine, predict, ranges
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.annotations import Rule
from model.dataflow.nodes import WIDTHS, FormatError, Node
from model.dataflow.reals import Real
from model.io.monte_carlo import (
    REACH,
    Observed,
    default_arm,
    hand_errors,
    monte_carlo,
    regular_poses,
    shown,
    words_of,
)
from model.io.words import DEFAULT_D1, DEFAULT_D2
from scripts.console import Parser, command, progress
from scripts.pages.render import error, render, svg
from scripts.pages.tables import table
from tb.sim.env import GENERATED

PAGE = GENERATED / "wordlengths.md"
PLOT = GENERATED / "wordlengths.svg"

WIDTH = 32
AIM = 1e-6
"""Hand error / reach that is aimed at in regular poses."""

REGULAR_POSES = 20000
SENSITIVITY_POSES = 1000
DOMINATING = 12


# -- the hand --------------------------------------------------------------------------------------------------------


def sensitivities(width: int, seed: int, count: int) -> dict[str, np.ndarray]:
    """How far one ulp of each rounded node moves the hand, as a part of the reach, at regular poses (count,)."""
    words = words_of(regular_poses(count, seed), width)
    bits = fixed.run(words, width).bits
    length = 2.0 ** (2 - width)
    d1, d2 = words[:, 4] * length, words[:, 5] * length

    def hand(name: str, move: float) -> np.ndarray:
        return Real(bits, {name: np.full(len(words), move)}).hand(d1, d2)

    return {
        node.name: np.linalg.norm(hand(node.name, 0.5) - hand(node.name, -0.5), axis=1) / (d1 + d2)
        for node in predict.rounded_nodes(bits)
    }


def affine_errors(width: int, seed: int, count: int) -> dict[str, float]:
    """How far affine arithmetic lets a node be from exact arithmetic, in ulps: the worst of regular poses."""
    forms = affine.Affine(fixed.run(words_of(regular_poses(count, seed), width), width).bits)
    measured = (n for n, node in forms.nodes.items() if node.section != "guard" and isinstance(node.value, affine.Form))
    return {name: float(forms.error_ulps(name).max()) for name in measured if name in forms.exact}


def spare_bits(moved: dict[str, np.ndarray], nodes: dict[str, Node]) -> dict[str, tuple[float, float]]:
    """How many bits a node could lose (median and worst pose) if each of them may take an equal part of the aim."""
    part = AIM / len(moved)
    spare = {}
    for name, effect in moved.items():
        rounding = max(map(abs, nodes[name].error)) * np.maximum(effect, 1e-30)
        spare[name] = float(np.log2(part / np.median(rounding))), float(np.log2(part / rounding.max()))
    return spare


def shares(moved: dict[str, np.ndarray], nodes: dict[str, Node]) -> dict[str, float]:
    """Part of each node in the predicted mean squared hand error, averaged over poses; largest first."""
    variance = {n: (e * (nodes[n].error[1] - nodes[n].error[0])) ** 2 / 12 for n, e in moved.items()}
    total = sum(variance.values())
    part = {name: float(np.mean(v / total)) for name, v in variance.items()}
    return dict(sorted(part.items(), key=lambda item: (-item[1], item[0])))


def curve(seed: int, count: int, step=lambda done: None) -> dict[int, tuple[float, ...]]:
    """Word length -> hand error at regular poses: median, 99 %, largest; the bounds proved: median, largest; and the
    first three of the default arm."""
    poses, own = regular_poses(count, seed), regular_poses(count, seed, default_arm())
    result = {}
    for width in WIDTHS:
        bound = affine.hand_bound(words_of(poses, width), width)
        all_arms, default = (
            (np.median(error), np.quantile(error, 0.99), error.max())
            for error in (hand_errors(width, poses), hand_errors(width, own))
        )
        result[width] = tuple(map(float, (*all_arms, np.median(bound), bound.max(), *default)))
        step(len(result))
    return result


# -- the page --------------------------------------------------------------------------------------------------------


def _bounds(low: float, high: float) -> str:
    return f"{low:.6g} .. {high:.6g}"


def analytic_cells(width: int = WIDTH) -> dict[str, list[str]]:
    """Node -> equation, range proved, rule, format, bits wasted, largest error proved in ulps."""
    table = ranges.proved(width)
    fails = ranges.failures(width)
    cells = {}
    for name in shown({n: p.node for n, p in table.items()}):
        proof = table[name]
        fmt = proof.node.format
        kind = f"{'s' if fmt.signed else 'u'}{fmt.width}.{fmt.frac}"
        rules = "; ".join(proof.rules) or "interval"
        if name in fails:
            rules += "; **does not fit**"
        error = "-" if proof.node.facts.limited else f"{proof.error_ulps:.2g}"
        equation = proof.node.equation or "-"
        low, high = proof.low + 0.0, proof.high + 0.0
        cells[name] = [equation, _bounds(low, high), rules.replace("|", "\\|"), kind, str(proof.bits_wasted), error]
    return cells


def page(measured: Measured, targets: int, seed: int) -> str:
    """docs/generated/wordlengths.md."""
    proofs, observed = ranges.proved(WIDTH), measured.observed
    nodes = {name: proof.node for name, proof in proofs.items()}
    words = {name: proof for name, proof in proofs.items() if proof.node.format.width > 1}
    wasted = [name for name, proof in words.items() if proof.bits_wasted]
    failures = ranges.failures(WIDTH)
    return render(
        "wordlengths",
        width=WIDTH,
        widths=WIDTHS,
        targets=targets,
        seed=seed,
        observed=observed,
        wasted=wasted,
        table_size=len(words),
        bits_wasted=sum(words[n].bits_wasted for n in wasted),
        names=textwrap.fill(f"{', '.join(f'`{n}`' for n in wasted)}.", 115),
        failures=failures,
        unfit=list(dict.fromkeys([*failures, *observed.beyond])),
        regular_poses=REGULAR_POSES,
        regular_distance=REGULAR_DISTANCE,
        sensitivity_poses=SENSITIVITY_POSES,
        aim=AIM,
        errors=measured.errors,
        reach=REACH,
        default_arm=default_arm(),
        default_reach=DEFAULT_D1 + DEFAULT_D2,
        figure=lambda value: error(value) if np.isfinite(value) else "none",
        dominating=list(shares(measured.moved, nodes).items())[:DOMINATING],
        nodes=nodes,
        all_nodes=_all_nodes(measured, nodes),
        **rules(),
    )


def _all_nodes(measured: Measured, nodes: dict[str, Node]):
    spare = spare_bits(measured.moved, nodes)
    for name, cells in analytic_cells().items():
        seen, ulp = measured.observed.nodes[name], nodes[name].format.ulp
        affine_error = f"{measured.proved_errors[name]:.2g}" if name in measured.proved_errors else "-"
        errors = [f"{seen.rms:.2g}", f"{seen.worst:.2g}"] if seen.count else ["-", "-"]
        bits = ", ".join("any" if b > 60 else f"{b:.1f}" for b in spare[name]) if name in spare else "-"
        yield name, *cells, affine_error, _bounds(seen.low * ulp, seen.high * ulp), *errors, bits


def rules() -> dict:
    """For the last section of the page: the rules, each once and with its nodes, and what is limited on purpose."""
    facts = {name: proof.node.facts for name, proof in ranges.proved(WIDTH).items()}
    stated: dict[tuple[str, str], list[str]] = {}
    for name, of in facts.items():
        if isinstance(of.within, Rule):
            stated.setdefault((of.within.name, of.within.why), []).append(name)
    names = [rule for rule, _ in stated]
    together = sorted(stated.items(), key=lambda item: names.index(item[0][0]))  # by name
    return {
        "rules": [(name, nodes, why) for (name, why), nodes in together],
        "limited": {name: of.limited.why for name, of in facts.items() if of.limited},
    }


@svg
def plot(plt, errors: dict[int, tuple[float, ...]], parts: dict[str, float]):
    """The picture: hand error against word length, and the dominating nodes."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), width_ratios=(1.25, 1), facecolor="white")
    widths = list(errors)
    for k, (label, colour, mark) in enumerate(
        (
            ("median", "#1d4ed8", "o"), ("99 % of the poses", "#15803d", "s"), ("largest", "#c2410c", "^"),
            ("proved, median", "#94a3b8", ""), ("proved, largest", "#111827", ""),
        )
    ):  # fmt: skip
        left.plot(widths, [e[k] for e in errors.values()], color=colour, marker=mark, markersize=4, label=label)
    left.axhline(1e-4, color="#666", linestyle="--", linewidth=1)
    place = {"transform": left.get_yaxis_transform(), "color": "#444", "fontsize": 9}
    left.text(0.95, 1.15e-4, "the bar, 1e-4 (1/16 mm on 0.6 m)", ha="right", va="bottom", **place)
    left.axhline(AIM, color="#666", linestyle=":", linewidth=1)
    left.text(0.05, AIM * 0.87, "the aim, 1e-6", ha="left", va="top", **place)
    left.set(
        yscale="log", xlabel="word length W (bits)", ylabel="hand error / reach (d1 + d2), no unit",
        title="Hand error at regular poses", xticks=widths[::2],
    )  # fmt: skip
    left.grid(True, which="major", color="#ddd")
    left.legend(frameon=False)
    top = list(parts.items())[:DOMINATING][::-1]
    bars = right.barh([n for n, _ in top], [100 * v for _, v in top], color="#1d4ed8")
    right.bar_label(bars, fmt="%.1f", padding=3, fontsize=9)
    right.set(xlabel="part of the mean squared hand error (%)", title=f"Nodes that dominate, W = {WIDTH}")
    right.margins(x=0.15)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    return figure


# -- checking the page -----------------------------------------------------------------------------------------------


def stale(text: str) -> list[str]:
    """What of the page's proofs is out of date: one line a node."""
    found, fresh = {row[0]: row[1:] for row in table(text.split("## All nodes")[1], "node")}, analytic_cells()
    if not text.endswith(render("rules", **rules())):
        return ["the rules are not those of model/dataflow/paper.py"]
    wrong = [f"{name}: not in the table, or no longer a node" for name in sorted(set(found) ^ set(fresh))]
    for name in found.keys() & fresh.keys():
        cells = found[name][: len(fresh[name])]
        if cells != fresh[name]:
            wrong.append(f"{name}: the table has {cells}, the proof {fresh[name]}")
    return wrong


@dataclass
class Measured:
    """Everything that the page and the picture show besides the proofs."""

    observed: Observed
    errors: dict[int, tuple[float, ...]]
    moved: dict[str, np.ndarray]
    proved_errors: dict[str, float]

    @classmethod
    def now(cls, targets: int, seed: int) -> Measured:
        """Measures, with progress on a terminal."""
        with progress("random targets", targets) as meter:
            observed = monte_carlo(targets, WIDTH, seed, meter)
        with progress("word lengths", len(WIDTHS)) as meter:
            errors = curve(seed, REGULAR_POSES, meter)
        moved = sensitivities(WIDTH, seed, SENSITIVITY_POSES)
        return cls(observed, errors, moved, affine_errors(WIDTH, seed, SENSITIVITY_POSES))


@command("wordlengths")
def main(arguments: Sequence[str] | None) -> int:
    about = "Word lengths: ranges proved and seen, errors, plots."
    parser = Parser("pages.wordlengths", about, fails="a node does not fit")
    options = parser.sample(1_000_000, "random targets").parse_args(arguments)
    status = 0
    for width in WIDTHS:
        try:
            ranges.check(width)
        except (ranges.RangeError, FormatError) as problem:
            print(problem, file=sys.stderr)
            if isinstance(problem, FormatError):  # nothing can be run
                return 1
            status = 1
    print(f"seed {options.seed}, {options.targets} targets, W = {WIDTH}", flush=True)
    measured = Measured.now(options.targets, options.seed)
    proofs, observed = ranges.proved(WIDTH), measured.observed
    PAGE.write_text(page(measured, options.targets, options.seed), encoding="utf-8")
    PLOT.write_bytes(plot(measured.errors, shares(measured.moved, {n: p.node for n, p in proofs.items()})))
    print(f"wrote {PAGE.name} and {PLOT.name}")
    for name in observed.beyond:
        print(f"{name}: beyond its format for {observed.beyond[name]} targets, first {observed.first[name]}")
        status = 1
    for name, seen in observed.nodes.items():
        proof, ulp = proofs[name], proofs[name].node.format.ulp
        if seen.low * ulp < proof.low or seen.high * ulp > proof.high:
            print(f"{name}: seen outside its proved range", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
