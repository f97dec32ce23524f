# SPDX-License-Identifier: Apache-2.0
"""Shorter words for the dividers, roots and CORDIC of the paper's datapath at W = 32: the cuts of DATAPATH=short.

    python -m scripts.fpga.search [--synthesize] [--page]

A greedy search: of all quotients, roots, and sine and cosine, the one is cut that wins most LUT4 (scripts/fpga/area.py)
for the error that it adds, until no cut keeps the predicted errors of hand and elbow within the limit on the regular
trajectories. The outcome is run in the bit-true model and goes to search.json, from which the page search.md is made;
what it found is written by hand into model/dataflow/short.py, which a test compares. --synthesize has Yosys count
single modules for xc2vp; --page only makes the page.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import numpy as np

from model.bounds import predict, tolerances
from model.dataflow import fixed, short
from model.dataflow.nodes import FLOOR, SHORT_CORDIC, Node
from model.dataflow.reals import Real
from model.io import trajectories
from model.io.monte_carlo import default_arm, regular_poses, words_of
from model.io.stimuli import mixed
from model.io.words import from_words, result_values, to_words
from model.reference.kinematics import forward
from scripts.console import Parser, command, progress
from scripts.fpga import area
from scripts.fpga import page as fpga_page
from scripts.fpga.runs import Run
from scripts.generate.render import render
from tb.sim.env import GENERATED

FIGURES = GENERATED / "search.json"
PAGE = GENERATED / "search.md"

WIDTH = short.WIDTH
UNIFORM = 29
"""The least word length of all nodes together that keeps the limit."""
LIMIT = 1e-6
"""What the largest predicted error of hand and elbow / reach must not pass."""
ORDER = 24
"""Of the mean of errors over targets that stands for the largest: with the largest alone, one target would decide."""
POSES, MIXED = 20000, 20000
"""Random regular poses of the default arm, and targets of every kind, that the outcome is run on."""

MOST = 14
"""Bits that a node can lose: so many leave every shift of a divider and a root a shift to the left."""

TOGETHER = {"sincos": ("sin_h", "cos_h")}
"""Nodes that are cut together: those of one operator."""

FOLLOWS = {f"e_{a}_quo": f"p_e_{a}" for a in "xyz"}
"""A quotient, and the choice behind it that rounds as it does."""

ROUNDINGS = {"div": FLOOR, "root": FLOOR, "sincos": SHORT_CORDIC}
"""Operations whose words are cut, and what they add once they drop places; a choice adds its own."""


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
        alone = {name: (name,) for name in moving if self.nodes[name].op in ("div", "root")}
        self.groups = alone | TOGETHER
        for name, follower in FOLLOWS.items():
            self.whole[name] = self.whole[name] + self.whole.pop(follower)
            self.cut[name] = self.cut[name] + self.cut.pop(follower)

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
    bits = fixed.answer(words, fixed.Bits(WIDTH, cuts=cuts)).bits
    return tuple(float(predict.bar(bits, point).max()) for point in (predict.ELBOW, predict.HAND))


def kept(words: np.ndarray, steps: list, limit: float = LIMIT) -> list:
    """As many of the steps as the prediction in full allows, which is not of first order only."""
    while steps and max(predicted(words, cuts_of(steps))) > limit:
        steps = steps[:-1]
    return steps


# -- the outcome -----------------------------------------------------------------------------------------------------


def errors_of(answer: fixed.Answer, words: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance of the hand from the target of the words / reach, and the larger abs(norm^2 - 1) of both quaternions."""
    width = answer.bits.width
    asked, values = from_words(words, 0, width, "asked"), result_values(answer.results, width)
    _, wrist = forward(values[:, :4], values[:, 4:], asked.d1, asked.d2)
    norm = np.abs(np.stack([(values[:, :4] ** 2).sum(axis=1), (values[:, 4:] ** 2).sum(axis=1)]) - 1).max(axis=0)
    return np.linalg.norm(wrist - asked.position, axis=1) / asked.reach, norm


def observed(cuts: Mapping[str, int]) -> dict:
    """What the bit-true model says of the outcome; beside it the whole words, and the least that all have alike."""
    poses, kinds = regular_poses(POSES, 1, default_arm()), mixed(MIXED, WIDTH, 1)
    hand, norm = {}, {}
    for name, width, own in (("whole", WIDTH, {}), ("uniform", UNIFORM, {}), ("shortened", WIDTH, cuts)):
        hand[name] = []
        for words in (regular_words(width), words_of(poses, width)):
            errors, norms = errors_of(fixed.answer(words, fixed.Bits(width, cuts=own)), words)
            hand[name] += [float(f"{f(errors):.2g}") for f in (np.median, np.max)]
        norm[name] = float(f"{norms.max():.2g}")
    whole, shorter = fixed.run(kinds, WIDTH), fixed.answer(kinds, fixed.Bits(WIDTH, cuts=cuts))
    limited = {name for name, node in shorter.bits.nodes.items() if node.facts.limited}
    beyond = [k for k, mask in shorter.bits.overflow.items() if k not in limited and np.any(mask)]
    return {"hand": hand, "norm": norm, "flags": int((whole.flags != shorter.flags).sum()), "beyond": beyond}


def size(nodes: Mapping[str, Node], cuts: Mapping[str, int]) -> dict[str, float]:
    """LUT4 and multipliers by the model of area."""
    return {"LUT": sum(area.luts(nodes, cuts).values()), "multipliers": area.multipliers(nodes, cuts)}


# -- the model of area beside what Yosys counts ----------------------------------------------------------------------

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

def counted() -> list:
    """The modules of ALONE: with the LUT4 that the model gives them, and those that Yosys counts."""
    return [[m, v, model, Run("synth", "xc2vp", m, v).done()["cells"]["LUT"]] for m, v, model in ALONE]


