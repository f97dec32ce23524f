# SPDX-License-Identifier: Apache-2.0
"""Word lengths (section 4.3 of the paper): proved and observed ranges, errors, and what each node costs the hand.

    python -m scripts.pages.wordlengths [--targets 1000000] [--seed 1] [--check]

writes docs/generated/wordlengths.md and its picture.  With --check everything is done anew, nothing is written, and
the page is held against it.
"""

from __future__ import annotations

import argparse
import io
import re
import sys
import textwrap
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TimeElapsedColumn

from model.bounds import affine, predict, ranges
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.facts import Rule
from model.dataflow.nodes import WIDTHS, FormatError, Node
from model.dataflow.reals import Real
from model.targets.observed import Observed, hand_errors, monte_carlo, regular_poses, shown, words_of
from tb.sim.env import GENERATED, ROOT

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
    """Word length -> hand error at regular poses: median, 99 %, largest; and the bounds proved: median, largest."""
    poses = regular_poses(count, seed)
    result = {}
    for width in WIDTHS:
        error = hand_errors(width, poses)
        bound = affine.hand_bound(words_of(poses, width), width)
        figures = np.median(error), np.quantile(error, 0.99), error.max(), np.median(bound), bound.max()
        result[width] = tuple(map(float, figures))
        step(len(result))
    return result


# -- the page --------------------------------------------------------------------------------------------------------


def _bounds(low: float, high: float) -> str:
    return f"{low:.6g} .. {high:.6g}"


def _figure(value: float) -> str:
    return f"{value:.1e}" if np.isfinite(value) else "none"


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


def page(width, targets, seed, observed: Observed, moved, errors, proved_errors) -> str:
    """docs/generated/wordlengths.md."""
    table = ranges.proved(width)
    nodes = {name: proof.node for name, proof in table.items()}
    spare = spare_bits(moved, nodes)
    command = f"python -m scripts.pages.wordlengths --targets {targets} --seed {seed}"
    out = [
        "# Word lengths",
        "",
        f"Written by `make wordlengths` (`{command}`); `make test` fails when it is out of date.",
        "",
        f"Analytic and empiric, as in section 4.3 of the paper, for W = {width}. Proofs:",
        "`model/bounds/ranges.py`, over every",
        "input word, reachable or not. Observations: "
        f"{observed.targets} random targets (seed {seed}), an eighth of them out of reach and an",
        "eighth at the edges of formats, through the bit-true model and through double precision.",
        f"`make wordlengths` does the proofs for all of W = {WIDTHS[0]} to {WIDTHS[-1]} and fails, naming the node, "
        "where one does not fit.",
        "",
        *_summary(width, observed),
        "",
        "## Hand error against word length",
        "",
        "![Hand error against word length, and the nodes that dominate it](wordlengths.svg)",
        "",
        f"Distance of the hand from the target / (d1 + d2), {REGULAR_POSES} poses at least {REGULAR_DISTANCE} rad off "
        "every singular pose.",
        "*Proved*: affine arithmetic at each of the poses, one symbol a rounding (`model/bounds/affine.py`): no",
        "roundings of",
        "this size can move the hand further.",
        "",
        "| W | median | 99 % | largest | proved, median | proved, largest |",
        "| --- | --- | --- | --- | --- | --- |",
        *(f"| {w} | {' | '.join(_figure(v) for v in row)} |" for w, row in errors.items()),
        "",
        f"The nodes whose rounding costs the hand most (part of the predicted mean squared error, W = {width}):",
        "",
        "| node | equation | part |",
        "| --- | --- | --- |",
    ]
    for name, part in list(shares(moved, nodes).items())[:DOMINATING]:
        out.append(f"| {name} | {nodes[name].equation or '-'} | {100 * part:.1f} % |")
    out += [
        "",
        "## All nodes",
        "",
        "One-bit decisions are left out.",
        "",
        "- *format*: s or u (unsigned), bits, fraction bits; *wasted*: leading bits that no input sets;",
        "- *error proved*: how far, in ulps, rounding can have taken the word from exact arithmetic on the input",
        "  words, at the worst of all inputs, by intervals. The words of `pi_swivel`, `c4_quo` and of shifted vectors",
        "  start anew at 0, because what follows holds for any of them;",
        f"- *affine*: the same by affine arithmetic, nothing started anew, at the worst of {SENSITIVITY_POSES} regular "
        "poses.",
        "  For ranges affine forms are tried too, in `make test`: with operands that have either sign they narrow no",
        "  interval of this table;",
        "- *rms*, *largest*: the error seen against double precision, in ulps, over the",
        f"  {observed.regular} targets in regular poses;",
        "- *spare*: how many bits the node could lose if each rounded node may take an equal part of the aim, a hand",
        f"  error of {AIM:g} at regular poses: in the median pose, and in the worst of {SENSITIVITY_POSES}. Negative:",
        "  bits missing; any: the hand does not feel it; a dash: the node does not round.",
        "",
        "| node | equation | range proved | by | format | wasted | error proved | affine | range seen | rms | largest "
        "| spare |",
        f"|{' --- |' * 12}",
    ]
    for name, cells in analytic_cells(width).items():
        seen = observed.nodes[name]
        ulp = nodes[name].format.ulp
        error = [f"{seen.rms:.2g}", f"{seen.worst:.2g}"] if seen.count else ["-", "-"]
        bits = ", ".join("any" if b > 60 else f"{b:.1f}" for b in spare[name]) if name in spare else "-"
        affine_error = f"{proved_errors[name]:.2g}" if name in proved_errors else "-"
        cells = [*cells, affine_error, _bounds(seen.low * ulp, seen.high * ulp), *error, bits]
        out.append(f"| {' | '.join([name, *cells])} |")
    out += ["", *rules()]
    return "\n".join(out) + "\n"


