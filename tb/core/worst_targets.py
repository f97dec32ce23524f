# SPDX-License-Identifier: Apache-2.0
"""The soak without its command line: random targets in chunks, checks of the RTL's results, a list of hard targets.

Bits, flags and norms are checked for every target, hand errors where `model.bounds.tolerances` has a tolerance.

``tb/core/worst_targets.csv`` is the regression list of the hardest targets found so far. ``python -m scripts.soak
--keep`` writes it; tb/core/test_every_node.py runs it. A reachable target is hard if its quaternions are far from unit
length, or if its hand error is large relative to the tolerance (in paper to the predicted error, for hand poses to the
reach). A row holds the datapath, the word length, the input words, the model's hand error / reach, and where the target
was found. In the row of a hand pose, the last input word is the branch, and the error is relative to the tolerance.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from model.bounds import tolerances
from model.dataflow import fixed
from model.dataflow.datapaths import MODELS
from model.dataflow.formats import WIDTHS
from model.io import files, stimuli
from model.io.flags import FLAGS, OVER_BIT, UNREACHABLE, expected_flags, names
from model.io.scoring import hand_errors
from model.io.words import ARM_FIELDS, FIELDS, TargetError, from_words, result_values
from tb.sim import native_run
from tb.sim.env import ROOT
from tb.sim.job import answer, usual_limits
from tb.sim.simulate import Run, SimulationError, simulate

LIST = ROOT / "tb" / "core" / "worst_targets.csv"
COLUMNS = ("datapath", "width", *FIELDS, *ARM_FIELDS[len(FIELDS) :], "branch", "hand_error", "found")
"""Columns of the list. The columns from tool to branch are empty for wrist targets."""

KEPT = 10  # targets kept for each measure of hardness, per datapath and word length

CHUNK = 20000  # targets per chunk

CANDIDATES = 1000
"""Number of a chunk's targets, with the largest hand errors, ranked by error / tolerance (paper: predicted error)."""


