# SPDX-License-Identifier: Apache-2.0
"""Targets in the user's units, the fixed-point words of the core, and the records of `ik_axi` in memory.

Lengths x, y, z, d1, d2 are signed words of `width` bits with `width`-2 fraction bits: range [-2, 2). phi is a signed
binary angle, one turn = 2^width. The user's lengths may have any unit: `scale_exponent` chooses one power of two that
brings all lengths of a set of targets into the format.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..reference.joints import BRANCHES, JOINTS
from ..reference.kinematics import conjugate, matrix, multiply, rotate
from .flags import BAD_HAND, OVER_BIT

FIELDS = ("x", "y", "z", "phi", "d1", "d2")
"""Columns of a target file and fields of a target word, lowest bits first."""

RESULT_FIELDS = ("qs_w", "qs_i", "qs_j", "qs_k", "qe_w", "qe_i")
"""Fields of a result word, lowest bits first; all signed with width-2 fraction bits."""

ARMS = ("d1", "d2")  # arm lengths; unless both are positive, the target is clamped

LENGTHS = ("x", "y", "z", *ARMS)

ARM_FIELDS = ("hand_x", "hand_y", "hand_z", "phi", "d1", "d2", "tool", "qh_w", "qh_i", "qh_j", "qh_k")
"""Fields of a target word of the whole arm, lowest bits first; all but phi have width-2 fraction bits."""

WRIST_FIELDS = ("qw_w", "qw_i", "qw_j", "qw_k")  # components of the wrist's quaternion

ARM_RESULT_FIELDS = (*JOINTS, *RESULT_FIELDS, *WRIST_FIELDS)
"""Fields of a result word of the whole arm, lowest bits first."""

CHOICE_FIELDS = (*(f"joint_{k}" for k in range(1, 8)), *RESULT_FIELDS, *WRIST_FIELDS)
"""Fields of a result word if the core chooses the branch: `joint_k` are the joints in the chosen branch."""

REFERENCES = tuple(f"ref_{k}" for k in range(1, 8))
"""Reference joints of a hand pose, for the choice of its branch; binary angles."""

DEFAULT_D1, DEFAULT_D2 = 0.33, 0.27  # bone lengths of the default arm (m); its reach is 0.6 m, as in the paper

LENGTH_TOLERANCE = 2.0**-8
"""Largest difference of a hand quaternion's length from 1; beyond it, `ik_arm` sets the flag bad_hand."""

HEADROOM_BITS = 4
"""Maximum number of low bits that the scaling gives up for targets beyond the arm's reach, and again for tools."""

SHOWN = 40  # characters of a bad value that a message repeats


class TargetError(ValueError):
    """Invalid target or target file. The text is one line for the user."""


