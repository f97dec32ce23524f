# SPDX-License-Identifier: Apache-2.0
"""BVH files: reader, writer and kinematics.

A node is a joint or an end site. Nodes are numbered in the order of the file, and their names need not be unique.  The
reader keeps the text before the motion table as it is, and the table as numbers, so the writer restores every value.
A position channel replaces its coordinate of OFFSET. Rotation channels are multiplied in the order of the file.
"""

import codecs
import re
from collections import deque
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..io.words import TargetError
from ..reference.kinematics import about, conjugate, matrix, multiply, rotate

COMMENT = re.compile(r"(?<!\S)(?:#|//).*")
WORD = re.compile(r"[{}]|[^\s{}]+")
TABLE = re.compile(r"(?im)^[^\S\n]*MOTION\s+Frames\s*:?\s*(\S+)\s+Frame\s*Time\s*:?\s*(\S+)")
CHANNEL = re.compile(r"([xyz])(position|rotation)", re.IGNORECASE)
PERIOD = 1 / 30  # seconds from frame to frame if the frame time of the file is not positive


class ClipError(TargetError):
    """Unusable clip or limb. The message is one line for the user."""


class Channel(NamedTuple):
    """Channel of a node. kind: "position" or "rotation"; axis: 0 to 2; column: number of its column in the table."""

    kind: str
    axis: int
    column: int


@dataclass
class Node:
    """Joint or end site. parent: number of the parent node, -1 for a root."""

    name: str
    parent: int
    end: bool
    offset: tuple[float, ...] = (0.0, 0.0, 0.0)
    channels: tuple[Channel, ...] = ()

    def of(self, kind: str) -> list[Channel]:
        return [channel for channel in self.channels if channel.kind == kind]


@dataclass(frozen=True, eq=False)
class Clip:
    """Clip of F frames, K nodes and C channels.

    * head: the text before the number of frames, and the text between this number and the table
    * table (F, C): positions, and rotations in degrees
    * notes: warnings about the file, each one line for the user
    * up: the up axis, as in :data:`kinematics.NAMED_AXES`
    """

    path: Path
    encoding: str
    head: tuple[str, str]
    nodes: tuple[Node, ...]
    table: np.ndarray
    frame_time: float
    notes: tuple[str, ...] = ()
    up: str = "y"

    @property
    def period(self) -> float:
        """Seconds from frame to frame."""
        return self.frame_time if self.frame_time > 0 else PERIOD

    @cached_property
    def names(self) -> list[str]:
        """Names of the nodes; an end site is named after its joint."""
        return [f"{self.nodes[node.parent].name} end" if node.end else node.name for node in self.nodes]

    @cached_property
    def parents(self) -> list[int]:
        return [node.parent for node in self.nodes]

    @cached_property
    def local(self) -> np.ndarray:
        """Quaternions (F, K, 4) of the nodes relative to their parents."""
        quaternions = np.tile((1.0, 0.0, 0.0, 0.0), (len(self.table), len(self.nodes), 1))
        for k, node in enumerate(self.nodes):
            for _, axis, column in node.of("rotation"):
                quaternions[:, k] = multiply(quaternions[:, k], about(axis, np.radians(self.table[:, column])))
        return quaternions

    @cached_property
    def places(self) -> np.ndarray:
        """Positions (F, K, 3) of the nodes relative to their parents, in the parents' axes."""
        positions = np.tile([node.offset for node in self.nodes], (len(self.table), 1, 1))
        for k, node in enumerate(self.nodes):
            for _, axis, column in node.of("position"):
                positions[:, k, axis] = self.table[:, column]
        return positions

    @cached_property
    def turn(self) -> np.ndarray:
        """Quaternions (F, K, 4) of the nodes relative to the world."""
        quaternions = self.local.copy()
        for k, parent in enumerate(self.parents):  # parents come first
            if parent >= 0:
                quaternions[:, k] = multiply(quaternions[:, parent], quaternions[:, k])
        return quaternions

    @cached_property
    def positions(self) -> np.ndarray:
        """Positions (F, K, 3) of the nodes in the world."""
        positions = self.places.copy()
        for k, parent in enumerate(self.parents):
            if parent >= 0:
                positions[:, k] = positions[:, parent] + rotate(self.turn[:, parent], positions[:, k])
        return positions

    @cached_property
    def rest(self) -> np.ndarray:
        """Positions (K, 3) of the nodes in the rest pose."""
        positions = np.array([node.offset for node in self.nodes])
        for k, parent in enumerate(self.parents):
            positions[k] += positions[parent] if parent >= 0 else 0
        return positions

    def ancestors(self, node: int) -> list[int]:
        """Return the ancestors of a node, from the parent up to the root."""
        nodes = []
        while (node := self.parents[node]) >= 0:
            nodes.append(node)
        return nodes

    def can_turn(self, node: int) -> bool:
        """Return whether a node has one rotation channel for each axis, so that it can take any orientation."""
        return sorted(channel.axis for channel in self.nodes[node].of("rotation")) == [0, 1, 2]

    def turned(self, turn: dict[int, np.ndarray]) -> "Clip":
        """Return the clip with new orientations of some nodes. turn: node -> quaternions (F, 4) in the world. Only the
        channels of these nodes change."""
        table, world = self.table.copy(), self.turn.copy()
        for k, parent in enumerate(self.parents):
            above = world[:, parent] if parent >= 0 else (1.0, 0.0, 0.0, 0.0)
            if k in turn:
                world[:, k] = turn[k]
                _, axes, columns = map(list, zip(*self.nodes[k].of("rotation"), strict=True))
                angles = _angles(matrix(multiply(conjugate(above), turn[k])), axes, np.radians(table[:, columns]))
                table[:, columns] = np.round(np.degrees(angles), 11)
            else:
                world[:, k] = multiply(above, self.local[:, k])
        return replace(self, table=table)

    def content(self) -> bytes:
        """Return the content of the BVH file."""
        end = "\r\n" if "\r\n" in self.head[1] else "\n"
        rows = (" ".join(map(repr, row)) for row in self.table.tolist())
        return f"{self.head[0]}{len(self.table)}{self.head[1]}{end}{end.join(rows)}{end}".encode(self.encoding)


