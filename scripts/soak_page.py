# SPDX-License-Identifier: Apache-2.0
"""docs/generated/soak.md: what soaks with KEEP=1 found, a row a datapath, word length and kind of targets."""

from __future__ import annotations

import json
from datetime import date

from model.bounds import tolerances
from model.dataflow.datapaths import CONFIGURATIONS
from model.io.flags import FLAGS, SATURATED
from scripts.console import InputError, whole_file
from scripts.generate.render import render
from tb.core.random_targets import Core, Found
from tb.sim.env import GENERATED
from tb.sim.sources import closure, digest

PAGE, FIGURES = GENERATED / "soak.md", GENERATED / "soak.json"


def recorded() -> dict[str, dict]:
    """Row -> its figures. Raises InputError."""
    try:
        return json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.exists() else {}
    except ValueError as error:
        raise InputError(f"{FIGURES}: {error}") from None


def code(datapath: str) -> str:
    """A digest of the Verilog of a datapath, and of ik_axis.v."""
    return digest({*closure(f"ik_{CONFIGURATIONS[datapath].rtl}"), *closure("ik_axis")[:1]})


def keep(core: Core, of: str, found: Found, first: int) -> None:
    """Puts what all targets gave into the figures, and writes the page."""
    kind = f"{core.datapath}, {core.width} bits, {of}"
    row = {
        "datapath": core.datapath, "width": core.width, "of": of, "simulator": core.sim, "from": first,
        "date": date.today().isoformat(), "code": code(core.datapath),
        "targets": found.targets, "reachable": found.reachable,
        "hand": found.hand_error_max, "tolerance": tolerances.hand(core.width, core.datapath),
        "norm": found.norm_error_max, "flags": dict(found.flags), "apart": found.apart,
    }  # fmt: skip
    rows = dict(sorted((recorded() | {kind: row}).items()))
    with whole_file(FIGURES) as place:
        place.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    with whole_file(PAGE) as place:
        place.write_text(page(list(rows.values())), encoding="utf-8")


def page(rows: list[dict]) -> str:
    names = [flag.name for flag in FLAGS if flag.bit != SATURATED]

    def number(value: float | None) -> str:
        return "-" if value is None else f"{value:.2e}"

    return render(
        "soak", names=names,
        targets=[
            (r["datapath"], r["width"], r["of"], r["date"], r["targets"], r["reachable"], number(r["hand"]),
             number(r["tolerance"]), number(r["norm"])) for r in rows
        ],
        flags=[(r["datapath"], r["width"], r["of"], *(r["flags"].get(name, 0) for name in names)) for r in rows],
        apart=[
            (r["datapath"], r["width"], r["of"], of, count, number(most), f"{most * 2.0 ** (r['width'] - 2):.2f}",
             number(tolerances.lean(r["width"])))
            for r in rows for of, (count, most) in r["apart"].items()
        ],
    )  # fmt: skip
