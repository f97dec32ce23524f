# SPDX-License-Identifier: Apache-2.0
"""Write the generated Verilog headers: the nodes' formats and clocks, tables, and programs of the fold datapath.

    python -m scripts.generate.headers [--nets FOLDER]

Writes the headers that are out of date. With --nets, writes copies of all headers to a folder; in these, tables and
programs are constant nets, for tools that ignore `initial`. Put the folder before rtl/include.
"""

import os
import re
import sys
from collections.abc import Iterable, Sequence
from itertools import accumulate, groupby
from pathlib import Path

from model.dataflow import angles
from model.dataflow.angles import TABLE_BITS, atan_table
from model.dataflow.datapaths import MODELS
from model.dataflow.fixed import nodes
from model.dataflow.fold import steps as timing
from model.dataflow.fold.program import PROGRAMS, SCHEDULES, WORDS, Program, codes, fields, program, schedules
from model.dataflow.fold.shown import shown
from model.dataflow.fold.steps import Operand, Pick, Selector
from model.dataflow.formats import GUARD, INNER_FRAC, ROOT_FRACS, WIDTHS, Latency, inner_frac
from model.dataflow.nodes import Node
from model.dataflow.paper_operations import SINCOS_GUARD, cordic_gain
from model.dataflow.quadratic import INVERSE_ROOT, SINE, Form, Table, table_rows
from model.io.flags import ARM_FLAGS
from scripts.console import InputError, Options, command, option
from scripts.generate.render import TEMPLATES, update
from tb.sim.env import ROOT
from tb.sim.sources import nets

BODIES = TEMPLATES.get_template("headers.vh.j2").module
NOTE = """// SPDX-License-Identifier: Apache-2.0
// Written by `python -m scripts.generate.headers` from {source}; do not edit.

"""


def traced(datapath: str) -> dict[int, dict[str, Node]]:
    return {w: nodes(datapath, w) for w in MODELS[datapath].widths}


def _start(operands: tuple[Node, ...], runs: dict[int, dict[str, Node]]) -> str:
    """Return the name T_<NODE> of the clock in which the last operand is ready. runs: word length -> nodes. Raises
    ValueError if different operands are last at different word lengths."""
    times = {}
    for node in operands:
        if node.name:  # constants are always ready
            times.setdefault(tuple(run[node.name].time for run in runs.values()), f"T_{node.name.upper()}")
    last = tuple(max(column) for column in zip(*times, strict=True))
    if last not in times:
        raise ValueError(f"which of {sorted(times.values())} is last depends on the word length: give `after`")
    return times[last]


def lean_formats() -> str:
    return BODIES.lean_formats(WIDTHS[0], *ROOT_FRACS, inner_frac(24) - 24, INNER_FRAC)


def node_formats(datapath: str, only: str = "") -> str:
    """Return the header of a datapath's nodes, or of the nodes in section ``only`` if that is given."""
    runs, path = traced(datapath), MODELS[datapath]
    nodes = runs[WIDTHS[-1]]
    used = {node.latency for node in nodes.values()}
    latencies = [(kind, Latency.expression(kind), why) for kind, (*_, why) in Latency.TABLE.items() if kind in used]

    def ready(node: Node) -> str:
        waits_for = (*node.operands, node.after) if node.after else node.operands
        clocks = [_start(waits_for, runs)] if any(o.time for o in waits_for) else []
        return " + ".join(clocks + ([f"LAT_{node.latency.upper()}"] if node.latency else [])) or "0"

    sections = [
        (path.sections[section], [(node, ready(node)) for node in own])
        for section, own in groupby(nodes.values(), lambda node: node.section)
        if section == only or not only
    ]
    last = _start(tuple(nodes[n] for n in (*path.results, *path.flags)), runs)
    if only:
        return BODIES.choose_nodes(sections, last)
    return BODIES.nodes(GUARD if datapath == "paper" else None, latencies, sections, last)


def latencies() -> str:
    runs = [(key, traced(name)) for name, key in {"lean": 100, "paper": 0, "lean16": 1100}.items()]
    last = {key + w: max(node.time for node in of.values()) for key, found in runs for w, of in found.items()}
    return BODIES.latency(last.items())


def _row(words: Iterable[int], bits: Sequence[int], add: str) -> str:
    """Return a table row in Verilog: ``words``, each cut to its ``bits``, joined into one constant, plus ``add``."""
    row = "".join(format(word % (1 << size), f"0{size}b") for word, size in zip(words, bits, strict=True))
    return f"{sum(bits)}'h{int(row, 2):0{-(-sum(bits) // 4)}x} + {add}"