def rules() -> list[str]:
    """The last section of the page."""
    facts = {name: proof.node.facts for name, proof in ranges.proved(WIDTH).items()}
    stated: dict[tuple[str, str], list[str]] = {}
    for name, of in facts.items():
        if isinstance(of.within, Rule):
            stated.setdefault((of.within.name, of.within.why), []).append(f"`{name}`")
    names = [rule for rule, _ in stated]
    together = sorted(stated.items(), key=lambda item: names.index(item[0][0]))  # what refers to one another
    out = ["## The rules", ""]
    out += [f"- **{rule}** ({', '.join(nodes)}): {why}." for (rule, why), nodes in together]
    return out + [f"- **saturates by design** (`{n}`): {of.limited.why}." for n, of in facts.items() if of.limited]


def _summary(width: int, observed: Observed) -> list[str]:
    table = {name: proof for name, proof in ranges.proved(width).items() if proof.node.format.width > 1}
    wasted = [name for name, proof in table.items() if proof.bits_wasted]
    start = [
        f"{len(wasted)} of {len(table)} nodes have leading bits that no input sets, "
        f"{sum(table[n].bits_wasted for n in wasted)} bits together:",
        *textwrap.wrap(f"{', '.join(f'`{n}`' for n in wasted)}.", 115),
        "",
    ]
    found = ranges.failures(width)
    if not found and not observed.beyond:
        return [*start, "Every node fits its format, and none was seen beyond it."]
    out = [*start, "Nodes that do not fit (their targets are counted here and left out of all that follows):", ""]
    for name in dict.fromkeys([*found, *observed.beyond]):
        out.append(f"- `{name}`: {found.get(name, 'proved to fit')}.")
        if name in observed.beyond:
            out[-1] += (
                f" Seen for {observed.beyond[name]} targets, first words x, y, z, phi, d1, d2 = "
                f"{', '.join(map(str, observed.first[name]))}."
            )
        else:
            out[-1] += " Proved only, not seen in this run."
    return out


def plot(errors: dict[int, tuple[float, ...]], parts: dict[str, float], form: str = "svg") -> bytes:
    """The picture: hand error against word length, and the dominating nodes."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    style = {"svg.hashsalt": "cga-ik", "svg.fonttype": "path", "font.family": "DejaVu Sans", "font.size": 10}
    with matplotlib.rc_context(style):
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
        out = io.BytesIO()
        figure.savefig(out, format=form, metadata={"Date": None, "Creator": None} if form == "svg" else {}, dpi=110)
        plt.close(figure)
    return out.getvalue()


# -- checking the page -----------------------------------------------------------------------------------------------


def read_table(text: str) -> dict[str, list[str]]:
    """Node -> cells of the table of all nodes."""
    lines = text.split("## All nodes")[1].split("## The rules")[0].splitlines()
    rows = [line.replace("\\|", "\0")[2:-2].split(" | ") for line in lines if line.startswith("| ")]
    return {row[0]: [cell.replace("\0", "\\|") for cell in row[1:]] for row in rows[2:]}


def stale(text: str) -> list[str]:
    """What of the page's proofs is out of date: one line a node."""
    table, fresh = read_table(text), analytic_cells()
    if not text.endswith("\n".join(rules()) + "\n"):
        return ["the rules are not those of model/dataflow/paper.py"]
    wrong = [f"{name}: not in the table, or no longer a node" for name in sorted(set(table) ^ set(fresh))]
    for name, cells in fresh.items():
        if name in table and table[name][: len(cells)] != cells:
            wrong.append(f"{name}: the table has {table[name][: len(cells)]}, the proof {cells}")
    return wrong


