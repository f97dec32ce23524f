# SPDX-License-Identifier: Apache-2.0
"""Shorter words for the paper's datapath at W = 32: what each node can lose where accuracy allows it.

    python -m scripts.fpga.search [--synthesize] [--page]

A greedy search: of all nodes, the one is cut that wins most LUT4 (scripts/fpga/area.py) for the error that it adds,
until no cut keeps the predicted errors of hand and elbow within the limit on the regular trajectories. The outcome is
run in the bit-true model and goes to search.json, from which the page search.md is made. --synthesize has Yosys count,
for xc2vp, the RTL with the words of search.json (half an hour); --page only makes the page.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np

from model.bounds import predict
from model.dataflow import fixed
from model.dataflow.nodes import Node
from model.dataflow.reals import Real
from model.dataflow.shortened import MOST, ROUNDINGS, Shortened
from model.reference.kinematics import forward
from model.targets import trajectories
from model.targets.observed import default_arm, regular_poses, words_of
from model.targets.stimuli import mixed
from model.targets.words import from_words, result_values, to_words
from scripts.console import Parser, command, progress
from scripts.fpga import area
from scripts.fpga.runs import LIMIT as LIMIT_S
from scripts.fpga.runs import Run, TimeOutError, say
from scripts.fpga.shorten import shortened_rtl
from scripts.pages.render import render
from tb.sim.env import GENERATED, ROOT

FIGURES = GENERATED / "search.json"
PAGE = GENERATED / "search.md"
RTL = ROOT / "build" / "search"

WIDTH = 32
UNIFORM = 29
"""The least word length of all nodes together that keeps the limit."""
LIMIT = 1e-6
"""What the largest predicted error of hand and elbow / reach must not pass."""
ORDER = 24
"""Of the mean of errors over targets that stands for the largest: with the largest alone, one target would decide."""
POSES, MIXED = 20000, 20000
"""Random regular poses of the default arm, and targets of every kind, that the outcome is run on."""

TOGETHER = {
    **{f"p_e_{a}": (f"e_{a}_quo", f"p_e_{a}") for a in "xyz"},
    "sincos": ("sin_h", "cos_h"),
    "p_w": ("p_w_x", "p_w_y", "p_w_z"),
    "b": ("b_x", "b_y"),
    "u": ("u_x", "u_y"),
    "l_m": ("l_m_x", "l_m_y", "l_m_z"),
}
"""Nodes that are cut together: those of one operator, and a quotient with the choice behind it."""


def regular_words(width: int = WIDTH) -> np.ndarray:
    """Input words of all regular trajectories."""
    return np.concatenate([to_words(trajectories.make(name), width)[0] for name in trajectories.REGULAR])


# -- the prediction, to first order ----------------------------------------------------------------------------------


class Prediction:
    """What cuts do to elbow and hand at given targets; :func:`model.bounds.predict.bar` to first order."""

    def __init__(self, words: np.ndarray) -> None:
        self.bits = fixed.run(words, WIDTH).bits
        self.nodes = self.bits.nodes
        length = 2.0 ** (2 - WIDTH)
        d1, d2 = words[:, 4] * length, words[:, 5] * length
        self.inputs = (np.sqrt(3) / 2 + 1) * length / (d1 + d2)

        def points(name: str, move: float) -> np.ndarray:
            real = Real(self.bits, {name: np.full(len(words), move)})
            return np.hstack(real.points(d1, d2)) / (d1 + d2)[:, None]

        moving = [n.name for n in self.nodes.values() if n.op in ROUNDINGS or n.error != (0.0, 0.0)]
        effects = {name: points(name, 0.5) - points(name, -0.5) for name in moving}
        self.whole = {name: self._ends(name, effect, 0) for name, effect in effects.items()}
        self.cut = {name: self._ends(name, effect, 1) for name, effect in effects.items()}
        self.start = sum(self.whole.values())
        alone = {name: (name,) for name in moving if self.nodes[name].op in ("mul", "sum", "div", "root")}
        taken = {name for names in TOGETHER.values() for name in names}
        groups = {name: names for name, names in alone.items() if name not in taken} | TOGETHER
        # What neither point feels only decides a sign, which a shorter word could get wrong.
        self.groups = {
            name: names
            for name, names in groups.items()
            if max(np.abs(effects[k]).max() for k in names) * 2**MOST > length
        }

    def _ends(self, name: str, effect: np.ndarray, cut: int) -> np.ndarray:
        """How far a rounding can push elbow and hand along each axis, either way: (2, N, 6)."""
        node = self.nodes[name]
        low, high = ROUNDINGS.get(node.op, node.error) if cut else node.error
        return np.stack([np.maximum(effect * low, effect * high), np.maximum(-effect * low, -effect * high)])

    def pushed(self, name: str, cut: int) -> np.ndarray:
        """The same of a node that loses ``cut`` bits."""
        return self.cut[name] * 2.0**cut if cut else self.whole[name]

    def errors(self, pushed: np.ndarray) -> np.ndarray:
        """Elbow and hand error / reach (2, N) from the sum of all pushes."""
        worst = pushed.max(axis=0)
        return np.stack([np.linalg.norm(worst[:, axes], axis=1) for axes in (slice(3), slice(3, 6))]) + self.inputs


# -- the search ------------------------------------------------------------------------------------------------------


def search(prediction: Prediction, limit: float = LIMIT, most: int | None = None, step=lambda done: None):
    """Cuts one group after the other, at most ``most`` times: (group, its bits lost, LUT4 won, largest error)."""
    nodes, groups = prediction.nodes, prediction.groups
    readers = {group: area.readers(nodes, names) for group, names in groups.items()}
    level, cuts, pushed = dict.fromkeys(groups, 0), {}, prediction.start
    steps: list[tuple[str, int, float, float]] = []

    def mean(errors: np.ndarray) -> float:
        return float(((errors / limit) ** ORDER).mean() ** (1 / ORDER))

    while most is None or len(steps) < most:
        before, best = mean(prediction.errors(pushed)), None
        for group, names in groups.items():
            now = sum(area.luts(nodes, cuts, readers[group]).values())
            for bits in (level[group] + 1, level[group] + 2):  # a single one may win nothing
                won = now - sum(area.luts(nodes, cuts | dict.fromkeys(names, bits), readers[group]).values())
                if bits > MOST or won <= 0:
                    continue
                more = pushed + sum(prediction.pushed(k, bits) - prediction.pushed(k, level[group]) for k in names)
                errors = prediction.errors(more)
                if errors.max() > limit:
                    continue
                rate = won / max(mean(errors) - before, 1e-9)
                if best is None or rate > best[0]:
                    best = rate, group, bits, won, float(errors.max()), more
        if best is None:
            break
        _, group, bits, won, error, pushed = best
        level[group] = bits
        cuts |= dict.fromkeys(groups[group], bits)
        steps.append((group, bits, won, error))
        step(len(steps))
    return steps


def cuts_of(steps: Sequence) -> dict[str, int]:
    """Node -> bits lost, after all steps."""
    return {name: bits for group, bits, *_ in steps for name in TOGETHER.get(group, (group,))}


def predicted(words: np.ndarray, cuts: Mapping[str, int]) -> tuple[float, float]:
    """Largest predicted error / reach of elbow and hand, in full."""
    bits = fixed.answer(words, Shortened(WIDTH, cuts)).bits
    return tuple(float(predict.bar(bits, point).max()) for point in (predict.ELBOW, predict.HAND))


def kept(words: np.ndarray, steps: list, limit: float = LIMIT) -> list:
    """As many of the steps as the prediction in full allows, which is not of first order only."""
    while steps and max(predicted(words, cuts_of(steps))) > limit:
        steps = steps[:-1]
    return steps


# -- the outcome -----------------------------------------------------------------------------------------------------


def hand_errors(answer: fixed.Answer, words: np.ndarray) -> np.ndarray:
    """Distance of the hand from the target of the words / reach."""
    width = answer.bits.width
    asked, values = from_words(words, 0, width, "asked"), result_values(answer.results, width)
    _, wrist = forward(values[:, :4], values[:, 4:], asked.d1, asked.d2)
    return np.linalg.norm(wrist - asked.position, axis=1) / asked.reach


def observed(cuts: Mapping[str, int]) -> dict:
    """What the bit-true model says of the outcome; beside it the whole words, and the least that all have alike."""
    poses, kinds = regular_poses(POSES, 1, default_arm()), mixed(MIXED, WIDTH, 1)
    hand = {}
    for name, width, own in (("whole", WIDTH, {}), ("uniform", UNIFORM, {}), ("shortened", WIDTH, cuts)):
        hand[name] = []
        for words in (regular_words(width), words_of(poses, width)):
            errors = hand_errors(fixed.answer(words, Shortened(width, own)), words)
            hand[name] += [float(f"{f(errors):.2g}") for f in (np.median, np.max)]
    whole, short = fixed.run(kinds, WIDTH), fixed.answer(kinds, Shortened(WIDTH, cuts))
    limited = {name for name, node in short.bits.nodes.items() if node.facts.limited}
    beyond = [k for k, mask in short.bits.overflow.items() if k not in limited and np.any(mask)]
    return {"hand": hand, "flags": int((whole.flags != short.flags).sum()), "beyond": beyond}


def size(nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> dict[str, float]:
    """LUT4 and multipliers by the model of area."""
    return {"LUT": sum(area.luts(nodes, cuts).values()), "multipliers": area.multipliers(nodes, cuts)}


# -- in truth --------------------------------------------------------------------------------------------------------

PAPER = {"W": WIDTH, "DIGIT": 1}
ROWS = {"LAT": 34, "DIGIT": 1}
ALONE = (
    ("ik_mul", {"AW": 32, "BW": 32, "SH": 22, "OW": 40}, area.product((32, 32))),
    ("ik_mul", {"AW": 27, "BW": 29, "SH": 14, "OW": 40}, area.product((27, 29), (0, 0))),
    ("ik_mul", {"AW": 32, "BW": 32, "SH": 22, "OW": 40, "SQUARE": 1}, area.product((32, 32), square=True)),
    ("ik_sum2", {"IW": 40, "SH": 8, "OW": 32}, area.total((40, 40), 32)),
    ("ik_sum3", {"IW": 36, "SH": 8, "OW": 28, "SAT": 0}, area.total((36, 36, 36))),
    ("ik_div", {"NW": 40, "DW": 32, "SH": 23, "QW": 32, **ROWS}, area.quotient(40, 32, 32)),
    ("ik_div", {"NW": 32, "DW": 20, "SH": 13, "QW": 26, **ROWS}, area.quotient(32, 20, 26)),
    ("ik_root", {"NW": 32, "SH": 31, "QW": 32, **ROWS}, area.root(32)),
)
"""Single modules, their words, and the LUT4 that the model of area gives them."""

LONG = 60 * 60.0
"""Seconds for the synthesis of a datapath."""


def synthesized(nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> dict:
    """What Yosys counts: single modules, the datapath of uniform words, the shortened one."""
    alone = [[m, v, model, Run("synth", "xc2vp", m, v).done()["cells"]["LUT"]] for m, v, model in ALONE]
    designs = {"shortened": Run("synth", "xc2vp", "ik_paper", PAPER, root=shortened_rtl(RTL, nodes, cuts), limit=LONG)}
    designs["uniform"] = Run("synth", "xc2vp", "ik_paper", PAPER | {"W": UNIFORM})
    cells: dict[str, dict | None] = {}
    for name, run in designs.items():
        try:
            cells[name] = run.done()["cells"]
        except TimeOutError as error:
            say(str(error))
            cells[name] = None
    return {"alone": alone, **cells}


# -- the page --------------------------------------------------------------------------------------------------------

SHOWN = 24
"""Nodes of the page's table; the others are one line."""
BAR = 0.15
"""Part of the LUT4 that a named configuration has to win."""