@dataclass(frozen=True, eq=False)
class Targets:
    """N targets in the user's units; x, y, z, phi, d1, d2 are float64 arrays (N,).

    * path, rows: target file and line numbers, for messages; None for targets created in Python
    * default_arm: names of the lengths that have default values; others: additional columns of the file
    * frame (4,) or (N, 4): quaternion of R, which rotates the user's frame to the core's frame; None: equal frames
    * arm (N,): name of each target's arm; None: all targets have the same arm
    * hand (N, 4): unit quaternions in the user's frame; x, y, z is then the hand's point. None: wrist targets
    * tool (N, 3): vector from the wrist to the hand's point in the hand's frame; a number is a length along z
    * branch (N,): bits of :class:`Branch`, for hand poses
    * origin (3,): the shoulder in the user's frame; 0: the shoulder is the frame's origin
    """

    name: str
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    phi: np.ndarray
    d1: np.ndarray
    d2: np.ndarray
    path: str | None = None
    rows: np.ndarray | None = None
    default_arm: tuple[str, ...] = ()
    others: dict[str, list[str]] = field(default_factory=dict)
    frame: np.ndarray | None = None
    arm: np.ndarray | None = None
    hand: Any = None
    tool: Any = 0.0
    branch: Any = 0
    origin: np.ndarray | float = 0.0

    def __post_init__(self) -> None:
        """Broadcast the columns, hand, tool and branch to N targets. Raises ValueError for shapes that do not match."""
        columns = [np.asarray(getattr(self, name), dtype=np.float64) for name in FIELDS]
        shape = np.broadcast_shapes((1,), *(column.shape for column in columns))
        if len(shape) != 1:
            raise ValueError(f"targets are one-dimensional, not of shape {shape}")
        for name, column in zip(FIELDS, columns, strict=True):
            object.__setattr__(self, name, np.broadcast_to(column, shape).copy())
        if self.hand is not None:
            tool = np.asarray(self.tool, dtype=np.float64)
            tool = tool if tool.ndim == 2 else np.multiply.outer(tool, (0.0, 0.0, 1.0))
            for name, value, wide in (("hand", self.hand, (4,)), ("tool", tool, (3,)), ("branch", self.branch, ())):
                object.__setattr__(self, name, np.broadcast_to(value, shape + wide))

    def __len__(self) -> int:
        return len(self.x)

    @property
    def position(self) -> np.ndarray:
        """Wrist targets, or the points of hand poses, shape (N, 3), in the user's unit and frame."""
        return np.column_stack((self.x, self.y, self.z))

    @property
    def paths(self) -> list[np.ndarray]:
        """Row numbers of each path; the column ``path`` names the path of a row."""
        labels = np.array(self.others.get("path", [""] * len(self)))
        return [np.flatnonzero(labels == one) for one in dict.fromkeys(labels.tolist())]

    @property
    def arm_note(self) -> str:
        """Note for messages about the arm, with the names of its defaulted lengths."""
        return f" (by default {' and '.join(self.default_arm)})" if self.default_arm else ""

    @property
    def core_position(self) -> np.ndarray:
        """Positions relative to the shoulder, shape (N, 3), in the core's frame; exact if R only exchanges axes."""
        return self.points_to_core(self.position - self.origin)

    @property
    def core_hand(self) -> np.ndarray:
        """Orientations of the hand, shape (N, 4), in the core's frame."""
        return self.hand if self.frame is None else multiply(self.frame, self.hand)

    @property
    def core_wrist(self) -> np.ndarray:
        """Wrist targets, shape (N, 3), in the core's frame."""
        return self.core_position if self.hand is None else self.core_position - rotate(self.core_hand, self.tool)

    @property
    def core_point(self) -> np.ndarray:
        """Points for the core, shape (N, 3), in its frame; for hand poses the end of the tool's z component."""
        across = None if self.hand is None else self.tool * (1.0, 1.0, 0.0)
        return self.core_position if across is None else self.core_position - rotate(self.core_hand, across)

    def points_to_core(self, points: np.ndarray) -> np.ndarray:
        """Return points (N, 3) of the user's frame, rotated to the core's frame."""
        return points if self.frame is None else (matrix(self.frame) @ points[:, :, None])[:, :, 0]

    def from_core(self, qs: np.ndarray) -> np.ndarray:
        """Return the core's shoulder quaternions (N, 4), rotated to the user's frame: R~ Qs."""
        return qs if self.frame is None else multiply(conjugate(self.frame), qs)

    def points_from_core(self, points: np.ndarray) -> np.ndarray:
        """Return points (N, 3) of the core's frame, rotated to the user's frame."""
        return points if self.frame is None else rotate(conjugate(self.frame), points)

    @property
    def reach(self) -> np.ndarray:
        """Reach d1 + d2, shape (N,), in the user's unit."""
        return self.d1 + self.d2

    def error(self, n: int, column: str, reason: str) -> TargetError:
        """Return the TargetError for the value in `column` of target `n` (counted from 0)."""
        value = repr(float(np.ravel(getattr(self, column)[n])[-1]))  # for a tool, its length along z
        if self.rows is None:
            return TargetError(f"{self.name}: target {n}, column {column}: '{value}' {reason}")
        return cell_error(self.path, int(self.rows[n]), column, value, reason)


def angle_doubt(angles: np.ndarray, name: str = "phi") -> str:
    """Return a warning if an angle exceeds a turn, which suggests degrees, or an empty string."""
    turns = float(np.abs(angles).max(initial=0.0))
    return f"{name} reaches {turns:g}; its unit is the radian: convert degrees" if turns > 2 * math.pi else ""


def cell_error(path: str | None, row: int, column: str, value: str, reason: str) -> TargetError:
    """Return the TargetError for a value of a file; long values are shortened."""
    shown = value if len(value) <= SHOWN else value[:SHOWN] + "..."
    return TargetError(f"{path}: row {row}, column {column}: {shown!r} {reason}")


