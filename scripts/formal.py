# SPDX-License-Identifier: Apache-2.0
"""make formal: proofs of streams, dividers and roots, and that nothing overflows; each is seen failing on seeded bugs.

    python -m scripts.formal [streams|ranges|arithmetic|widths] [--only NAME] [--width W] [--again] [--list]

A full run of a part without a failure writes its page, docs/generated/proofs.md, ranges_proofs.md,
arithmetic_proofs.md or widths_proofs.md.
"""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from datetime import date
from os import cpu_count
from pathlib import Path

from model.io.files import write_atomically
from scripts.console import InputError, Parser, exit_status, word_length
from scripts.generate import ranges_proofs
from scripts.generate.page_tables import table
from scripts.generate.render import render
from tb.formal import arithmetic, arithmetic_parts, overflow, prove, widths
from tb.formal.arithmetic_parts import ARITHMETIC
from tb.formal.proofs import PROOFS
from tb.formal.range_bugs import FULL
from tb.formal.range_table import DATAPATHS
from tb.formal.tools import missing, running, versions
from tb.sim.env import GENERATED, ROOT

STREAMS_PAGE = GENERATED / "proofs.md"
RANGES_PAGE = GENERATED / "ranges_proofs.md"
ARITHMETIC_PAGE = GENERATED / "arithmetic_proofs.md"
WIDTHS_PAGE = GENERATED / "widths_proofs.md"


def say(text: str) -> None:
    """A line at once."""
    print(text, flush=True)


def streams_page(results: Sequence[prove.Result], digests: dict[str, str]) -> str:
    """docs/generated/proofs.md."""
    seconds = sum(result.total for result in results)
    kinds = {proof.of: proof for proof in PROOFS}.values()
    return render(
        "proofs", today=date.today().isoformat(), tools=versions(), seconds=seconds,
        results=list(zip(PROOFS, results, strict=True)), kinds=kinds, digests=digests,
    )  # fmt: skip


def written(page: Path, text: str, fresh: bool) -> bool:
    """Writes a page, unless its sources were changed during the run."""
    if fresh:
        write_atomically(page, text)
        say(f"wrote {page.relative_to(ROOT)}")
    else:
        print(f"formal: sources were changed during the run, {page.name} is not written", file=sys.stderr)
    return fresh


def streams(options: Namespace) -> bool:
    """The first part; whether all is well."""
    chosen = [p for p in PROOFS if not options.only or p.name.startswith(tuple(options.only))]
    if options.list:
        for proof in chosen:
            say(f"{proof.name:<16} {proof.engine:<6} {proof.module:<12} {proof.width}: {', '.join(proof.says)}")
    if options.list or not chosen:
        return True
    before, start = prove.digests(), time.monotonic()
    with ThreadPoolExecutor(cpu_count()) as pool:
        try:
            results = [prove.run(proof, pool, say, options.again) for proof in chosen]
        except BaseException:
            running.stop()
            pool.shutdown(cancel_futures=True)
            raise
    failed, bugs = sum(bool(result.failed) for result in results), sum(len(result.seeded) for result in results)
    say(f"{len(results) - failed} of {len(results)} proofs, {bugs} seeded bugs, {time.monotonic() - start:.0f} s")
    if failed or len(chosen) < len(PROOFS):
        return not failed
    return written(STREAMS_PAGE, streams_page(results, before), before == prove.digests())


def ranges(options: Namespace) -> bool:
    """The second part; whether all is well."""
    if options.list:
        for datapath in DATAPATHS:
            say("\n".join(f"{datapath}/{name}" for name in overflow.chosen(datapath, FULL, options.only)))
    if options.list or not any(overflow.chosen(datapath, FULL, options.only) for datapath in DATAPATHS):
        return True
    before = overflow.digests()
    found = overflow.run(options.width or [FULL], options.only, say)
    if found.failed or options.only or options.width:
        return not found.failed
    return written(RANGES_PAGE, ranges_proofs.page(found, before), before == overflow.digests())


def arithmetic_page(results: Sequence[arithmetic.Found], digests: dict[str, str]) -> str:
    """docs/generated/arithmetic_proofs.md."""
    return render(
        "arithmetic_proofs", today=date.today().isoformat(), tools=versions(),
        seconds=sum(found.seconds for found in results),
        results=list(zip(ARITHMETIC, results, strict=True)), digests=digests,
    )  # fmt: skip