def page(data: dict) -> str:
    """search.md."""
    whole = json.loads((GENERATED / "fpga.json").read_text())["runs"]["paper-W32-DIGIT1-xc2vp"]["cells"]
    nodes = fixed.run(regular_words()[:1], WIDTH).bits.nodes
    cuts, steps, outcome, sizes = cuts_of(data["steps"]), data["steps"], data["outcome"], data["sizes"]
    designs = [("whole", whole), *((k, data["synthesized"][k]) for k in ("uniform", "shortened"))]

    def line(what: str, figures: Sequence, shape="{}") -> list[str]:
        return [what, *(shape.format(v) for v in figures)]

    def won_by(lut: float) -> float:
        return 1 - lut / whole["LUT"]

    names, hand = [name for name, _ in designs], outcome["hand"]
    rows = [
        line(f"predicted, {point}, largest", [data["predicted"][n][k] for n in names], "{:.1e}")
        for k, point in enumerate(("elbow", "hand"))
    ]
    for k, what in enumerate(
        f"hand, {poses}, {figure}"
        for poses in ("regular trajectories", "random regular poses")
        for figure in ("median", "largest")
    ):
        rows.append(line(what, [hand[n][k] for n in names], "{:.1e}"))
    rows.append(line("LUT4 by the model of area", [round(sizes[n]["LUT"]) for n in names]))
    for kind, what in (("LUT", "LUT4 on xc2vp, by Yosys"), ("FF", "flip-flops"), ("multipliers", "MULT18X18")):
        rows.append(line(what, [cells[kind] if cells else "-" for _, cells in designs]))
    estimated = {name: (sizes["whole"]["LUT"] - sizes[name]["LUT"]) / whole["LUT"] for name in names}
    for what, figures in (
        ("LUT4 won, by the model of area", estimated),
        ("LUT4 won, by Yosys", {name: won_by(cells["LUT"]) for name, cells in designs if cells}),
    ):
        rows.append(line(what, [f"{100 * figures[n]:.1f} %" if n in figures else "-" for n in names]))
    won: dict[str, float] = {}
    for group, _, lut, _ in steps:
        won[group] = won.get(group, 0) + lut
    ranked = sorted(won, key=lambda group: -won[group])
    lines = []
    for group in ranked[:SHOWN]:
        first = TOGETHER.get(group, (group,))[0]
        lines.append([f"`{group}`", nodes[first].equation or "-", cuts[first], f"{won[group]:.0f}"])
    lines.append([f"{len(ranked) - SHOWN} others", "", "", f"{sum(won[g] for g in ranked[SHOWN:]):.0f}"])
    alone = [
        [f"`{module}`", ", ".join(f"{k} = {v}" for k, v in values.items()), f"{model:.0f}", seen,
         f"{100 * (model / seen - 1):+.0f} %"]
        for module, values, model, seen in data["synthesized"]["alone"]
    ]  # fmt: skip
    return render(
        "search", width=WIDTH, uniform=UNIFORM, limit=LIMIT, targets=len(regular_words()), poses=POSES, mixed=MIXED,
        minutes=round(LIMIT_S / 60), cuts=cuts, steps=steps, outcome=outcome, sizes=sizes, whole=whole, rows=rows,
        won=lines, alone=alone,
        verdict=verdict(won_by(data["synthesized"]["shortened"]["LUT"])),
    )  # fmt: skip


