# SPDX-License-Identifier: Apache-2.0
"""Choice of the multipliers' sites on an ECP5-85k, before nextpnr, whose placer would put some too far apart."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.sparse import csr_array

from tb.sim.sources import digest

SITES = [
    (left + k, y, k) for y in (10, 34, 58) for left in (*range(4, 59, 9), *range(69, 115, 9)) for k in (0, 1, 4, 5)
]
"""(x, y, number) of each multiplier site of the chip."""

FANOUT = 32
"""Nets with more readers, such as resets, are ignored by :func:`coupling`."""

STEPS, MOVES = 60, 500_000
"""Steps of a random walk; moves of the annealing."""

VERSION = digest([Path(__file__)])


def floorplan(module: dict, seed: int) -> None:
    """Assign a site to each MULT18X18D of ``module``, which is in the format of Yosys' write_json. Strongly coupled
    multipliers get nearby sites. A module with fewer than 2 multipliers, or more than len(SITES), is left unchanged."""
    names = [name for name, cell in module["cells"].items() if cell["type"] == "MULT18X18D"]
    if 1 < len(names) <= len(SITES):
        weights = np.zeros((len(SITES),) * 2)
        weights[: len(names), : len(names)] = coupling(module, names)
        for name, k in zip(names, annealed(weights, seed), strict=False):
            x, y, number = SITES[k]
            module["cells"][name].setdefault("attributes", {})["BEL"] = f"X{x}/Y{y}/MULT18_{number}"


def coupling(module: dict, names: list[str]) -> np.ndarray:
    """Return the symmetric coupling matrix of the named cells. Entry (a, b) measures how often a
    random walk through the netlist that starts at cell a reaches cell b before any other named cell."""
    order = {name: k for k, name in enumerate(dict.fromkeys([*names, *module["cells"]]))}
    drivers: dict[int, int] = {}
    readers = defaultdict(list)
    for name, cell in sorted(module["cells"].items()):
        for port, nets in cell["connections"].items():
            for net in nets:
                if not isinstance(net, int):
                    continue
                if cell["port_directions"][port] == "output":
                    drivers[net] = order[name]
                else:
                    readers[net].append(order[name])
    pairs = [
        (drivers[net], one, 1 / len(found))
        for net, found in readers.items()
        if net in drivers and len(found) <= FANOUT
        for one in found
    ]
    first, second, weight = (np.array(column) for column in zip(*pairs, strict=True))
    one_way = csr_array((weight, (first.astype(int), second.astype(int))), shape=(len(order),) * 2)
    edges = one_way + one_way.T
    total = np.maximum(edges.sum(axis=1), 1e-9)[:, None]
    walk, fixed = edges / total, np.eye(len(names))
    reached = np.zeros((len(order), len(names)))  # share of the walks from a cell whose first named cell is this one
    for _ in range(STEPS):
        reached[: len(names)] = fixed
        reached = walk @ reached
    met = edges[: len(names)] @ np.vstack([fixed, reached[len(names) :]])
    return np.asarray(met + met.T) * (1 - fixed)


def annealed(weights: np.ndarray, seed: int) -> np.ndarray:
    """Return each cell's index in SITES. Simulated annealing minimizes the sum of weight * distance over pairs."""
    draw = np.random.default_rng(seed)
    places = np.array(SITES)[:, :2]
    distance = np.abs(places[:, None] - places).sum(axis=2).astype(float)
    site = draw.permutation(len(SITES))
    first = weights.sum() / len(SITES) * 30
    for heat in np.geomspace(first, first / 3000, MOVES // 1000):
        swaps, chances = draw.integers(0, len(SITES), (1000, 2)), -heat * np.log(draw.random(1000))
        for (i, j), limit in zip(swaps, chances, strict=True):
            change = (weights[i] - weights[j]) * (distance[site[j]] - distance[site[i]])[site]
            if change.sum() - change[i] - change[j] < limit:
                site[i], site[j] = site[j], site[i]
    return site