# -- the page --------------------------------------------------------------------------------------------------------

BAR = 0.15
"""Part of the LUT4 that a named configuration has to win."""


def page(data: dict) -> str:
    """search.md."""
    fpga = json.loads(fpga_page.FIGURES.read_text())
    whole, shorter = (fpga_page.synthesized(fpga, name, WIDTH, "xc2vp")["cells"] for name in ("paper", "short"))
    nodes = fixed.run(regular_words()[:1], WIDTH).bits.nodes
    cuts, steps, outcome, sizes = cuts_of(data["steps"]), data["steps"], data["outcome"], data["sizes"]
    names = ("whole", "uniform", "shortened")

    def line(what: str, figures: Sequence, shape="{}") -> list[str]:
        return [what, *(shape.format(v) for v in figures)]

    rows = [
        line(f"predicted, {point}, largest", [data["predicted"][n][k] for n in names], "{:.1e}")
        for k, point in enumerate(("elbow", "hand"))
    ]
    for k, what in enumerate(
        f"hand, {poses}, {figure}"
        for poses in ("regular trajectories", "random regular poses")
        for figure in ("median", "largest")
    ):
        rows.append(line(what, [outcome["hand"][n][k] for n in names], "{:.1e}"))
    rows.append(line("abs(norm^2 - 1), random regular poses, largest", [outcome["norm"][n] for n in names], "{:.1e}"))
    rows.append(line("LUT4 by the model of area", [round(sizes[n]["LUT"]) for n in names]))
    for kind, what in (("LUT", "LUT4 on xc2vp, by Yosys"), ("FF", "flip-flops"), ("multipliers", "MULT18X18")):
        rows.append([what, whole[kind], "-", shorter[kind]])
    estimated = [(sizes["whole"]["LUT"] - sizes[n]["LUT"]) / whole["LUT"] for n in names]
    rows.append(line("LUT4 won, by the model of area", [f"{100 * part:.1f} %" for part in estimated]))
    won_in_truth = 1 - shorter["LUT"] / whole["LUT"]
    rows.append(["LUT4 won, by Yosys", "-", "-", f"{100 * won_in_truth:.1f} %"])
    won: dict[str, float] = {}
    for group, _, lut, _ in steps:
        won[group] = won.get(group, 0) + lut
    lines = []
    for group in sorted(won, key=lambda group: -won[group]):
        first = TOGETHER.get(group, (group,))[0]
        lines.append([f"`{group}`", nodes[first].equation or "-", cuts[first], f"{won[group]:.0f}"])
    alone = [
        [f"`{module}`", ", ".join(f"{k} = {v}" for k, v in values.items()), f"{model:.0f}", seen,
         f"{100 * (model / seen - 1):+.0f} %"]
        for module, values, model, seen in data["alone"]
    ]  # fmt: skip
    return render(
        "search", width=WIDTH, uniform=UNIFORM, limit=LIMIT, targets=len(regular_words()), poses=POSES, mixed=MIXED,
        cuts=cuts, steps=steps, outcome=outcome, sizes=sizes, whole=whole, rows=rows, lines=lines, alone=alone,
        won=f"{100 * won_in_truth:.1f}", bar=f"{100 * BAR:.0f}", norm=tolerances.norm(WIDTH, "short"),
    )  # fmt: skip


@command("search")
def main(arguments: Sequence[str] | None) -> int:
    parser = Parser("fpga.search", __doc__.splitlines()[0], fails="a node leaves its format, or flags change")
    parser.add_argument("--synthesize", action="store_true", help="count the modules of the model of area with Yosys")
    parser.add_argument("--page", action="store_true", help="only write the page from the figures")
    options = parser.parse_args(arguments)
    data = json.loads(FIGURES.read_text())
    if options.synthesize:
        data["alone"] = counted()
    elif not options.page:
        data |= found()
    FIGURES.write_text(written(data))
    PAGE.write_text(page(data))
    print(f"{len(data['steps'])} steps; by the model of area {data['sizes']['shortened']['LUT']:.0f} LUT4 are left of"
          f" {data['sizes']['whole']['LUT']:.0f}")  # fmt: skip
    if cuts_of(data["steps"]) != short.CUTS:
        print(f"model/dataflow/short.py has other cuts: {cuts_of(data['steps'])}")
    return 1 if data["outcome"]["flags"] or data["outcome"]["beyond"] else 0


def found() -> dict:
    """A new search, all but what Yosys counts."""
    words = regular_words()
    prediction = Prediction(words)
    with progress("cuts", 150) as meter:
        steps = kept(words, search(prediction, step=meter))
    cuts, nodes = cuts_of(steps), prediction.nodes
    alike = fixed.run(regular_words(UNIFORM), UNIFORM).bits
    uniform = tuple(float(predict.bar(alike, point).max()) for point in (predict.ELBOW, predict.HAND))
    return {
        "steps": [[group, bits, won, float(f"{error:.3g}")] for group, bits, won, error in steps],
        "predicted": {"whole": predicted(words, {}), "uniform": uniform, "shortened": predicted(words, cuts)},
        "sizes": {"whole": size(nodes, {}), "uniform": size(alike.nodes, {}), "shortened": size(nodes, cuts)},
        "outcome": observed(cuts),
    }


def written(data: dict) -> str:
    """search.json: a line a step, so that a diff shows which ones are new."""
    steps = ",\n".join(f"  {json.dumps(step)}" for step in data["steps"])
    parts = [f' "{key}": {json.dumps(value)}' for key, value in data.items() if key != "steps"]
    return "{\n" + ",\n".join([' "steps": [\n' + steps + "\n ]", *parts]) + "\n}\n"


if __name__ == "__main__":
    raise SystemExit(main())