def quadratic_table(name: str, table: Table, rounding: str, *more: str) -> str:
    """Return the header of a module around ``ik_quadratic``: parameters and table. ``rounding`` is the constant added
    to c0, in Verilog. Each attribute of the forms named in ``more`` becomes a further parameter."""
    forms = {"small": table.small, "long": table.long, "short": table.short}
    roms = {size: [_row(row, of.c_bits, "ADD") for row in table_rows(table, of)] for size, of in forms.items()}
    return BODIES.quadratic_table(name, table.short_frac, rounding, forms, more, roms)


FOLD_FORMS = {size: (getattr(INVERSE_ROOT, size), getattr(SINE, size)) for size in ("small", "long")}
"""Size -> (root form, sine form) that share the fold datapath's table."""


def fold_codes(name: str) -> str:
    bits = fields(name)
    named = [(field, bits[field], [*map(_name, values)]) for field, values in codes(name).items()]
    return BODIES.fold_codes(sum(bits.values()), named)


def _name(code: str | Selector) -> str:
    """Convert a code to part of an identifier."""
    return code.code if isinstance(code, Selector) else code.replace("-", "minus_") or "none"


def fold_fields(name: str) -> str:
    bits = fields(name)
    return BODIES.fold_fields(name, zip(bits, bits.values(), accumulate(bits.values(), initial=0), strict=False))


def _rows(made: Program) -> list[tuple[str, list[str]]]:
    """Return (word in Verilog, notes for the comment) for each clock of a program's lap."""
    bits, period = sum(fields(made.name).values()), made.period
    notes = [(clock, f"{name} loaded") for name, clock in made.loads.items()]
    for placed in made.steps:
        step, at = placed.step, placed.at
        notes.append((at, f"{step.name}: {_operand(step.a)} * {_operand(step.b)}"))
        writes = (step.write and _operand(step.write.to), timing.WRITE), (step.norm and step.norm.to, timing.NORM)
        notes += [(at + late, f"-> {to}") for to, late in (*writes, (step.result, timing.WRITE)) if to]
    notes += [(clock, f"-> {name}") for name, clock in made.shown.items()]
    of_clock = [[note for clock, note in notes if clock % period == n] for n in range(period)]
    return [(f"{bits}'h{made.word(n):0{-(-bits // 4)}x}", of_clock[n]) for n in range(period)]


def _pick(values: Iterable[object]) -> str:
    """Return a value in Verilog. ``values``: the value in each program; if these differ, SHORT selects the first."""
    values = list(map(str, values))
    return values[0] if len(set(values)) == 1 else f"SHORT ? {values[0]} : {values[1]}"


def _after(made: Program) -> str:
    """Return hex digits, a byte per result: the number of results that are written after that result."""
    clocks = [made.written[result] for result in codes(made.name)["result"] if result in made.written]
    return "_".join(f"{sum(other > clock for other in clocks):02x}" for clock in reversed(clocks))


