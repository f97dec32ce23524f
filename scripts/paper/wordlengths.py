# SPDX-License-Identifier: Apache-2.0
"""Word lengths (section 4.3 of the paper): proved and observed ranges, hand error at each word length."""

import sys

import numpy as np

from model.bounds import ranges
from model.bounds.tolerances import REGULAR_DISTANCE
from model.dataflow import fixed
from model.dataflow.nodes import WIDTHS
from model.io.monte_carlo import Observed, monte_carlo, shown
from model.io.scoring import hand_errors, singular_distance
from model.io.words import Targets, result_values, to_words
from scripts.console import progress
from scripts.generate.render import error, render
from tb.sim.env import GENERATED

PAGE = GENERATED / "wordlengths.md"
WIDTH, SEED = 32, 1
TARGETS, REGULAR_POSES = 1_000_000, 20_000
REACH = 1.9
"""d1 + d2 of the arms of random regular poses, in the core's unit: nearly the largest that its words hold."""


def regular_poses(count: int, seed: int) -> Targets:
    """Return poses at least 0.2 rad from every singular one, of arms with d1 + d2 = :data:`REACH` and shares of 30 to
    70 %."""
    random = np.random.default_rng((seed, 6))
    columns = np.zeros((6, 0))
    while columns.shape[1] < count:
        d1 = REACH * random.uniform(0.3, 0.7, 2 * count)
        d2 = REACH - d1
        p = random.normal(size=(3, 2 * count))
        p *= random.uniform(np.abs(d1 - d2), d1 + d2) / np.linalg.norm(p, axis=0)
        rows = np.vstack([p, random.uniform(-np.pi, np.pi, 2 * count), d1, d2])
        far = singular_distance(Targets("regular", *rows)) >= REGULAR_DISTANCE
        columns = np.hstack([columns, rows[:, far]])
    return Targets("regular", *columns[:, :count])


def errors_of(width: int, poses: Targets) -> np.ndarray:
    """Return hand error / reach of the paper's datapath against the unrounded targets."""
    words, _ = to_words(poses, width, 0)
    return hand_errors(result_values(fixed.run(words, width, "paper").results, width), poses)


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


def page(observed: Observed) -> str:
    """Return docs/generated/wordlengths.md."""
    proofs = ranges.proved(WIDTH)
    rows = []
    for name, cells in proved_cells().items():
        seen, ulp = observed.nodes[name], proofs[name].node.format.ulp
        rows.append((name, *cells, _bounds(seen.low * ulp, seen.high * ulp)))
    about = {"regular_poses": REGULAR_POSES, "regular_distance": REGULAR_DISTANCE, "reach": REACH}
    poses = regular_poses(REGULAR_POSES, SEED)
    errors = ((width, errors_of(width, poses)) for width in WIDTHS)  # median, 99 %, largest
    about["errors"] = [(width, *map(error, np.quantile(each, (0.5, 0.99, 1)))) for width, each in errors]
    return render("wordlengths", width=WIDTH, widths=WIDTHS, seed=SEED, observed=observed, all_nodes=rows, **about)


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
    PAGE.write_text(page(observed), encoding="utf-8")
    print(f"wrote {PAGE.name}: {observed.targets} targets, W = {WIDTH}, seed {SEED}")
    return 0