@np.errstate(over="ignore", under="ignore")  # numbers beyond double precision are inf, which fits no format
def scale_exponent(targets: Targets, width: int) -> int:
    """Return the exponent e of the host's scaling: the core works on lengths times 2^e.

    The largest reach d1+d2 is scaled to [1, 2). If a coordinate would then leave [-2, 2), e is lowered by at most
    `HEADROOM_BITS`; a tool may lower it by up to `HEADROOM_BITS` more. Each step costs one bit of precision. Raises
    TargetError if that is insufficient, if a reach exceeds double precision, or if an arm length's word would be 0.
    """
    reach = targets.reach
    longest = int(np.argmax(reach))
    if not np.isfinite(reach[longest]):
        raise targets.error(longest, "d1", "is too long: d1+d2 is beyond double precision")
    arm = f"the longest arm, {reach[longest]:.6g}{targets.arm_note}"
    largest = 1 - math.frexp(reach[longest])[1]
    position = targets.core_point
    for exponent in range(largest, largest - HEADROOM_BITS - 1, -1):
        scaled = np.ldexp(position, exponent)
        outside = np.any((scaled < -2) | (scaled >= 2), axis=1)
        if not outside.any():
            break
    else:
        size = np.where(outside[:, None], np.abs(targets.position), 0)
        n, axis = np.unravel_index(np.argmax(size), size.shape)
        edge = f"{math.ldexp(2.0, -exponent):.6g}"
        reason = f"is too far out: for {arm}, the core's number format ranges from -{edge} to {edge}"
        raise targets.error(int(n), FIELDS[axis], reason)

    for column in ARMS:
        words = _quantise(np.ldexp(getattr(targets, column), exponent), width)
        if not words.all():
            reason = f"is too short: at the scale of {arm}, it rounds to 0 in {width} bits"
            raise targets.error(int(np.argmin(words != 0)), column, reason)
    tools = np.zeros(1) if targets.hand is None else np.abs(targets.tool[:, 2])
    most = int(np.argmax(tools))
    least = 1 - math.frexp(tools[most])[1] if tools[most] else exponent
    if least < exponent - HEADROOM_BITS:
        raise targets.error(most, "tool", "is too long for the format that fits this arm")
    return min(exponent, least)


def _quantise(values: np.ndarray, width: int) -> np.ndarray:
    """Return `values` in [-2, 2) as int64 words with width-2 fraction bits, rounded half to even and saturated."""
    words = np.rint(np.ldexp(values, width - 2))
    return np.clip(words, -(2 ** (width - 1)), 2 ** (width - 1) - 1).astype(np.int64)


def to_words(targets: Targets, width: int, exponent: int | None = None) -> tuple[np.ndarray, int]:
    """Return the core's input words and the exponent of the scaling.

    The words (N, 6) are int64, columns as `FIELDS`; for hand poses (N, 12), columns as `ARM_FIELDS` and the branch.
    Lengths are rounded half to even, angles wrap. If `exponent` is None, `scale_exponent` chooses it and may raise
    TargetError.
    """
    if exponent is None:
        exponent = scale_exponent(targets, width)
    lengths = _quantise(np.ldexp(np.column_stack((targets.core_point, targets.d1, targets.d2)), exponent), width)
    words = np.insert(lengths, FIELDS.index("phi"), binary_angles(targets.phi, width), axis=1)
    if targets.hand is not None:
        tool = _quantise(np.ldexp(targets.tool[:, 2], exponent), width)
        words = np.column_stack((words, tool, _quantise(targets.core_hand, width), targets.branch))
    return words, exponent


def binary_angles(angles: np.ndarray, width: int) -> np.ndarray:
    """Return angles (rad) as words of the same shape, one turn = 2^width, rounded half to even."""
    turns = angles / (2 * np.pi)
    words = np.rint(np.ldexp(turns - np.rint(turns), width)).astype(np.int64)
    return words << 64 - width >> 64 - width  # half a turn is -half a turn


def limit_words(limits: np.ndarray | None, width: int) -> list[tuple[int, int]]:
    """Return the lowest and highest words within each joint's limits. A range of a turn or more allows any word."""
    half, unit, words = 2 ** (width - 1), 2**width / (2 * np.pi), []
    for low, high in [(-np.inf, np.inf)] * 7 if limits is None else limits.tolist():
        free = not high - low < 2 * np.pi
        words.append((-half, half - 1) if free else (math.ceil(low * unit), math.floor(high * unit)))
    return words


def from_words(words: np.ndarray, exponent: int, width: int, name: str) -> Targets:
    """Return the targets that `words` (N, 6) represent, in the user's units and the core's frame.

    Lengths are exact; phi is in [-pi, pi). :func:`to_words` with the same exponent returns `words`.
    """
    columns = dict(zip(FIELDS, np.asarray(words, dtype=np.int64).T.astype(np.float64), strict=True))
    values = {length: np.ldexp(columns[length], 2 - width - exponent) for length in LENGTHS}
    return Targets(name=name, **values, phi=np.ldexp(columns["phi"], -width) * (2 * np.pi))


