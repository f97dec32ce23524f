# SPDX-License-Identifier: Apache-2.0
"""Joints of a robot along a path of hand poses: branches and swivel angles, chosen for the whole path at once.

Each row has candidates: swivel angles at which a branch has all joints within their limits. The path of least cost
through one candidate of each row is found by dynamic programming (Viterbi) and refined in ever finer steps:

    cost of a step d (7,) = sum d^2 + 100 max(0, max|d| - 0.1)^2
    cost of a pose = weight * sum max(0, 1 - distance to the limit / 0.1)^2

A joint whose range is a turn or less has one value per angle; its step is a plain difference, since it cannot cross the
gap between its limits. For wider joints, steps are first taken modulo a turn, then the values are unwrapped. If the
unwrapped values leave the limits, the path is planned again, with values whole turns apart as separate candidates.

Where a step exceeds the goal, further attempts try more swivel angles nearby, raise the cost of steps near the goal,
and finally avoid the joint positions at earlier jumps. For a nearly exact arm, joints are corrected on its true chain:
on the final path, and for all candidates in rows near the limits of the reach or, in further attempts, near jumps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..reference import joints
from ..reference.joints import Branch
from .pose import Floats
from .swivels import FLIPS, TURN, Circles, beyond

SWIVELS, MORE_SWIVELS = 16, 32  # uniform swivel angles of the first attempt, and of further attempts near jumps

FURTHER = ((0.0, 0.8), (0.5, 0.6), (0.5, 0.8), (1.0, 0.6), (3.0, 0.8))
"""Further attempts: distance (rad) kept from joints at the last attempt's jumps; free step / goal."""

DENSE = 20  # rows on either side of a jump that get more swivel angles
SPLITS = 16  # values of th1 (th5) tried where only a sum or difference of two joints counts
SINGULAR = 1e-7  # |sin th2|, |sin th6| below this: only a sum or difference counts
FREE_STEP, STEP_WEIGHT, FURTHER_WEIGHT = 0.1, 100.0, 1e4  # rad; weights of larger steps: first, later attempts
AVOIDED_WEIGHT = 1e3  # cost of joints that an attempt avoids
MARGIN, WEIGHTS = 0.1, (0.01, 0.01, 0.001, 0.001, 0.001)
"""Distance from a limit (rad) below which a pose costs; weight of this cost in the search and its refinements."""

Progress = Callable[[float, int], None]
"""Callback of an attempt: the fraction done, 0 to 1, and the number of swivel angles."""

OPTIONS = ((joints.SIGNS < 0) | (joints.TURNS > 0))[:, np.arange(8) & ~Branch.ELBOW] + (np.arange(8) & Branch.ELBOW)
"""By joint and branch (7, 8): 1 if SHOULDER or WRIST turns or negates the joint, plus 2 if the branch has ELBOW."""


@dataclass(frozen=True, eq=False)
class JointPath:
    """Joints of a robot along a path of N hand poses.

    * joints (N, 7): rad, within the limits; nan where no branch and swivel angle has all joints within them
    * phi (N,): swivel angle, rad; branch (N,): bits of :class:`Branch`
    * step (N,): largest move of a joint from the previous row with joints, rad; row 0: from ``start``, or 0 without it
    * jumps: row -> text: which joint moves by more than the goal and why, or why the row has no joints
    """

    joints: Floats
    phi: Floats
    branch: NDArray[np.int64]
    step: Floats
    jumps: dict[int, str]

    @property
    def largest(self) -> float:
        """Largest step, rad."""
        return float(np.nanmax(self.step, initial=0.0))


class Candidates(NamedTuple):
    """Candidate poses, sorted by row of the path: row, branch, phi (M,) and joint positions (7, M)."""

    row: NDArray[np.int64]
    branch: NDArray[np.int64]
    phi: Floats
    at: Floats

    @classmethod
    def joined(cls, *parts: "Candidates") -> "Candidates":
        """Return the candidates of several parts, sorted by row."""
        both = cls(*(np.concatenate(v, axis=-1) for v in zip(*parts, strict=True)))
        return both.only(np.argsort(both.row, kind="stable"))

    def only(self, which: NDArray) -> "Candidates":
        """Return the candidates that a mask or indices select."""
        return Candidates(self.row[which], self.branch[which], self.phi[which], self.at[:, which])