def _angles(turn: np.ndarray, axes: list[int], near: np.ndarray) -> np.ndarray:
    """Return angles (F, 3), rad, for which the rotations about three different ``axes`` have the product ``turn``
    (F, 3, 3). Of all solutions, the angles nearest to ``near`` (F, 3) are returned."""
    i, j, k = axes
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    locked = np.hypot(turn[:, j, k], turn[:, k, k]) < 1e-7
    first = np.where(locked, near[:, 0], np.arctan2(-sign * turn[:, j, k], turn[:, k, k]))
    left = np.swapaxes(matrix(about(i, first)), 1, 2) @ turn  # = R_j R_k
    second = np.arctan2(sign * left[:, i, k], left[:, k, k])
    third = np.arctan2(sign * left[:, j, i], left[:, j, j])
    angles = np.column_stack((first, second, third))
    both = np.stack((angles, angles * (1, -1, 1) + np.pi))  # the same rotation
    both -= 2 * np.pi * np.rint((both - near) / (2 * np.pi))
    nearest = np.argmin(np.abs(both - near).sum(axis=2), axis=0)
    return both[nearest, np.arange(len(angles))]


def parse(content: bytes, path: Path) -> Clip:
    """Parse the content of a BVH file.  Raises :class:`ClipError`, which names ``path`` and usually the line."""
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    encoding = "utf-16" if wide else "utf-8-sig" if content.startswith(codecs.BOM_UTF8) else "utf-8"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        text, encoding = content.decode("latin-1"), "latin-1"
    if "\0" in text:
        raise ClipError(f"{path}: not a BVH clip: the file is not text")
    return _Parser(path, text, encoding).clip()