def pack(fields: np.ndarray, width: int) -> list[int]:
    """Return tdata of signed words (N, n), field 0 in the lowest bits. Raises ValueError for words that do not fit."""
    array = np.asarray(fields, dtype=np.int64)
    if (array != array << 64 - width >> 64 - width).any():
        raise ValueError(f"a word does not fit {width} bits")
    mask = 2**width - 1
    return [sum((word & mask) << (width * i) for i, word in enumerate(row)) for row in array.tolist()]


def unpack(data: list[int], width: int, count: int = len(FIELDS)) -> np.ndarray:
    """Return the signed words (N, `count`) int64 of tdata; the inverse of `pack`."""
    mask = 2**width - 1
    rows = [[value >> (width * i) & mask for i in range(count)] for value in data]
    return np.array(rows, dtype=np.int64).reshape(len(rows), count) << 64 - width >> 64 - width


def result_values(words: np.ndarray, width: int) -> np.ndarray:
    """Return the exact values of result words with width-2 fraction bits; same shape."""
    return np.ldexp(np.asarray(words, dtype=np.float64), 2 - width)


TAG_BITS = 24  # bits of a tag that a result record returns


@dataclass(frozen=True)
class Records:
    """Layout of target and result records: words of 32 bits, little endian, whatever the core's word length.

    Lengths and quaternions are Q2.30, one turn is 2^32. The word with index `tag` holds the tag in its low bits and,
    above them, the branch (target) or the flags (result); `inputs` and `results` name the other words. A result
    ends with its index in the job and, for the whole arm, a word with over_limit in bits 0 to 6 and bad_hand in bit 8.
    """

    size: int  # bytes
    tag: int
    inputs: tuple[str, ...]
    results: tuple[str, ...]

    def packed(self, fields: np.ndarray, *more: np.ndarray) -> bytes:
        """Return records, padded with zeros. fields (N, n): 32-bit words, with the columns of `inputs` (targets) or
        `results`; more: the tag words (N,), then any further words (N,), which are stored after the fields."""
        columns = [*np.broadcast_arrays(*fields.T, *more, *[0] * (self.size // 4))]
        columns.insert(self.tag, columns.pop(fields.shape[1]))
        columns = columns[: self.size // 4]
        return (np.column_stack([column.astype(np.int64) for column in columns]) & 0xFFFFFFFF).astype("<u4").tobytes()

    def _unpacked(self, records: bytes, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the first ``count`` words of each record, signed and without the tag word, and the tag words (N,)."""
        table = np.frombuffer(records, dtype="<i4").astype(np.int64).reshape(-1, self.size // 4)
        return np.delete(table, self.tag, axis=1)[:, :count], table[:, self.tag]

    def core_words(self, records: bytes, width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the input words (N, n) of `width` bits, the tags (N,) and the branches (N,) of target records.

        Words are rounded half up; a length beyond the format saturates, an angle wraps.
        """
        table, tags = self._unpacked(records, len(self.inputs))
        dropped, most = 32 - width, (1 << (width - 1)) - 1
        rounded = (table + ((1 << dropped) >> 1)) >> dropped
        wrapped = rounded << 64 - width >> 64 - width
        words = np.where(np.array(self.inputs) == "phi", wrapped, np.minimum(rounded, most))
        return words, tags & ((1 << TAG_BITS) - 1), tags >> TAG_BITS & (1 << len(BRANCHES)) - 1

    def written(self, results: np.ndarray, flags: np.ndarray, tags: np.ndarray, width: int) -> bytes:
        """Return a job's result records. results (N, n): `width` bits, columns as `self.results`; flags, tags: (N,)."""
        more = (flags & 255) << TAG_BITS | tags, np.arange(len(results)), flags >> OVER_BIT | flags & BAD_HAND
        return self.packed(results << (32 - width), *more)

    def result_words(self, records: bytes, width: int) -> np.ndarray:
        """Return the results (N, n), as words of `width` bits, from result records."""
        return self._unpacked(records, len(self.results))[0] >> (32 - width)


RECORDS = Records(32, 6, FIELDS, RESULT_FIELDS)  # records of ``ik_axi``

ARM_RECORDS = Records(64, 7, ARM_FIELDS, (*JOINTS, *RESULT_FIELDS))  # records of ``ik_axi`` with ARM = 1
