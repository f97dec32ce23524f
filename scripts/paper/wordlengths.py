# SPDX-License-Identifier: Apache-2.0
"""Word lengths (section 4.3 of the paper): proved and observed ranges, hand error at each word length."""

from __future__ import annotations

import math
import sys

import numpy as np

from model.bounds import predict, ranges
from model.bounds.predict import Real
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS, Node
from model.io import trajectories
from model.io.monte_carlo import Observed, monte_carlo, shown
from model.io.scoring import singular_distance
from model.io.words import DEFAULT_D1, DEFAULT_D2, Targets, result_values, scale_exponent, to_words
from model.reference.kinematics import forward
from scripts.console import progress
from scripts.generate.render import error, render
from tb.sim.env import GENERATED

PAGE = GENERATED / "wordlengths.md"
WIDTH, SEED = 32, 1
TARGETS, REGULAR_POSES, SENSITIVITY_POSES = 1_000_000, 20_000, 1000
DOMINATING = 12
"""Rows of the table of nodes that contribute most to the hand error."""


REACH = 1.9
"""d1 + d2 of the arms of random regular poses, in the core's unit: nearly the largest that its words hold."""


def default_arm() -> tuple[float, float]:
    """Return d1 and d2 of the default arm in the core's unit, scaled as its targets are; equal at all word lengths."""
    exponent = scale_exponent(trajectories.make(trajectories.DEFAULT), WIDTHS[-1])
    return math.ldexp(DEFAULT_D1, exponent), math.ldexp(DEFAULT_D2, exponent)


def regular_poses(count: int, seed: int, arm: tuple[float, float] | None = None) -> Targets:
    """Return poses at least 0.2 rad from every singular one: of an ``arm`` d1, d2, or of arms with d1 + d2 =
    :data:`REACH` and shares of 30 to 70 %."""
    random = np.random.default_rng((seed, 6))
    columns = np.zeros((6, 0))
    while columns.shape[1] < count:
        if arm:
            d1, d2 = (np.full(2 * count, length) for length in arm)
        else:
            d1 = REACH * random.uniform(0.3, 0.7, 2 * count)
            d2 = REACH - d1
        p = random.normal(size=(3, 2 * count))
        p *= random.uniform(np.abs(d1 - d2), d1 + d2) / np.linalg.norm(p, axis=0)
        rows = np.vstack([p, random.uniform(-np.pi, np.pi, 2 * count), d1, d2])
        far = singular_distance(Targets("regular", *rows)) >= REGULAR_DISTANCE
        columns = np.hstack([columns, rows[:, far]])
    return Targets("regular", *columns[:, :count])


def hand_errors(width: int, poses: Targets) -> np.ndarray:
    """Return the distance of the hand from the unrounded target / reach."""
    values = result_values(fixed.run(to_words(poses, width, 0)[0], width).results, width)
    _, wrist = forward(values[:, :4], values[:, 4:], poses.d1, poses.d2)
    return np.linalg.norm(wrist - poses.position, axis=1) / poses.reach


def sensitivities(width: int, seed: int, count: int) -> dict[str, np.ndarray]:
    """Return the hand displacement per ulp of each rounded node, relative to the reach, at regular poses (count,)."""
    words, _ = to_words(regular_poses(count, seed), width, 0)
    bits = fixed.run(words, width).bits
    length = 2.0 ** (2 - width)
    d1, d2 = words[:, 4] * length, words[:, 5] * length

    def hand(name: str, move: float) -> np.ndarray:
        return Real(bits, {name: np.full(len(words), move)}).points(d1, d2)[1]

    return {
        node.name: np.linalg.norm(hand(node.name, 0.5) - hand(node.name, -0.5), axis=1) / (d1 + d2)
        for node in predict.rounded_nodes(bits)
    }