class Planner:
    """Planner of a path. circles: the poses; limits (7, 2), offsets (7,), signs (7,): as in :class:`Arm`.

    spare: angle (rad) by which candidates may exceed a limit before correction; it widens no range beyond a turn
    """

    def __init__(self, circles: Circles, limits: Floats, offsets: Floats, signs: Floats, spare: float = 0.0) -> None:
        self.circles, self.offsets, self.signs = circles, offsets, signs
        self.bounds = np.sort((limits - offsets[:, None]) * signs[:, None], axis=1)  # of th1 .. th7
        ranges, outward = np.ptp(limits, axis=1), np.array((-1, 1))
        more = np.clip((TURN - ranges) / 2, 0, spare)[:, None] * outward
        self.limits, self.wide = limits + more, ranges > TURN + joints.ROUNDING
        turn = (np.ptp(self.limits, axis=1) > TURN - joints.ROUNDING) & ~self.wide  # these do not cross limits either
        self.gaps = self.bounds + more - turn[:, None] * SINGULAR * outward
        self.extremes: Any = None
        self.middles: Any = None
        self.dense, self.true = np.zeros((2, len(circles)), dtype=bool)
        self.steps, self.avoided = (FREE_STEP, STEP_WEIGHT), list[tuple[Floats, float]]()
        self.finer = TURN / SWIVELS
        self.corrected: Callable[[Floats, NDArray], tuple[Floats, Floats]] | None = None
        self.copied = np.zeros(7, dtype=bool)  # wide joints: values whole turns apart are separate candidates
        self.progress: Progress = lambda part, count: None

    def placed(self, th: Floats, near: Floats | None = None) -> tuple[Floats, NDArray[np.bool_]]:
        """Return joint positions (7, M) for th1 .. th7, and True (7, M) for those outside their limits.

        near (7, M): positions; joints in ``self.copied`` get whole turns added to come nearest to them.
        """
        low, high = self.limits[:, :1], self.limits[:, 1:]
        at = th * self.signs[:, None] + self.offsets[:, None]
        bottom = np.where(np.isfinite(low), low - joints.ROUNDING, -np.pi)
        at -= TURN * np.floor((at - bottom) * (1 / TURN))
        if near is not None and self.copied.any():
            at = np.where(self.copied[:, None], near + joints.wrap(at - near), at)
        return at, (at < low - joints.ROUNDING) | (at > high + joints.ROUNDING)

    def nearest_branch(self, th: list[Floats], near: Floats | None) -> tuple[NDArray[np.intp], Floats, NDArray]:
        """Return the best branch (N,) within the limits (see :meth:`best`), its joint positions (7, N), and a mask (N,)
        of regular poses that have such a branch. th: for each elbow solution, th1 .. th7 (7, N)."""
        turned = [joints.branched(some, of) for some in th for of in (0, Branch.SHOULDER | Branch.WRIST)]
        places, outside = (np.array(v) for v in zip(*map(self.placed, turned), strict=True))
        each, order, costs = np.arange(7), FLIPS.T.ravel(), np.empty((8, th[0].shape[1]))
        for cost, option in zip(costs, OPTIONS.T[order], strict=True):
            cost[:] = self._cost(places[option, each], near)
            cost[outside[option, each].any(axis=0)] = np.inf
        best = order[costs.argmin(axis=0)]
        at = places[OPTIONS[:, best], each[:, None], np.arange(len(best))]
        regular = np.abs(np.sin([some[[1, 5]] for some in th])).min(axis=(0, 1)) > SINGULAR
        return best, self._closer(np.clip(at, *self.limits.T[..., None]), near), regular & (costs.min(axis=0) < np.inf)

    def _cost(self, at: Floats, near: Floats | None) -> Floats:
        """Return costs (M,) of positions (7, M). They grow with steps from ``near`` or, if it is None, toward
        limits."""
        if near is not None:
            return self.edges(near, at)
        return -np.minimum(at - self.limits[:, :1], self.limits[:, 1:] - at).min(axis=0)

    def _closer(self, at: Floats, near: Floats | None) -> Floats:
        """Return joint positions (7, M); move wide joints by whole turns toward ``near`` (7, M) if limits allow it."""
        if near is None or not self.wide.any():
            return at
        closer = near + joints.wrap(at - near)
        allowed = self.wide[:, None] & (closer >= self.limits[:, :1]) & (closer <= self.limits[:, 1:])
        return np.where(allowed, closer, at)

    def solved(self, row: NDArray, branch: NDArray, phi: Floats, near: Floats | None = None) -> Candidates:
        """Return the candidates within the limits, sorted by row. Where a ball joint is singular, only the sum or
        difference of two joints counts: several splits of it are candidates.

        * row, phi (M,); branch (M,) or (M, B): branches of the same elbow solution
        * near (7, M): joint positions from the last search; values and splits are chosen close to them
        """
        several = branch if branch.ndim > 1 else branch[:, None]
        plain = self.circles.joints(row, several[:, 0] & Branch.ELBOW > 0, phi)
        extra = [] if near is None else [near]
        columns = [(row, of, phi, joints.branched(plain, of & ~Branch.ELBOW), *extra) for of in several.T]
        parts = [np.concatenate(v, axis=-1) for v in zip(*columns, strict=True)]
        for ball, bit in ((0, Branch.SHOULDER), (1, Branch.WRIST)):
            singular = np.abs(np.sin(parts[3][1 + 4 * ball])) < SINGULAR
            if singular.any():
                split = self._split(ball, *(v[..., singular & (parts[1] & bit == 0)] for v in parts))
                parts = [np.concatenate((v[..., ~singular], new), axis=-1) for v, new in zip(parts, split, strict=True)]
        row, branch, phi, th, *near_of = parts
        at, outside = self.placed(th, *near_of)
        inside = ~outside.any(axis=0)
        at = np.clip(at[:, inside], *self.limits.T[..., None])
        return Candidates.joined(Candidates(row[inside], branch[inside], phi[inside], at))

    def _split(self, ball: int, row, branch, phi, th, near=None) -> list[NDArray]:
        """Return the arguments, repeated for several th1, th3 (ball 1: th5, th7) with the same sum or difference."""
        a, tilt, c = 4 * ball + np.arange(3)
        turns = np.arange(SPLITS) * (TURN / SPLITS) if near is None else self.finer * np.arange(-3, 4)
        parts = [np.repeat(v, len(turns), axis=-1) for v in (row, branch, phi, th, *([] if near is None else [near]))]
        th = parts[3]
        base = joints.settled(th, self.bounds)[a] if near is None else (parts[4][a] - self.offsets[a]) * self.signs[a]
        first = base + np.resize(turns, len(base))
        th[c] += np.where(np.cos(th[tilt]) < 0, -1, 1) * (th[a] - first)
        th[a] = first
        return parts

    def plan(self, phi: Floats | None, branch: NDArray | None, start: Floats | None, goal: float) -> JointPath:
        """Return the best path of several attempts; stop when one reaches the goal. Each further attempt tries
        more swivel angles near the jumps of the previous one; from the third on, the joint positions there are avoided.

        phi, branch (N,): fixed, or None; start (7,): joints before the first row; goal: largest wanted step, rad.
        """

        def rank(attempt: tuple[Candidates, Floats]) -> tuple[int, float]:
            """Return minus the number of rows that reach their pose, and the largest step."""
            path, errors = attempt
            return -int((errors <= joints.ROUNDING).sum()), float(np.abs(self._moves(path, start)).max(initial=0))

        if self.corrected:
            self.true = np.abs(self.circles.distance[:, None] - self.circles.reach).min(axis=1) < self.circles.slack
        path, errors = best = self._attempt(SWIVELS, phi, branch, start)
        for radius, share in FURTHER if phi is None else FURTHER[: bool(self.corrected)]:
            jumps = np.abs(self._moves(path, start)).max(axis=0, initial=0) > goal
            jumps &= np.diff(path.row, prepend=-1) == 1  # a step over rows without candidates stays
            bad = np.flatnonzero(jumps | (errors > joints.ROUNDING))
            if not len(bad):
                break
            self.dense |= np.abs(np.arange(len(self.circles))[:, None] - path.row[bad]).min(axis=1) <= DENSE
            self.true |= self.dense & bool(self.corrected)
            self.steps = share * goal, FURTHER_WEIGHT
            if radius:
                avoided = np.full((7, len(self.circles)), np.nan)
                for place in (bad, np.maximum(bad - 1, 0)):  # rows of jumps, and rows before
                    avoided[:, path.row[place]] = path.at[:, place]
                self.avoided.append((avoided, radius))
            path, errors = self._attempt(MORE_SWIVELS, phi, branch, start)
            best = min(best, (path, errors), key=rank)
        return self._result(*best, start, goal, phi, branch)

    def _moves(self, path: Candidates, start: Floats | None) -> Floats:
        """Return the joints' moves (7, R) from the previous row; in the first row, from ``start``, or 0 without it."""
        return np.diff(path.at, axis=1, prepend=path.at[:, :1] if start is None else start[:, None])

    def best(
        self, phi: Floats | None, branch: NDArray | None, near: Floats | None, hint: Floats | None
    ) -> tuple[Candidates, Floats, NDArray[np.int64]]:
        """Return the best candidate of each pose that has one, and phi and branch (N,) of all poses.

        The best is nearest to the joints ``near`` (N, 7) or, if near is None, farthest from the limits. For a pose
        without candidates, phi and branch minimize the sum of the angles by which joints exceed their limits. phi,
        branch (N,): fixed values, or None; hint (N,): a guess of the swivel angle.
        """

        def chosen(found: Candidates) -> Candidates:
            cost = self._cost(found.at, None if near is None else near[found.row].T)
            order = np.lexsort((cost, found.row))  # equal costs stay in order
            return found.only(order[np.flatnonzero(np.diff(found.row[order], prepend=-1))])

        self.extremes = np.empty((len(self.circles), 0, 2)) if hint is None else np.stack((hint, hint), axis=1)[:, None]
        found = chosen(self._reaching(self.candidates(SWIVELS, phi, branch)))
        for round in range(1, 5) if phi is None and (near is not None or not self.true.any()) else ():
            self.finer = TURN / SWIVELS / 3**round
            found = chosen(self._reaching(self._around(found, near_extremes=False)))
        if near is not None:
            found = found._replace(at=self._closer(found.at, near[found.row].T))
        swivels, branches = np.empty(len(self.circles)), np.empty(len(self.circles), dtype=np.int64)
        swivels[found.row], branches[found.row] = found.phi, found.branch
        missing = np.flatnonzero(np.bincount(found.row, minlength=len(swivels)) == 0)
        swivels[missing], branches[missing], _ = self._nearest_miss(missing, phi, branch)
        return found, joints.wrap(swivels), branches

    def _nearest_miss(self, row: NDArray, phi: Any, branch: Any) -> tuple[Floats, NDArray, Floats]:
        """Return, for rows (R,) without candidates, phi and branch (R,) that minimize the sum of the angles by which
        joints exceed their limits, and these angles (7, R). phi, branch (N,): fixed, or None."""
        turns: Any = np.arange(SWIVELS) * (TURN / SWIVELS) if phi is None else phi[row, None]
        of: Any = np.arange(8) if branch is None else branch[row, None]
        shape = (len(row), turns.shape[-1], of.shape[-1])
        rows = np.broadcast_to(row[:, None, None], shape).ravel()
        turns, of = (np.broadcast_to(v, shape).ravel() for v in (turns[..., None], of[..., None, :]))
        th = joints.branched(self.circles.joints(rows, of & Branch.ELBOW > 0, turns), of & ~Branch.ELBOW)
        excess = np.maximum(joints.excess(th, self.bounds), 0)
        least = excess.sum(axis=0).reshape(len(row), shape[1] * shape[2]).argmin(axis=1)
        least += np.arange(len(row)) * (shape[1] * shape[2])
        return turns[least], of[least], excess[:, least]

    def _attempt(self, count: int, phi, branch, start) -> tuple[Candidates, Floats]:
        found = self._with_copies(self.candidates(count, phi, branch))
        path = self._search(found, start, WEIGHTS[0], self.avoided)
        for round, weight in enumerate(WEIGHTS[1:], 1):
            self.finer = TURN / count / 3**round
            if phi is None and len(path.row):
                path = self._search(self._around(path, near_extremes=round < 3), start, weight)
            self.progress((round + 1) / len(WEIGHTS), count)
        settled = self._unwound(path, start)
        if settled is None:
            self.copied |= self.wide & np.isfinite(self.limits).all(axis=1)
            return self._attempt(count, phi, branch, start)
        path = path._replace(at=settled)
        return self._on_chain(path) if self.corrected else (path, np.zeros(len(path.row)))

    def _on_chain(self, found: Candidates) -> tuple[Candidates, Floats]:
        """Return the candidates corrected on the true chain, and their errors (M,)."""
        assert self.corrected
        at, errors = self.corrected(found.at.T, found.row)
        return found._replace(at=at.T), errors

    def _reaching(self, found: Candidates) -> Candidates:
        """Correct candidates in rows ``self.true``; return all candidates except corrected ones that miss their pose.

        Where the exact arm is straight or closed, the true chain may not be, so correction starts with a bent elbow.
        """
        which = self.true[found.row]
        if not which.any():
            return found
        some = found.only(which)
        th = joints.wrap((some.at[3] - self.offsets[3]) * self.signs[3])
        bent = np.sqrt(self.circles.slack / self.circles.reach[some.row, 1])
        side = np.where(th == 0, 1 - (some.branch & Branch.ELBOW), np.sign(th))
        some.at[3] += np.where(np.abs(th) < bent, side * bent - th, 0) * self.signs[3]
        some, errors = self._on_chain(some)
        return Candidates.joined(found.only(~which), some.only(errors <= joints.ROUNDING))

    def candidates(self, count: int, phi: Floats | None, branch: NDArray | None) -> Candidates:
        """Return the candidates of all rows. phi, branch (N,): the only swivel angles and branches, or None."""
        if phi is not None:
            swivels = np.broadcast_to(phi[:, None, None], (len(phi), 1, 2))
        else:
            self.middles = self.circles.middles(self.gaps) if self.middles is None else self.middles
            self.extremes = self.circles.extremes() if self.extremes is None else self.extremes
            turns = -np.pi + np.arange(count) * (TURN / count)
            tried = self.dense[:, None] | (np.arange(count) % (count // SWIVELS) == 0)
            grid = np.repeat(np.where(tried, turns, np.nan)[..., None], 2, axis=2)
            swivels = np.concatenate((grid, self.extremes), axis=1)
        within = ~self.circles.unreachable[:, None, None]
        row, column, elbow = np.nonzero(np.isfinite(swivels) & within)
        parts = [self.solved(row, FLIPS[elbow], swivels[row, column, elbow])]
        if phi is None:
            row, column, of = np.nonzero(np.isfinite(self.middles) & within)
            parts.append(self.solved(row, of, self.middles[row, column, of]))
        found = Candidates.joined(*parts)
        return found if branch is None else found.only(found.branch == branch[found.row])

    def _with_copies(self, found: Candidates) -> Candidates:
        """Return the candidates, repeated for each value of a copied joint (whole turns apart) within its limits."""
        for joint in np.flatnonzero(self.copied):
            low, high = self.limits[joint]
            turns = np.arange(int((high - low) / TURN) + 1) * TURN
            found = found.only(np.repeat(np.arange(len(found.row)), len(turns)))
            found.at[joint] += np.tile(turns, len(found.row) // len(turns))
            found = found.only(found.at[joint] <= high)
        return found

    def _around(self, path: Candidates, near_extremes: bool) -> Candidates:
        """Return candidates close to the path: finer swivel angles, neighbouring rows' angles, and extremes nearby."""
        offsets = self.finer * np.arange(-3, 4)
        swivels = [path.phi[:, None] + offsets, np.roll(path.phi, 1)[:, None], np.roll(path.phi, -1)[:, None]]
        if near_extremes:
            near = self.extremes[path.row, :, path.branch >> 1 & 1]
            close = np.abs(joints.wrap(near - path.phi[:, None])) < 3 * self.finer
            swivels.append(np.where(close, near, np.nan))
        phi = np.concatenate(swivels, axis=1)
        which, column = np.nonzero(np.isfinite(phi))
        return self.solved(path.row[which], path.branch[which], phi[which, column], path.at[:, which])

    def edges(self, before: Floats, after: Floats) -> Floats:
        """Return the costs (A, B) of steps between joint positions that broadcast, such as (7, A, 1) and (7, B)."""
        total, most = np.zeros((2, *np.broadcast_shapes(before.shape[1:], after.shape[1:])))
        for joint, modulo in enumerate(self.wide & ~self.copied):
            move = before[joint] - after[joint]
            if modulo:
                move = joints.wrap(move)
            np.maximum(most, np.abs(move, out=move), out=most)
            total += np.multiply(move, move, out=move)
        free, weight = self.steps
        most -= free
        np.maximum(most, 0, out=most)
        total += weight * np.multiply(most, most, out=most)
        return total

    def _search(self, found: Candidates, start: Floats | None, weight: float, avoided=()) -> Candidates:
        """Return the candidate of each row on the path of least cost; rows without candidates are left out."""
        found = self._reaching(found)
        room = np.minimum(found.at - self.limits[:, :1], self.limits[:, 1:] - found.at)
        nodes = weight * np.maximum(0, 1 - room / MARGIN).sum(axis=0)
        for place, radius in avoided:
            move = found.at - place[:, found.row]
            move = np.where((self.wide & ~self.copied)[:, None], joints.wrap(move), move)
            nodes = nodes + AVOIDED_WEIGHT * (np.abs(move).max(axis=0) < radius)
        edges = np.concatenate((np.flatnonzero(np.diff(found.row, prepend=-1)), [len(found.row)]))
        backward: list[NDArray] = []
        cost, before = np.zeros(1), None if start is None else start[:, None]
        for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            after = found.at[:, first:last]
            if before is None:
                cost, best = nodes[first:last], np.zeros(last - first, dtype=int)
            else:
                total = self.edges(before[..., None], after)
                total += cost[:, None]
                best = total.argmin(axis=0)
                cost = total[best, np.arange(last - first)] + nodes[first:last]
            backward.append(best)
            before = after
        chosen = np.empty(len(backward), dtype=int)
        last = int(cost.argmin())
        for n in range(len(backward) - 1, -1, -1):
            chosen[n], last = edges[n] + last, backward[n][last]
        return found.only(chosen)

    def _unwound(self, path: Candidates, start: Floats | None) -> Floats | None:
        """Return the positions (7, R) with wide joints unwrapped and shifted into their limits; None if impossible."""
        at = path.at.copy()
        for joint in np.flatnonzero(self.wide & ~self.copied) if at.size else ():
            first = at[joint, :1] if start is None else start[joint : joint + 1]
            turned = np.unwrap(np.concatenate((first, at[joint])))[1:]
            low, high = (self.limits[joint] - (turned.min(), turned.max())) / TURN
            least, most = np.ceil(low - joints.ROUNDING), np.floor(high + joints.ROUNDING)
            if least > most or (start is not None and not least <= 0 <= most):
                return None
            at[joint] = turned + TURN * (0 if start is not None else np.clip(0, least, most))
        return at

    def impossible(self, row: NDArray, phi: Floats | None = None, branch: NDArray | None = None) -> dict[int, str]:
        """Return row -> text that explains why it has no candidate, for each row number in ``row``."""
        texts, (_, of, excess) = {}, self._nearest_miss(row, phi, branch)
        for n, best, over in zip(row.tolist(), of.tolist(), excess.T, strict=True):
            if self.circles.unreachable[n]:
                near, far = self.circles.reach[n]
                texts[n] = beyond(self.circles.distance[n], near, far)
            else:
                beyond_limits = np.flatnonzero(over > joints.ROUNDING)
                listed = ", ".join(f"joint {joint + 1} by {over[joint]:.3g} rad" for joint in beyond_limits)
                texts[n] = f"outside the limits, in branch {best}: {listed}" if listed else "the correction fails"
        return texts

    def _result(self, path: Candidates, errors: Floats, start, goal: float, asked_phi, asked_branch) -> JointPath:
        count = len(self.circles)
        place, phi, branch = np.full((count, 7), np.nan), np.full(count, np.nan), np.zeros(count, dtype=np.int64)
        place[path.row], phi[path.row], branch[path.row] = path.at.T, joints.wrap(path.phi), path.branch
        step, jumps = np.full(count, np.nan), self.impossible(np.flatnonzero(np.isnan(phi)), asked_phi, asked_branch)
        moves = self._moves(path, start)
        step[path.row] = np.abs(moves).max(axis=0, initial=0)
        for n in np.flatnonzero(step[path.row] > goal).tolist():
            jumps[int(path.row[n])] = self._why(path, moves[:, n], n)
        for n in np.flatnonzero(errors > joints.ROUNDING).tolist():
            jumps[int(path.row[n])] = f"the tip misses its pose by {errors[n]:.3g} (arm sizes or rad)"
        return JointPath(place, phi, branch, step, jumps)

    def _why(self, path: Candidates, move: Floats, n: int) -> str:
        joint = int(np.abs(move).argmax())
        text = f"joint {joint + 1} moves by {abs(move[joint]):.3g} rad"
        ends = path.only(np.array([max(n - 1, 0), n]))
        tilts = np.abs(np.sin(((ends.at.T - self.offsets) * self.signs)[:, [1, 5]])).min(axis=0)
        if n and path.row[n] - path.row[n - 1] > 1:
            return f"{text}: the rows before have no candidate"
        if abs(joints.wrap(move[joint])) < 0.5 * abs(move[joint]):
            return f"{text}: it unwinds by a full turn"
        if tilts.min() < 0.05:
            return f"{text}: singular {('shoulder', 'wrist')[int(tilts.argmin())]}"
        return f"{text}: no smaller step within the limits was found"