def chunk(number: int, width: int, seed: int | None, count: int = CHUNK) -> np.ndarray:
    """Return chunk `number`: shuffled targets (count, 6) from `model.io.stimuli`. Half of them lie in `REGIONS`, most
    of which are near singular poses; `unreachable`, `edges` and `extremes` supply an eighth each, and `corners` and
    `random_reachable` the rest.

    Without a seed, return part `number` of all targets made of special words, in order."""
    if seed is None:
        return stimuli.of_special(number * count, count, width)
    chunk_seed = int(np.random.SeedSequence((seed, number)).generate_state(1, np.uint64)[0])
    named = np.array(list(stimuli.corners(width).values()), dtype=np.int64)
    parts = [stimuli.region(name, count // 2 // len(stimuli.REGIONS), width, chunk_seed) for name in stimuli.REGIONS]
    parts += [make(count // 8, width, chunk_seed) for make in (stimuli.unreachable, stimuli.edges, stimuli.extremes)]
    parts.append(named[: count // 8])
    parts.append(stimuli.random_reachable(count - sum(map(len, parts)), width, chunk_seed))
    return np.random.default_rng((chunk_seed, width)).permutation(np.concatenate(parts))


class Hard(NamedTuple):
    """Reachable target: a measure of hardness, its number in the sequence, and its hand error."""

    hardness: float
    target: int
    words: list[int]
    hand_error: float


@dataclass
class Found:
    """Totals of a set of targets.

    * `above`: number of targets whose hand error exceeds the tolerance or, for paper, the predicted error
    * `by_hand`, `by_norm`: hardest targets by hand error / tolerance, and by norm error
    * `flags`: number of targets with each flag
    """

    targets: int = 0
    reachable: int = 0
    above: int = 0
    hand_error_max: float = 0.0
    norm_error_max: float = 0.0
    by_hand: list[Hard] = field(default_factory=list)
    by_norm: list[Hard] = field(default_factory=list)
    flags: Counter[str] = field(default_factory=Counter)

    def __add__(self, other: Found) -> Found:
        return Found(
            self.targets + other.targets,
            self.reachable + other.reachable,
            self.above + other.above,
            max(self.hand_error_max, other.hand_error_max),
            max(self.norm_error_max, other.norm_error_max),
            _hardest(self.by_hand + other.by_hand),
            _hardest(self.by_norm + other.by_norm),
            self.flags + other.flags,
        )


def _hardest(targets: list[Hard]) -> list[Hard]:
    once = {tuple(hard.words): hard for hard in sorted(targets, key=lambda hard: -hard.target)}
    return sorted(once.values(), key=lambda hard: (-hard.hardness, hard.target))[:KEPT]


@dataclass(frozen=True)
class Failure:
    """Failed check: lines for the user, and indices of the failing targets, in order or (large errors) worst first."""

    lines: list[str]
    rows: list[int]


@dataclass(frozen=True)
class Core:
    """Core to simulate: simulator, datapath, word length, and with Verilator the native program."""

    sim: str
    datapath: str
    width: int
    program: Path | None = None

    @classmethod
    @cache
    def built(cls, sim: str, datapath: str, width: int) -> Core:
        return cls(sim, datapath, width, native_run.program(datapath, width) if sim == "verilator" else None)

    def run(self, words: np.ndarray) -> tuple[Run, np.ndarray, np.ndarray]:
        """Return the RTL's run, and the model's results (N, words) and flags (N,). Where the core chooses the branch,
        poses get random reference joints. Raises SimulationError."""
        if MODELS[self.datapath].chooses:
            words = stimuli.referenced(words, self.width, int(np.abs(words[0]).sum()))
        frames = list(native_run.answered(words, self.width, self.datapath))
        if self.program:
            run = native_run.compare(self.program, frames, self.width, self.datapath)
        else:
            (run,) = simulate([words], simulator=self.sim, datapath=self.datapath, width=self.width)
        return run, *(np.concatenate([getattr(answer, part) for _, answer in frames]) for part in ("results", "flags"))

    def __str__(self) -> str:
        return f"{self.datapath} datapath, {self.width} bits, {self.sim}"


def judge(core: Core, words: np.ndarray, numbers: Sequence[int]) -> tuple[Found, list[Failure]]:
    """Run targets and check their results; return the totals and the failed checks.

    `numbers` (N,) are the targets' positions in their sequence. Raises SimulationError, also for lost results.
    """
    run, results, flags = core.run(words)
    path = MODELS[core.datapath]
    if run.results.shape != (len(words), len(path.results)) or run.flags.shape != (len(words),):
        raise SimulationError(f"{len(words)} targets were sent, {len(run.results)} results came back")
    hand, norm = errors(words, run.results, core.width, run.flags)
    reachable = np.flatnonzero(~np.isnan(hand))
    candidates = reachable[np.argsort(-hand[reachable], kind="stable")][:CANDIDATES]
    tolerance = np.full(len(words), np.inf)
    tolerance[candidates] = tolerances.scale(words[candidates], core.width, core.datapath)
    above = candidates[hand[candidates] > tolerance[candidates]]

    failures = []
    differs = (run.results != results).any(axis=1) | (run.flags != flags)
    if run.bit_mismatches or differs.any():
        failures.append(_bits_failure(run, np.flatnonzero(differs).tolist(), numbers))
    if path.side:  # flags of the core are compared with the model's only
        turn, joints = 1 << core.width, np.arange(7)
        low, high = np.array(usual_limits(core.datapath, core.width)).T
        over = (run.results[:, joints] - low) % turn > (high - low) % turn
        owed = run.flags & ~(127 << OVER_BIT) | (over << OVER_BIT + joints).sum(axis=1)
    else:
        owed = expected_flags(words, core.width)
    wrong = np.flatnonzero(run.flags != owed)
    if len(wrong):
        n = int(wrong[0])
        message = f"flags {names(int(run.flags[n]))} instead of {names(int(owed[n]))} ({len(wrong)} targets)"
        failures.append(Failure([message], wrong.tolist()))
    if tolerances.hand(core.width, core.datapath) is not None:
        failures += _above(f"{path.error} {{:.3e}} is above its tolerance", hand, tolerance, above)
    most = np.full(len(words), tolerances.norm(core.width, core.datapath))
    failures += _above("abs(norm^2 - 1) {:.3e} is above its tolerance", norm, most, np.flatnonzero(~(norm <= most)))

    def hardest(rows: np.ndarray, hardness: np.ndarray) -> list[Hard]:
        first = np.argsort(-hardness, kind="stable")[:KEPT]
        columns = hardness[first], *(column[rows[first]] for column in (np.asarray(numbers), words, hand))
        return list(map(Hard, *(column.tolist() for column in columns)))

    by_hand = hardest(candidates, hand[candidates] / tolerance[candidates])
    by_norm = hardest(reachable, norm[reachable])
    largest = float(hand[reachable].max(initial=0.0)), float(norm.max(initial=0.0))
    flagged = Counter({name: int(np.count_nonzero(run.flags & flag)) for name, flag in FLAGS.items()})
    totals = Found(len(words), len(reachable), len(above), *largest, by_hand, by_norm, flagged)
    return Found() + totals, failures


def _above(message: str, error: np.ndarray, most: np.ndarray, rows: np.ndarray) -> list[Failure]:
    """Return one failure for the targets `rows`, whose errors are too large, worst first; none if `rows` is empty."""
    if not len(rows):
        return []
    worst = rows[np.argsort(-error[rows] / most[rows], kind="stable")].tolist()
    return [Failure([f"{message.format(error[worst[0]])} {most[worst[0]]:.3e} ({len(rows)} targets)"], worst)]


_TARGET = re.compile(r"(?<= of target )\d+")


def _bits_failure(run: Run, differing: list[int], numbers: Sequence[int]) -> Failure:
    """Return the failure for differing bits. Its lines use the targets' ``numbers``, not their positions in the run."""
    lines = [f"{run.bit_mismatches} bits differ from the bit-true model, results of {len(differing)} targets"]
    first = run.first_mismatch or ""
    named = [int(n) for n in _TARGET.findall(first)[:1]]
    lines += _TARGET.sub(lambda match: str(numbers[int(match[0])]), first).splitlines()
    return Failure(lines, list(dict.fromkeys(named + differing)))


@dataclass(frozen=True)
class Row:
    """Listed target."""

    datapath: str
    width: int
    words: tuple[int, ...]
    hand_error: float
    found: str


def errors(
    words: np.ndarray, results: np.ndarray, width: int, flags: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return two arrays (N,): hand error / reach (nan if out of reach), and the quaternions' larger abs(norm^2 - 1).

    The whole arm needs ``flags``; the larger of its :func:`tolerances.pose_errors` replaces hand error / reach.
    """
    arm = words.shape[1] > len(FIELDS)
    quaternions = result_values(results[:, 7:13] if arm else results, width)
    if arm:
        hand = np.maximum(*tolerances.pose_errors(words, results, flags, width))
    else:
        reachable = expected_flags(words, width) & UNREACHABLE == 0
        hand = np.full(len(words), np.nan)
        hand[reachable] = hand_errors(quaternions[reachable], from_words(words[reachable], 0, width, "reachable"))
    return hand, np.maximum(*(np.abs((q**2).sum(axis=1) - 1) for q in (quaternions[:, :4], quaternions[:, 4:])))


def arm_errors(words: np.ndarray, run: fixed.Answer, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return errors of poses and their tolerances, each (2, N). Row 0: hand's point / reach; row 1: orientation (rad).

    An error is set to 0 where :func:`tolerances.pose_errors` excludes the pose, and where the reach is below 2^(W-2)
    ulps: there, merely rounding the wrist to words causes an error that is large compared with the reach."""
    reach = words[:, 4] + words[:, 5] + np.abs(words[:, 6])
    permitted = np.array([np.broadcast_to(most, reach.shape) for most in tolerances.arm(words, width)])
    permitted[0] /= np.maximum(reach, 1)
    relative = tolerances.pose_errors(words, run.results, run.flags, width)
    return np.nan_to_num(relative) * permitted * (reach >= 1 << width - 2), permitted


def array(rows: Iterable[Row]) -> np.ndarray:
    """Return the input words of rows: wrist targets (N, 6), or poses with their branch (N, 12)."""
    return np.array([row.words for row in rows], dtype=np.int64)


def groups(rows: Iterable[Row]) -> dict[tuple[str, int], list[Row]]:
    """Group rows by (datapath, width), sorted by this key."""
    grouped: dict[tuple[str, int], list[Row]] = {}
    for row in rows:
        grouped.setdefault((row.datapath, row.width), []).append(row)
    return dict(sorted(grouped.items()))


def read(path: Path) -> list[Row]:
    """Read the rows of a list file. Raises OSError, and TargetError for wrong contents."""
    rows, line = [], 1
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            for line, cells in enumerate(csv.reader(stream, strict=True), 1):
                if line > 1:
                    rows.append(_row(cells))
                elif tuple(cells) != COLUMNS:
                    raise ValueError(f"the header has to be {','.join(COLUMNS)}")
    except (csv.Error, ValueError) as error:
        raise TargetError(f"{path}: not a CSV file of targets: row {line}: {error}") from None
    return rows


def _row(cells: list[str]) -> Row:
    if len(cells) != len(COLUMNS):
        raise ValueError(f"{len(cells)} columns instead of {len(COLUMNS)}")
    datapath, *_, error, found = cells
    if datapath not in MODELS:
        raise ValueError(f"unknown datapath {datapath!r}")
    columns = COLUMNS[1:-2] if MODELS[datapath].side else COLUMNS[1 : 2 + len(FIELDS)]
    for name, cell in zip(columns, cells[1:], strict=False):
        if not re.fullmatch(r"-?\d+", cell):
            raise ValueError(f"column {name}: {cell!r} is not a whole number")
    width, *words = map(int, cells[1 : 1 + len(columns)])
    if width not in WIDTHS:
        raise ValueError(f"unknown width {width}")
    if not all(-(1 << (width - 1)) <= word < 1 << (width - 1) for word in words):
        raise ValueError(f"a word does not fit {width} bits")
    return Row(datapath, width, tuple(words), files.number(error), found)


def text(rows: Iterable[Row]) -> str:
    """Return the contents of the list file for these rows."""
    out = io.StringIO()
    write = csv.writer(out, lineterminator="\n").writerow
    write(COLUMNS)
    for row in rows:
        words = [*row.words, *[""] * (len(COLUMNS) - 4 - len(row.words))]
        write((row.datapath, row.width, *words, _written(row.hand_error), row.found))
    return out.getvalue()


def _written(error: float) -> str:
    return f"{error:.6e}"


def merge(rows: Iterable[Row]) -> list[Row]:
    """Return the hardest rows of each datapath and word length: ``KEPT`` by hand error / tolerance (for hand poses, by
    the larger of the :func:`arm_errors`), and ``KEPT`` more by norm error. The order of ``rows`` has no effect. Hand
    errors are recomputed."""
    kept = []
    for (datapath, width), group in groups(rows).items():
        # Keep one row of a target found more than once: the first by `found`.
        once = {row.words: row for row in sorted(group, key=lambda row: (row.words, row.found), reverse=True)}
        unique = [once[words] for words in sorted(once)]
        words = array(unique)
        run = answer(words, width, datapath)
        hand, norm = errors(words, run.results, width, run.flags)
        if MODELS[datapath].side:
            hardness = arm_errors(words, run, width)[0].max(axis=0)
        else:  # row by row: the random endpoints that predicted_error tries depend on a target's index in the array
            hardness = hand / np.concatenate([tolerances.scale(word[None], width, datapath) for word in words])
        reachable = np.flatnonzero(~np.isnan(hand))
        by_hand = reachable[np.argsort(-hardness[reachable], kind="stable")]
        by_norm = reachable[np.argsort(-norm[reachable], kind="stable")]
        chosen = by_hand[:KEPT].tolist()
        chosen += [n for n in by_norm.tolist() if n not in chosen][:KEPT]
        chosen.sort(key=lambda n: (-float(_written(hand[n])), unique[n].words))
        kept += [replace(unique[n], hand_error=float(hand[n])) for n in chosen]
    return kept
