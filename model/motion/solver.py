# SPDX-License-Identifier: Apache-2.0
"""Solver behind `pose.solve`: poses of checked targets, in double precision or in the words of the core.

Targets are tables (6, n) with rows as ``FIELDS``, in the user's frame. Poses are dicts: field of `pose.Pose` -> array.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..dataflow import fixed
from ..dataflow.datapaths import MODELS
from ..io.flags import BAD_HAND, OVER_BIT
from ..io.words import (
    FIELDS,
    JOINTS,
    RESULT_FIELDS,
    WRIST_FIELDS,
    Targets,
    from_words,
    result_values,
    scale_exponent,
    to_words,
)
from ..reference import joints, kinematics
from ..reference.equations import solve_clamped
from ..reference.kinematics import conjugate, multiply, product
from ..reference.lean_equations import solve_direct
from .hands import Floats, Hands, limit_words


class Solver(NamedTuple):
    """Arithmetic and reference frame of a call of `pose.solve`.

    * frame: quaternion of R, which takes the user's frame to the core's; None is the identity
    * width: word length, None is double precision; exponent: words hold lengths times 2^exponent
    """

    frame: Floats | None
    width: int | None
    datapath: str
    exponent: int = 0

    def scaled(self, table: Floats, hands: Hands | None) -> "Solver":
        """Return the solver with the exponent that fits all targets."""
        if self.width is None or not table.size:
            return self
        return self._replace(exponent=scale_exponent(self._targets(table, hands), self.width))

    def poses(self, table: Floats, hands: Hands | None, limits: Floats | None) -> dict[str, Any]:
        """Solve wrist targets, or with ``hands`` hand poses; the table then contains the hands' points."""
        if hands is None:
            return self._pose(table, *self._core(table))
        return (self._hands_in_double if self.width is None else self._hands_in_words)(table, hands, limits)

    def _hands_in_words(self, table: Floats, hands: Hands, limits: Floats | None) -> dict[str, Any]:
        assert self.width
        path, ends = MODELS["arm"], limit_words(limits, self.width)
        words, _ = to_words(self._targets(table, hands), self.width, self.exponent)
        run = fixed.run(words[:, :-1], self.width, path.name, words[:, -1], ends)
        over = run.flags >> OVER_BIT + np.arange(7)[:, None] & 1 > 0
        over |= np.array([[high < low] for low, high in ends])  # limits with no word between them
        value = dict(zip(path.results, result_values(run.results, self.width).T, strict=True))
        results, qw, th = (np.array([value[k] for k in names]) for names in (RESULT_FIELDS, WRIST_FIELDS, JOINTS))
        th *= np.pi / 2  # result_values returns 1 for a quarter turn
        phi = from_words(words[:, : len(FIELDS)], self.exponent, self.width, "targets").phi
        pose = self._pose(table, results, run.flags & 2 * BAD_HAND - 1, phi)
        w, i = results[4:]
        q = product(product(pose["qs"].T, np.array((-i, w, 0 * w, 0 * w))), qw)
        hand = pose["wrist"] + joints.tool_offset(q / np.linalg.norm(q, axis=0), hands.tool).T
        return pose | {"qw": qw.T, "hand": hand, "joints": th.T, "over_limit": over.T}

    def _hands_in_double(self, table: Floats, hands: Hands, limits: Floats | None) -> dict[str, Any]:
        wrists = np.concatenate((table[:3] - hands.offset, table[3:]))
        results, flags, phi = self._core(wrists)
        pose = self._pose(wrists, results, flags, phi)
        qw = joints.wrist_quaternion(pose["qs"].T, results[4:], hands.q)
        th = joints.angles(results[:4], joints.flexion(results[4:]), qw, hands.branch)
        over = np.zeros(th.shape, dtype=bool)
        if limits is not None:
            th = joints.settled(th, limits)
            over = joints.outside(th, limits)
        return pose | {"qw": qw.T, "hand": pose["wrist"] + hands.offset.T, "joints": th.T, "over_limit": over.T}

    def _targets(self, table: Floats, hands: Hands | None = None) -> Targets:
        x, y, z, phi, d1, d2 = table
        hand: dict[str, Any] = {"hand": hands.q.T, "tool": hands.tool, "branch": hands.branch} if hands else {}
        return Targets("targets", x, y, z, phi, d1, d2, frame=self.frame, **hand)

    def _core(self, table: Floats) -> tuple[Floats, NDArray[np.int64], Floats]:
        """Return results (6, n) as ``RESULT_FIELDS``, flags and swivel angles (n,) of the core for wrist targets."""
        if self.width is not None:
            words, _ = to_words(self._targets(table), self.width, self.exponent)
            run = fixed.run(words, self.width, self.datapath)
            phi = from_words(words, self.exponent, self.width, "targets").phi
            return result_values(run.results, self.width).T, run.flags, phi
        if self.frame is not None:
            table = np.concatenate((self._targets(table).core_position.T, table[3:]))
        if self.datapath == "paper":
            pose = solve_clamped(*table)
            return np.array([pose[field] for field in RESULT_FIELDS]), pose["flags"], table[3]
        return *solve_direct(table), table[3]

    def _pose(self, table: Floats, results: Floats, flags: NDArray[np.int64], phi: Floats) -> dict[str, Any]:
        """Return poses in the user's frame from results of the core."""
        qs, qe = results[:4].T, results[4:].T
        qs = qs if self.frame is None else multiply(conjugate(self.frame), qs)
        elbow, wrist = kinematics.forward(qs, qe, table[4], table[5])
        whole_qe = np.zeros((len(qe), 4))
        whole_qe[:, :2] = qe
        return {"qs": qs, "qe": whole_qe, "flags": flags, "elbow": elbow, "wrist": wrist, "phi": phi}