def numbers(options: Namespace) -> bool:
    """The third part; whether all is well."""
    chosen = [part for part in ARITHMETIC if not options.only or part.name.startswith(tuple(options.only))]
    if options.list:
        for part in chosen:
            say(f"{part.name:<16} z3     {part.title}")
    if options.list or not chosen or options.width:
        return True
    before = arithmetic_parts.digests()
    with ThreadPoolExecutor(cpu_count()) as pool:
        try:
            found = [arithmetic.run(part, pool, say) for part in chosen]
        except BaseException:
            running.stop()
            pool.shutdown(cancel_futures=True)
            raise
    failed = any(results.failed for results in found)
    if failed or len(chosen) < len(ARITHMETIC):
        return not failed
    return written(ARITHMETIC_PAGE, arithmetic_page(found, before), before == arithmetic_parts.digests())


def widths_page(results: Sequence[widths.Result], missing: Sequence[str], digests: dict[str, str]) -> str:
    """docs/generated/widths_proofs.md."""
    return render(
        "widths_proofs", today=date.today().isoformat(), tools=versions(), others=widths.OTHERS, seeded=widths.SEEDED,
        light=widths.LIGHT, seconds=sum(result.seconds + result.seeded for result in results), results=results,
        missing=missing, digests=digests,
    )  # fmt: skip


def widths_before(digests: dict[str, str]) -> dict[tuple[str, int], widths.Result]:
    """Datapath and width -> the row of the page as it is, of those that are of the present code and tools."""
    text = WIDTHS_PAGE.read_text(encoding="utf-8") if WIDTHS_PAGE.exists() else ""
    if f", with {versions()};" not in text:
        return {}
    fresh = {name for name, digest in table(text, "code") if digests.get(name) == digest}
    rows = [
        widths.Result(datapath, int(width), *map(int, counts), float(seconds), float(seeded.removesuffix(" s")))
        for width, datapath, *counts, seconds, seeded in table(text, "width")
    ]
    return {(row.datapath, row.width): row for row in rows if f"{row.datapath}, W={row.width}" in fresh}


def every_width(options: Namespace) -> bool:
    """The fourth part; whether all is well."""
    chosen = [datapath for datapath in DATAPATHS if datapath in (options.only or widths.LIGHT)]
    lengths = [width for width in widths.OTHERS if not options.width or width in options.width]
    if options.part != "widths" and (options.only or options.width):
        return True
    if options.list:
        say("\n".join(f"{datapath:<16} W={width}" for datapath in chosen for width in lengths))
        return True
    before = widths.digests()
    with ThreadPoolExecutor(cpu_count()) as pool:
        try:
            found = [widths.run(datapath, width, pool, say, options.again) for datapath in chosen for width in lengths]
        except BaseException:
            running.stop()
            pool.shutdown(cancel_futures=True)
            raise
    if any(result.failed for result in found) or len(lengths) < len(widths.OTHERS):
        return not any(result.failed for result in found)
    pairs = [(datapath, width) for width in widths.OTHERS for datapath in DATAPATHS]
    earlier = widths_before(before)
    results = {pair: result for pair in pairs if (result := widths.recall(*pair) or earlier.get(pair))}
    absent = [f"{datapath} W={width}" for datapath, width in pairs if (datapath, width) not in results]
    now = {name: value for name, value in before.items() if name.replace(",", "") not in absent}
    return written(WIDTHS_PAGE, widths_page(list(results.values()), absent, now), before == widths.digests())


PARTS: dict[str, Callable[[Namespace], bool]] = {
    "streams": streams, "ranges": ranges, "arithmetic": numbers, "widths": every_width,
}  # fmt: skip


def formal(arguments: Sequence[str] | None) -> int:
    parser = Parser("formal", "Proofs on the Verilog, and that they fail on seeded bugs.", passes="all is proved")
    parser.add_argument("part", nargs="?", choices=PARTS, help="only this part (default: all)")
    about = "only proofs that begin so, a node (s, paper/s) or a datapath; no page"
    parser.add_argument("--only", metavar="NAME", action="append", default=[], help=about)
    parser.add_argument(
        "--width", type=word_length, action="append", metavar="W", help="ranges: only this word length; no page"
    )
    parser.add_argument("--again", action="store_true", help="also what has gone through before and has not changed")
    parser.add_argument("--list", action="store_true", help="only say what there is to prove")
    options = parser.parse_args(arguments)
    for name in options.only:
        nodes = [node for datapath in DATAPATHS for node in overflow.chosen(datapath, FULL, [name])]
        if not nodes and not any(proof.name.startswith(name) for proof in (*PROOFS, *ARITHMETIC)):
            raise InputError(f"argument --only: no proof or node {name!r}; --list says which there are")
    if not options.list and (absent := missing()):
        raise InputError(f"{', '.join(absent)} not installed here: `make formal` sets them up")
    parts = [options.part] if options.part else list(PARTS)
    return 0 if all([PARTS[part](options) for part in parts]) else 1


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit status."""
    running.stopped = False
    return exit_status("formal", lambda: formal(arguments))


if __name__ == "__main__":
    sys.exit(main())