NUMBER = re.compile(r"-?\b\d+\.?\d*(?:e[-+]?\d+)?\b")
SAME_FIGURE = 0.06
"""A figure of two digits may be rounded the other way where a processor's sines differ in the last place."""


def differing(text: str, fresh: str) -> list[str]:
    """The lines of the page that differ from those made anew, figures compared to two digits."""
    old, new = text.splitlines(), fresh.splitlines()
    wrong = [] if len(old) == len(new) else [f"the page has {len(old)} lines, made anew {len(new)}"]
    for a, b in zip(old, new, strict=False):
        pairs = zip(NUMBER.findall(a), NUMBER.findall(b), strict=False)
        close = all(abs(float(u) - float(v)) <= SAME_FIGURE * max(abs(float(u)), abs(float(v))) for u, v in pairs)
        if NUMBER.sub("0", a) != NUMBER.sub("0", b) or not close:
            wrong.append(f"the page has: {a}\n   made anew: {b}")
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
        columns = (SpinnerColumn(), *Progress.get_default_columns(), TimeElapsedColumn())
        console = Console(stderr=True)
        with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
            bar = progress.add_task("random targets", total=targets)
            observed = monte_carlo(targets, WIDTH, seed, lambda n: progress.update(bar, completed=n))
            bar = progress.add_task("word lengths", total=len(WIDTHS))
            errors = curve(seed, REGULAR_POSES, lambda n: progress.update(bar, completed=n))
            bar = progress.add_task("sensitivities", total=1)
            moved = sensitivities(WIDTH, seed, SENSITIVITY_POSES)
            proved_errors = affine_errors(WIDTH, seed, SENSITIVITY_POSES)
            progress.update(bar, completed=1)
        return cls(observed, errors, moved, proved_errors)

    def page(self, targets: int, seed: int) -> str:
        """docs/generated/wordlengths.md."""
        return page(WIDTH, targets, seed, self.observed, self.moved, self.errors, self.proved_errors)


def main(arguments: list[str] | None = None) -> int:
    """The command; 0, or 1 where a format does not hold or the page is stale."""
    parser = argparse.ArgumentParser(description="Word lengths: ranges proved and seen, errors, plots.")
    parser.add_argument("--targets", type=int, default=1_000_000, help="random targets (default: 1000000)")
    parser.add_argument("--seed", type=int, default=1, help="of everything random (default: 1)")
    parser.add_argument("--check", action="store_true", help="write nothing; 1 when the page is out of date")
    options = parser.parse_args(arguments)
    if options.targets < 1 or options.seed < 0:
        parser.error("--targets is at least 1 and --seed at least 0")
    status = 0
    for width in WIDTHS:
        try:
            ranges.check(width)
        except ranges.RangeError as error:
            print(error, file=sys.stderr)
            status = 1
        except FormatError as error:  # nothing can be run
            print(error, file=sys.stderr)
            return 1
    print(f"seed {options.seed}, {options.targets} targets, W = {WIDTH}", flush=True)
    measured = Measured.now(options.targets, options.seed)
    observed, text = measured.observed, measured.page(options.targets, options.seed)
    if options.check:
        old = PAGE.read_text(encoding="utf-8")
        wrong = stale(old) + differing(old, text)
        print("\n".join(wrong) if wrong else f"{PAGE.relative_to(ROOT)} is up to date", file=sys.stderr)
        return 1 if wrong else status
    PAGE.write_text(text, encoding="utf-8")
    nodes = {name: proof.node for name, proof in ranges.proved(WIDTH).items()}
    PLOT.write_bytes(plot(measured.errors, shares(measured.moved, nodes)))
    print(f"wrote {PAGE.relative_to(ROOT)} and {PLOT.relative_to(ROOT)}")
    for name in observed.beyond:
        print(f"{name}: beyond its format for {observed.beyond[name]} targets, first {observed.first[name]}")
        status = 1
    outside = [
        name for name, seen in observed.nodes.items()
        for proof in [ranges.proved(WIDTH)[name]] for ulp in [proof.node.format.ulp]
        if seen.low * ulp < proof.low or seen.high * ulp > proof.high
    ]  # fmt: skip
    for name in outside:
        print(f"{name}: seen outside its proved range", file=sys.stderr)
    return 1 if outside else status


if __name__ == "__main__":
    sys.exit(main())