def verdict(won: float) -> str:
    """What the LUT4 won node by node say of a configuration."""
    text = f"Node by node {100 * won:.1f} % of the LUT4 are won."
    if won <= BAR:
        return f"{text} A configuration of its own was to win more than {100 * BAR:.0f} %: there is none."
    return (
        f"{text} That is more than the {100 * BAR:.0f} % asked of a configuration of its own.\n"
        "The core has none yet: what is counted is a copy of the RTL, `build/search`."
    )


@command("search")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("fpga.search", __doc__.splitlines()[0], fails="a node leaves its format, or flags change")
    parser.add_argument("--synthesize", action="store_true", help="count the words of search.json with Yosys")
    parser.add_argument("--page", action="store_true", help="only write the page from the figures")
    options = parser.parse_args(arguments)
    data = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
    if options.synthesize:
        nodes = fixed.run(regular_words()[:1], WIDTH).bits.nodes
        data["synthesized"] = synthesized(nodes, cuts_of(data["steps"]))
    elif not options.page:
        data |= found()
    FIGURES.write_text(written(data))
    if "synthesized" in data:
        PAGE.write_text(page(data))
    print(f"{len(data['steps'])} steps; by the model of area {data['sizes']['shortened']['LUT']:.0f} LUT4 are left of"
          f" {data['sizes']['whole']['LUT']:.0f}")  # fmt: skip
    return 1 if data["outcome"]["flags"] or data["outcome"]["beyond"] else 0


