# SPDX-License-Identifier: Apache-2.0
"""Send targets over a serial port to a board that runs examples/icebreaker (`make -C examples/icebreaker send`).

Writes the same files as `make run DATAPATH=fold16 WIDTH=24`, except that score.json names "icebreaker" as the simulator
and has no clock counts, which the host cannot observe. Every answer is compared with the bit-true model.

The board drops frames (frames.py) with a wrong CRC. The host sends unanswered targets again.
"""

import os
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import closing

import click
import numpy as np
import serial

from examples.icebreaker.frames import WIDTH, Answers, frame
from model.dataflow import fixed
from model.dataflow.datapaths import FOLD16
from scripts.console import POSITIVE, InputError, Options, command, option, progress, show, trajectory_options, whole
from scripts.score_tables import table_of_many, table_of_one, verdict
from scripts.trajectory import SCORES, Prepared, csv_paths, outputs, prepare, score_runs, write_results
from tb.sim.simulate import LONG, Run, SimulationError

WINDOW = 64
"""Largest number of targets in flight. The board imposes no limit, because a target's frame, sent with two stop bits,
takes longer than its answer. A window far below 256 keeps the 8-bit tags unique."""
TRIES = 4  # transmissions of a target before the board counts as silent


class Board:
    """Board on a serial port. Raises InputError if the port cannot be opened."""

    def __init__(self, port: str, baud: int, timeout: float):
        self.name, self.timeout, self.again = port, timeout, 0
        try:
            stop = serial.STOPBITS_TWO
            self.port = serial.Serial(port, baud, stopbits=stop, timeout=min(0.02, timeout / 4), exclusive=True)
        except (OSError, ValueError) as exc:  # pyserial's exception is an OSError
            raise InputError(f"cannot open the serial port {port!r}: {_why(exc)}") from None

    def quiet(self) -> None:
        """Discard answers to an earlier host until the line is quiet. Raises SimulationError if the line stays busy."""
        end = time.monotonic() + self.timeout
        while self.port.read(4096):
            if time.monotonic() > end:
                raise SimulationError(f"{self.name} sends unrequested data: is it the right board?")

    def solve(self, words: np.ndarray, done: Callable[[int], None]) -> tuple[np.ndarray, np.ndarray]:
        """Return results (N, 6) and flags (N,) of target words (N, 6). After each answer, call ``done(n)``, n being the
        number of answers so far. Raises SimulationError if the board does not answer."""
        results, flags = np.zeros((len(words), 6), dtype=np.int64), np.zeros(len(words), dtype=np.int64)
        answers, waiting, sent, tries = Answers(), deque(range(len(words))), deque(), [0] * len(words)
        self.quiet()
        answered, heard = 0, time.monotonic()
        while answered < len(words):
            while len(sent) < WINDOW and waiting:
                target = waiting.popleft()
                if tries[target] == TRIES:
                    raise SimulationError(f"{self.name} does not answer target {target}, sent {TRIES} times")
                self.again += tries[target] > 0
                tries[target] += 1
                if not sent:
                    heard = time.monotonic()
                sent.append(target)
                self.port.write(frame(target % 256, words[target]))
            for tag, flag, result in answers(self.port.read(max(1, self.port.in_waiting))):
                place = next((k for k, target in enumerate(sent) if target % 256 == tag), None)
                if place is None:
                    continue  # late answer to a target already given up
                lost = [sent.popleft() for _ in range(place)]  # answers are in order: earlier targets are lost
                waiting.extendleft(reversed(lost))
                target = sent.popleft()
                results[target], flags[target] = result, flag
                answered += 1
                heard = time.monotonic()
                done(answered)
            if time.monotonic() - heard > self.timeout:
                waiting.extendleft(reversed(sent))
                sent.clear()
        return results, flags


def _why(error: BaseException) -> str:
    """Return the system's text for the errno (pyserial's text is for programmers), or str(error) if there is none."""
    numbers = [one.args[0] for one in (error, error.__context__) if one and one.args and isinstance(one.args[0], int)]
    return os.strerror(numbers[0]) if numbers else str(error)


def compared(words: np.ndarray, results: np.ndarray, flags: np.ndarray) -> Run:
    """Compare the board's answers with the bit-true model; return them as a Run, with the number of wrong bits."""
    model = fixed.run(words, WIDTH, FOLD16.name)
    wrong = np.column_stack(((results ^ model.results) & (1 << WIDTH) - 1, flags ^ model.flags))
    targets = np.flatnonzero(wrong.any(axis=1))
    first = f"first: target {targets[0]}" if len(targets) else None
    return Run(results, flags, None, None, sum(map(int.bit_count, wrong.ravel().tolist())), first)


def _through(board: Board, prepared: Sequence[Prepared]) -> list[Run]:
    """Send the targets of all trajectories; return one run per trajectory. Raises SimulationError."""
    total, before, runs = sum(len(item.words) for item in prepared), 0, []
    with closing(board.port), progress(f"{board.name}, {total} targets", total) as meter:
        for item in prepared:
            try:
                answers = board.solve(item.words, lambda done, before=before: meter(before + done))
            except OSError as exc:
                raise SimulationError(f"lost {board.name}: {_why(exc)}") from None
            runs.append(compared(item.words, *answers))
            before += len(item.words)
    return runs


@command(
    "icebreaker",
    [
        *trajectory_options("build/icebreaker", "results.csv and score.json", core=False),
        click.Argument(["port"]),
        option("--baud", "bits per second", whole(1), default=1000000, metavar="N"),
        option("--timeout", "seconds without answer before targets are sent again", POSITIVE, default=0.5, metavar="S"),
    ],
    passes="no trajectory fails",
    fails="one fails or the board does not answer",
)
def main(parsed: Options) -> int:
    parsed.sim, parsed.datapath, parsed.width = "icebreaker", FOLD16.name, WIDTH
    prepared = prepare(parsed)
    out = parsed.out
    with outputs(out, [out], prepared) as files:
        board = Board(parsed.port, parsed.baud, parsed.timeout)
        begin = time.monotonic()
        runs = _through(board, prepared)
        rate = sum(len(run.flags) for run in runs) / (time.monotonic() - begin)
        predict = sum(len(item.words) for item in prepared) < LONG
        done = score_runs(parsed, parsed.datapath, prepared, runs, predict)
        write_results(files, out, [out], prepared, [done])
    scores = [result for _, result in done]
    show(table_of_many(scores) if len(scores) > 1 else table_of_one(scores[0], runs[0].flags))
    print(f"{rate:.0f} targets a second through {parsed.port}, {board.again} sent again")
    for path in (*csv_paths(out, prepared), out / SCORES):
        print(f"wrote {path}")
    return verdict("icebreaker", scores)


if __name__ == "__main__":
    sys.exit(main())