class _Parser:
    """Parser of a BVH file. `plain` is `text` with comments blanked out, so positions in both agree."""

    def __init__(self, path: Path, text: str, encoding: str) -> None:
        self.path, self.text, self.encoding = path, text, encoding
        lines = text if "\n" in text else text.replace("\r", "\n")
        self.plain = COMMENT.sub(lambda comment: " " * len(comment[0]), lines)
        self.table = TABLE.search(self.plain)
        hierarchy = self.plain[: self.table.start() if self.table else None].split("\n")
        self.left = deque((n, word) for n, line in enumerate(hierarchy, 1) for word in WORD.findall(line))
        self.line, self.word, self.joint = 1, "", ""  # of the last word taken
        self.nodes: list[Node] = []
        self.joint_of_column: list[str] = []

    def error(self, message: str) -> ClipError:
        return ClipError(f"{self.path}: line {self.line}{self.joint and f', joint {self.joint}'}: {message}")

    def wrong(self, expected: str) -> ClipError:
        return self.error(f"{self.word[:40]!r} is not {expected}")

    def take(self, expected: str) -> str:
        """Take and return the next word of the hierarchy.  expected: what it should be, for the error message."""
        if not self.left:
            raise self.error(f"the hierarchy ends where {expected} is expected")
        self.line, self.word = self.left.popleft()
        return self.word

    def number(self, word: str) -> float:
        """Return a word as a number. Its absolute value must be below 1e30, so that products stay finite."""
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not abs(value) < 1e30 or "_" in word:
            raise self.error(f"{word[:40]!r} is not a finite number")
        return value

    def label(self) -> str:
        """Take the words up to the end of the line or a brace; return them as one name."""
        line, words = self.line, []
        while self.left and self.left[0][0] == line and self.left[0][1] not in "{}":
            words.append(self.take("a name"))
        return " ".join(words)

    def hierarchy(self) -> None:
        """Read the nodes and their channels."""
        if self.left and self.left[0][1].upper() == "HIERARCHY":
            self.left.popleft()
        inside: list[int] = []
        while self.left or inside:
            node = self.nodes[inside[-1]] if inside else None
            self.joint = (node.name or "end site") if node else ""
            match self.take("}").lower(), node:
                case ("root", None) | ("joint" | "end", Node(end=False)):
                    end = self.word.lower() == "end"
                    inside.append(len(self.nodes))
                    name = self.label()
                    self.nodes.append(Node("" if end else name, inside[-2] if inside[1:] else -1, end))
                    if self.take("{") != "{":
                        raise self.wrong("{")
                case "offset", Node():
                    x, y, z = (self.number(self.take("a number")) for _ in "xyz")
                    node.offset = x, y, z
                case "channels", Node():
                    count = self.number(self.take("a number"))
                    if count % 1 or count < 0:
                        raise self.wrong("a whole number")
                    for _ in range(int(count)):
                        if not (kind := CHANNEL.fullmatch(self.take("a channel"))):
                            raise self.wrong("a position or rotation channel")
                        channel = Channel(kind[2].lower(), "xyz".index(kind[1].lower()), len(self.joint_of_column))
                        node.channels += (channel,)
                        self.joint_of_column.append(node.name)
                case "}", Node():
                    inside.pop()
                case "motion", None:
                    raise self.error("MOTION without 'Frames:' and 'Frame Time:'")
                case _:
                    raise self.wrong("OFFSET, CHANNELS, JOINT, End Site or }" if node else "ROOT")

    def clip(self) -> Clip:
        self.hierarchy()
        if not self.nodes or self.table is None:
            raise ClipError(f"{self.path}: not a BVH clip: {'MOTION' if self.nodes else 'ROOT'} is missing")
        stated = []
        for n in (1, 2):
            self.line, self.joint = self.plain.count("\n", 0, self.table.end(n)) + 1, ""
            stated.append(self.number(self.table[n]))
        count, period = stated
        rows, notes = self.rows(count)
        if not rows:
            raise ClipError(f"{self.path}: {' '.join(notes) or 'the clip has no frames'}")
        if count != len(rows):
            notes.append(f"'Frames: {self.table[1]}' is wrong; number of frames in the file: {len(rows)}")
        if period <= 0:
            notes.append(f"'Frame Time: {self.table[2]}' is not positive: {1 / PERIOD:g} frames per second are assumed")
        start, end = self.table.span(1)
        head = self.text[:start], self.text[end : self.table.end()]
        return Clip(self.path, self.encoding, head, tuple(self.nodes), np.array(rows), period, tuple(notes))

    def rows(self, count: float) -> tuple[list[list[float]], list[str]]:
        """Return the table's rows, which may be wrapped over lines, and notes.  count: the stated number of frames."""
        if not (channels := len(self.joint_of_column)):
            raise ClipError(f"{self.path}: no joint has channels")
        text = self.plain[self.table.end() :].split("\n") if self.table else []
        lines = [(number, words) for number, line in enumerate(text, self.line) if (words := line.split())]
        lengths = [len(words) for _, words in lines]
        if channels not in lengths and sum(lengths) == channels * count:  # line breaks are not row breaks
            lines = [(number, [word]) for number, words in lines for word in words]
        rows: list[list[float]] = []
        row: list[float] = []
        began = 0
        for self.line, words in lines:
            began = began if row else self.line
            if len(row) + len(words) > channels:
                self.line, self.joint = began, ""
                raise self.error(f"expected {channels} numbers, one per channel, got {len(row) or len(words)}")
            for word in words:
                self.joint = self.joint_of_column[len(row)]
                row.append(self.number(word))
            if len(row) == channels:
                rows.append(row)
                row = []
        note = f"line {began}: expected {channels} numbers, one per channel, got {len(row)}: the frame is ignored"
        return rows, [note] if row else []