def fold_program(of: str) -> str:
    made, arm = [program(longest, of)[1] for longest in schedules(of)], of != "fold"
    laps = made[0].results[1] // made[0].period
    size, later = (made[0].period - 1).bit_length(), " and ".join(map(str, range(1, laps + 1)))
    lap = _pick(p.period for p in made), _pick(f"{size}'d{p.period - 1}" for p in made)
    events = {"HOLD": [p.results[0] - 1 for p in made], "FIRST": [p.results[0] for p in made]}
    events["LAST"] = [p.results[1] for p in made]
    laps = {name: _pick(at // p.period for at, p in zip(clocks, made, strict=True)) for name, clocks in events.items()}
    after = _pick(f"136'h{_after(p)}" for p in made) if arm else ""
    tables = dict(zip(("short", "long") if arm else ("",), map(_rows, made), strict=True))
    words = 1 + max(place % WORDS for p in made for place in p.places.values())
    last = 255 if arm else None  # address of the step that does nothing, used in reset
    return BODIES.fold_program(of, later, size, lap, laps, words, min(schedules(of)), after, last, tables)


def _operand(of: Operand | None) -> str:
    if not isinstance(of, Pick):
        return of or "c2"
    return f"{of.pair}{'+1' * of.second}{f' ({of.flag})' * bool(of.flag)}"


def fold_formats() -> str:
    for root, sine in FOLD_FORMS.values():
        assert root.c_frac[1:] == sine.c_frac[1:] and root.slope_frac == sine.slope_frac
        assert root.c_frac[0] <= sine.c_frac[0]
    return BODIES.fold_formats(ROOT_FRACS[1], FOLD_FORMS)


def _fold_rows(root: Form, sine: Form) -> list[str]:
    frac = sine.c_frac[0] + 1
    bits = (frac, *root.c_bits[1:])
    roots = [_row((c0 << frac - root.c_frac[0], c1, c2), bits, "ROOT") for c0, c1, c2 in table_rows(INVERSE_ROOT, root)]
    return roots + [_row((c0, c1, 2 * c2), bits, "SINE") for c0, c1, c2 in table_rows(SINE, sine)]


def fold_nodes(name: str) -> str:
    made = [program(longest, name) for longest in schedules(name)]
    blocks: dict[str, list[tuple]] = {}
    bits = (made[0][1].period - 1).bit_length()
    places = [shown(*one) for one in made]
    for of in places[0].values():
        each = [place[of.node.name] for place in places]
        clocks = (
            [f"{bits}'d{c % p.period}" for c, (_, p) in zip(one, made, strict=True)]
            for one in zip(*(place.clocks for place in each), strict=True)
        )  # each clock as a list of its places, one per program
        when = " || ".join(f"clock == {f'({pick})' if '?' in pick else pick}" for pick in map(_pick, clocks))
        blocks.setdefault(of.node.instance, []).append((of, _range(of.node), when, _pick(at.text for at in each)))
    return BODIES.fold_nodes(name, blocks)


def _range(node: Node) -> str:
    """Return the Verilog range of a node's word; an empty string for a single bit."""
    name, sign, number = re.fullmatch(r"(.*?)(?: ([+-]) (\d+))?", node.format.frac_expr).groups()
    more = int(f"{sign or '+'}{number or 0}") + node.format.width - node.format.frac - 1
    if name == "0":
        return f"[{more}:0] " if more else ""
    return f"[{name}{f' {more:+d}'.replace('+', '+ ').replace('-', '- ') if more else ''}:0] "


def texts() -> dict[Path, str]:
    rounding = "(3 << (SUM_FRAC - F - 3)) - (TILES + 1) / 2"
    found = {
        "paper_nodes": (node_formats("paper"), "paper.py"),
        "lean_nodes": (node_formats("lean"), "lean.py"),
        "arm_nodes": (node_formats("arm"), "arm.py", "lean.py"),
        "choose_nodes": (node_formats("choose", "choose"), "choose.py"),
        "lean_formats": (lean_formats(), "nodes.py"),
        "flags": (BODIES.flags((name, flag.bit_length() - 1) for name, flag in ARM_FLAGS.items()), "../io/flags.py"),
        "latency": (latencies(), "paper.py", "lean.py"),
        "sincos_table": (BODIES.sincos_table(TABLE_BITS, SINCOS_GUARD, cordic_gain(), atan_table()), "fixed.py"),
        "rsqrt_table": (quadratic_table("ik_rsqrt", INVERSE_ROOT, rounding, "tiles", "clocks"), "quadratic.py"),
        "trig_table": (quadratic_table("ik_trig", SINE, "1 << (SUM_FRAC - F - 1)", "clocks"), "quadratic.py"),
        "vector_table": (BODIES.vector_table(TABLE_BITS, angles.GUARD, angles.ANGLE), "angles.py"),
        "fold_formats": (fold_formats(), "nodes.py"),
        "fold_table": (BODIES.fold_table({n: _fold_rows(*forms) for n, forms in FOLD_FORMS.items()}), "quadratic.py"),
    }
    for name in PROGRAMS:
        flow = "arm.py" if name == "fold_arm" else "lean.py"
        found |= {
            f"{name}_codes": (fold_codes(name), "fold/program.py"),
            f"{name}_fields": (fold_fields(name), "fold/program.py"),
            f"{name}_nodes": (fold_nodes(name), "fold/shown.py"),
            f"{name}_program": (fold_program(name), f"fold/{SCHEDULES[name].name}", flow),
        }
    made = {}
    for name, (text, *files) in found.items():
        note = NOTE.format(source=" and ".join(os.path.normpath(f"model/dataflow/{file}") for file in files))
        made[ROOT / "rtl" / "include" / f"ik_{name}.vh"] = f"{note}{text.rstrip()}\n"
    return made


@command("headers", [option("--nets", "write copies with nets to this new folder", metavar="FOLDER")])
def main(options: Options) -> int:
    if not options.nets:
        update(texts())
        return 0
    folder = Path(options.nets)
    if folder.exists():
        raise InputError(f"argument --nets: {folder} exists")
    folder.mkdir(parents=True)
    for path, text in texts().items():
        (folder / path.name).write_text(nets(text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
