# SPDX-License-Identifier: Apache-2.0
"""Time and memory of `solve` next to a direct numpy solution of the same arm with the same results.

    python -m model.motion.tests.benchmark

Each function's best CPU time counts.
"""

import resource
import time
import timeit
from functools import partial

import numpy as np

from model.motion.pose import solve
from model.reference.joints import tool_offset

SIZES = {1: 2000, 1000: 500, 10**6: 5}  # number of targets -> repetitions


def two_bones(points, phi, d1, d2):
    """Return Qs, Qe, flags, elbow and wrist by the law of cosines, without care for singular poses."""
    x, y, z = points.T
    rho = np.hypot(x, y)
    distance = np.hypot(rho, z)
    longest, shortest, on_axis = d1 + d2, np.abs(d1 - d2), rho == 0
    flags = (distance > longest) * 1 + (distance < shortest) * 2 + on_axis * 4 + (distance == 0) * 8
    reach = np.clip(distance, shortest, longest)
    cos_a = np.clip((d1**2 + reach**2 - d2**2) / (2 * d1 * reach), -1, 1)
    sin_a = np.sqrt(1 - cos_a**2)
    rho_or_1 = np.where(on_axis, 1.0, rho)
    u, v, h, w = np.where(on_axis, 1.0, x) / rho_or_1, y / rho_or_1, rho / distance, z / distance
    c, s = np.cos(phi), np.sin(phi)
    n = u * h, v * h, w  # toward the wrist
    m = s * v - c * u * w, -s * u - c * v * w, c * h  # from that line toward the elbow
    e = [cos_a * along + sin_a * aside for along, aside in zip(n, m, strict=True)]
    a = m[1] * n[2] - m[2] * n[1], m[2] * n[0] - m[0] * n[2], m[0] * n[1] - m[1] * n[0]  # the hinge
    b = e[1] * a[2] - e[2] * a[1], e[2] * a[0] - e[0] * a[2], e[0] * a[1] - e[1] * a[0]
    # the quaternion of the rotation with columns a, b, e, from its largest component
    squares = 1 + np.stack((a[0] + b[1] + e[2], a[0] - b[1] - e[2], b[1] - a[0] - e[2], e[2] - a[0] - b[1]))
    row, each = squares.argmax(axis=0), np.arange(len(x))
    sums = b[2] - e[1], e[0] - a[2], a[1] - b[0], a[1] + b[0], e[0] + a[2], b[2] + e[1], squares[row, each]
    qs = np.stack(sums)[np.array(((6, 0, 1, 2), (0, 6, 3, 4), (1, 3, 6, 5), (2, 4, 5, 6)))[row].T, each]
    qs /= np.sqrt((qs * qs).sum(axis=0)) * np.where(qs[3] < 0, -1, 1)
    cos = np.clip((d1**2 + d2**2 - reach**2) / (2 * d1 * d2), -1, 1)
    qe = np.sqrt((1 + cos) / 2), -np.sqrt((1 - cos) / 2), 0 * cos, 0 * cos
    elbow, wrist = ([length * part for part in unit] for length, unit in ((d1, e), (reach, n)))
    return *(np.stack(each, axis=-1) for each in (qs, qe)), flags, *(np.stack(each, axis=-1) for each in (elbow, wrist))


def targets(count, seed=1):
    """Return points (N, 3), phi, d1, d2 (N,) of reachable targets of an arm."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(count, 3))
    points *= (random.uniform(0.1, 0.59, count) / np.linalg.norm(points, axis=1))[:, None]
    return points, random.uniform(-np.pi, np.pi, count), np.full(count, 0.33), np.full(count, 0.27)


def seconds(functions, times):
    """Return the best CPU time of each function."""
    return [min(timeit.repeat(function, timer=time.process_time, repeat=times, number=1)) for function in functions]


def main():
    given = targets(10**6)
    (words,) = seconds([lambda: solve(*given, width=32)], 1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"10^6 targets, width=32: {words:.2f} s, peak of the process {peak:.0f} MiB")
    for size, times in SIZES.items():
        each = seconds([partial(function, *targets(size)) for function in (solve, two_bones)], times)
        print(f"{size} targets, double precision: solve {1e3 * each[0]:.3f} ms, direct {1e3 * each[1]:.3f} ms")
    random = np.random.default_rng(2)
    hand = random.normal(size=(10**6, 4))
    hand /= np.linalg.norm(hand, axis=1)[:, None]
    points, limits = given[0] + tool_offset(hand.T, 0.1).T, random.uniform(2.0, 3.0, (7, 1)) * (-1, 1)
    arm = partial(solve, points, *given[1:], hand=hand, tool=0.1, limits=limits)
    whole, core = seconds([arm, partial(solve, *given)], 5)
    print(f"10^6 hand poses within limits: {whole:.2f} s, {whole / core:.2f} times as long as their wrists")


if __name__ == "__main__":
    main()