def shares(moved: dict[str, np.ndarray], nodes: dict[str, Node]) -> dict[str, float]:
    """Return each node's share of the predicted mean squared hand error, averaged over poses, largest first."""
    variance = {n: (e * (nodes[n].error[1] - nodes[n].error[0])) ** 2 / 12 for n, e in moved.items()}
    total = sum(variance.values())
    part = {name: float(np.mean(v / total)) for name, v in variance.items()}
    return dict(sorted(part.items(), key=lambda item: (-item[1], item[0])))


def hand_error_by_width() -> dict[int, tuple[float, ...]]:
    """Return for each word length, at regular poses: hand error (median, 99 %, largest) of all arms, then of the
    default arm."""
    arms = regular_poses(REGULAR_POSES, SEED), regular_poses(REGULAR_POSES, SEED, default_arm())
    result = {}
    for width in WIDTHS:
        errors = [hand_errors(width, poses) for poses in arms]
        result[width] = tuple(float(f) for e in errors for f in (np.median(e), np.quantile(e, 0.99), e.max()))
    return result


def proved_cells() -> dict[str, list[str]]:
    """Return for each node name its format, wasted leading bits and proved range."""
    proofs = ranges.proved(WIDTH)
    cells = {}
    for name in shown({n: p.node for n, p in proofs.items()}):
        proof, fmt = proofs[name], proofs[name].node.format
        kind = f"{'s' if fmt.signed else 'u'}{fmt.width}.{fmt.frac}"
        cells[name] = [kind, str(proof.bits_wasted), _bounds(proof.low, proof.high)]
    return cells


def _bounds(low: float, high: float) -> str:
    return f"{low + 0.0:.6g} .. {high + 0.0:.6g}"


def page(observed: Observed, errors: dict[int, tuple[float, ...]], moved: dict[str, np.ndarray]) -> str:
    """Return docs/generated/wordlengths.md."""
    nodes = {name: proof.node for name, proof in ranges.proved(WIDTH).items()}
    rows = []
    for name, cells in proved_cells().items():
        seen, ulp = observed.nodes[name], nodes[name].format.ulp
        rows.append((name, *cells, _bounds(seen.low * ulp, seen.high * ulp)))
    return render(
        "wordlengths",
        width=WIDTH,
        widths=WIDTHS,
        observed=observed,
        seed=SEED,
        regular_poses=REGULAR_POSES,
        regular_distance=REGULAR_DISTANCE,
        reach=REACH,
        default_arm=default_arm(),
        default_reach=DEFAULT_D1 + DEFAULT_D2,
        errors=[(w, *map(error, row)) for w, row in errors.items()],
        dominating=[
            (name, nodes[name].equation or "-", f"{100 * part:.1f} %")
            for name, part in list(shares(moved, nodes).items())[:DOMINATING]
        ],
        all_nodes=rows,
    )


def problems(observed: Observed) -> list[str]:
    """Return a line for each node that left its format or its proved range in the observed targets."""
    proofs = ranges.proved(WIDTH)
    wrong = [
        f"{name}: beyond its format for {n} targets, first {observed.first[name]}"
        for name, n in observed.beyond.items()
    ]
    for name, seen in observed.nodes.items():
        proof, ulp = proofs[name], proofs[name].node.format.ulp
        if seen.low * ulp < proof.low or seen.high * ulp > proof.high:
            wrong.append(f"{name}: seen outside its proved range")
    return wrong


def write() -> int:
    """Prove the ranges at every word length, observe them in the model, write the page; return 1 if a node fails.

    Raises RangeError or FormatError, which name the node, if a range is not proved.
    """
    for width in WIDTHS:
        ranges.check(width)
    with progress("random targets", TARGETS) as meter:
        observed = monte_carlo(TARGETS, WIDTH, SEED, meter)
    if wrong := problems(observed):
        print(*wrong, sep="\n", file=sys.stderr)
        return 1
    text = page(observed, hand_error_by_width(), sensitivities(WIDTH, SEED, SENSITIVITY_POSES))
    PAGE.write_text(text, encoding="utf-8")
    print(f"wrote {PAGE.name}: {observed.targets} targets, W = {WIDTH}, seed {SEED}")
    return 0