def found() -> dict:
    """A new search, all but what is synthesized."""
    words = regular_words()
    prediction = Prediction(words)
    with progress("cuts", 500) as meter:
        steps = kept(words, search(prediction, step=meter))
    cuts, nodes = cuts_of(steps), prediction.nodes
    short = fixed.run(regular_words(UNIFORM), UNIFORM).bits
    uniform = tuple(float(predict.bar(short, point).max()) for point in (predict.ELBOW, predict.HAND))
    return {
        "steps": [[group, bits, won, float(f"{error:.3g}")] for group, bits, won, error in steps],
        "predicted": {"whole": predicted(words, {}), "uniform": uniform, "shortened": predicted(words, cuts)},
        "sizes": {"whole": size(nodes, {}), "uniform": size(short.nodes, {}), "shortened": size(nodes, cuts)},
        "outcome": observed(cuts),
    }


def written(data: dict) -> str:
    """search.json: a line a step, so that a diff shows which ones are new."""
    steps = ",\n".join(f"  {json.dumps(step)}" for step in data["steps"])
    parts = [f' "{key}": {json.dumps(value)}' for key, value in data.items() if key != "steps"]
    return "{\n" + ",\n".join([' "steps": [\n' + steps + "\n ]", *parts]) + "\n}\n"


if __name__ == "__main__":
    raise SystemExit(main())
