# SPDX-License-Identifier: Apache-2.0
"""Built-in trajectories: 100 targets each, in metres and radians.

docs/targets.md defines frame and swivel angle; the arm is a right arm.  Only `out_of_reach` leaves the reach.

    python -m model.io.trajectories NAME > FILE.csv      write one as a target file
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .files import QUATERNION, format_csv
from .words import DEFAULT_D1, DEFAULT_D2, Targets

STEPS = 100  # targets per trajectory: the paper's test scenario has 100 steps

DEFAULT = "reach"

TRAJECTORIES: dict[str, Callable[[], tuple]] = {}
"""Built-in trajectories of wrist targets by name, in the order in which commands list and run them."""

HANDS: dict[str, Callable[[], tuple]] = {}  # built-in trajectories of hand poses by name
ROBOTS = {"pick_and_place": "iiwa14"}  # trajectory in a robot's base frame -> robot


def make(name: str) -> Targets:
    """Return the targets of a built-in trajectory.  Raises KeyError for an unknown name."""
    motion = {**TRAJECTORIES, **HANDS}[name]()
    position, phi, d1, d2, *hand = motion if motion[2:] else (*motion, DEFAULT_D1, DEFAULT_D2)
    # Rounded to nm and nrad, so that machines whose sines differ in the last place give equal targets.
    x, y, z = np.round(position.T, 9)
    return Targets(name, x, y, z, np.round(phi, 9), d1, d2, **(_hand(*hand) if hand else {}))


def describe(name: str) -> str:
    """Return a sentence about a built-in trajectory.  Raises KeyError for an unknown name."""
    return {**TRAJECTORIES, **HANDS}[name].__doc__ or ""


def _registered(place: dict[str, Callable[[], tuple]], function: Callable[[], tuple]) -> Callable[[], tuple]:
    """Register a trajectory in ``place`` under the name of its function.

    The function returns positions (N, 3) in m and swivel angles (rad). Unless the arm is the default, d1 and d2 (m)
    follow; for hand poses, d1, d2, orientations (N, 4) and the tool's length (m) follow.
    """
    place[function.__name__] = function
    return function


def _hand(q: np.ndarray, tool: float) -> dict[str, Any]:
    q = np.round(q, 9)
    others = {name: [*map(repr, column.tolist())] for name, column in zip(QUATERNION, q.T, strict=True)}
    others["tool"] = [repr(tool)] * len(q)
    return {"hand": q / np.linalg.norm(q, axis=1)[:, None], "tool": tool, "others": others}


trajectory, hands = partial(_registered, TRAJECTORIES), partial(_registered, HANDS)  # decorators

TIME = np.linspace(0.0, 1.0, STEPS)  # times from 0 to 1, both included


def _minimum_jerk(t: np.ndarray) -> np.ndarray:
    """Return the progress, 0 to 1, of a minimum-jerk motion at times 0 to 1 (Flash and Hogan, 1985)."""
    t = np.clip(t, 0.0, 1.0)
    return t**3 * (10 - 15 * t + 6 * t**2)


def _via(
    points: Sequence[tuple[float, ...]], times: Sequence[float], t: np.ndarray = TIME
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (N, 3), phi (N,) of a minimum-jerk motion with stops ``points`` (x, y, z, phi) at ``times``."""
    rests = np.asarray(points, dtype=np.float64)
    path = np.tile(rests[0], (len(t), 1))
    for n in range(len(rests) - 1):
        progress = _minimum_jerk((t - times[n]) / (times[n + 1] - times[n]))
        path += progress[:, None] * (rests[n + 1] - rests[n])
    return path[:, :3], path[:, 3]


def _turn(t: np.ndarray = TIME) -> np.ndarray:
    """Return the angle (rad) of one full turn that begins and ends at rest."""
    return 2 * np.pi * _minimum_jerk(t)


def _points(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> np.ndarray:
    return np.column_stack(np.broadcast_arrays(x, y, z))


def _spherical(r: ArrayLike, azimuth: ArrayLike, elevation: ArrayLike) -> np.ndarray:
    """Return points (N, 3) at distance r (m), azimuth from x toward y and elevation from the x-y plane (rad)."""
    forward = r * np.cos(azimuth) * np.cos(elevation)
    return _points(forward, r * np.sin(azimuth) * np.cos(elevation), r * np.sin(elevation))


@trajectory
def reach() -> tuple:
    """Reach from the edge of a desk to an object in front of the shoulder (the paper's 100 steps)."""
    return _via([(0.32, -0.12, -0.17, np.pi), (0.50, 0.08, 0.05, np.pi - 0.15)], [0, 1])


@trajectory
def circle() -> tuple:
    """Draw a circle of 12 cm radius on an upright board in front of the shoulder."""
    angle = _turn()
    position = _points(0.38, -0.08 + 0.12 * np.sin(angle), -0.10 + 0.12 * np.cos(angle))
    return position, np.pi + 0.05 * np.sin(angle)


@trajectory
def figure_eight() -> tuple:
    """Draw a lying figure eight in the air while the elbow swings gently with it."""
    angle = _turn()
    position = _points(0.40 + 0.03 * np.cos(angle), -0.05 + 0.16 * np.sin(angle), -0.10 + 0.09 * np.sin(2 * angle))
    return position, np.pi + 0.1 * np.sin(angle)


@trajectory
def wave() -> tuple:
    """Raise the hand from the desk and wave it three times from side to side."""
    lift, phi = _via([(0.34, -0.10, -0.18, np.pi), (0.34, -0.16, 0.30, np.pi - 0.1)], [0, 0.4])
    # The swing starts when the hand is up; its size grows and fades smoothly, to avoid a jerk.
    size = _minimum_jerk((TIME - 0.35) / 0.2) * _minimum_jerk((1 - TIME) / 0.2)
    swing = size * np.sin(2 * np.pi * 3 * (TIME - 0.35) / 0.65)
    position = lift + swing[:, None] * np.array([0.0, 0.11, -0.01])
    return position, phi + 0.1 * swing


@trajectory
def drinking() -> tuple:
    """Take a glass from the table, lift it to the mouth, tip it with the elbow, and put it back."""
    table, mouth = (0.44, -0.02, -0.20), (0.21, 0.13, 0.16)
    low, high, tipped = np.pi, np.pi - 0.1, np.pi - 0.2
    way = [(0.34, -0.10, -0.17, low), (*table, low), (*mouth, high), (*mouth, tipped), (*mouth, high), (*table, low)]
    return _via(way, [0.0, 0.2, 0.5, 0.6, 0.7, 1.0])


@trajectory
def handwriting() -> tuple:
    """Return a motion: the hand writes small loops on a tabletop, moving to the right."""
    stroke = 2 * np.pi * 6 * TIME
    position = _points(0.36 + 0.02 * np.cos(stroke), 0.10 - 0.18 * TIME + 0.015 * np.sin(stroke), -0.25)
    return position, np.pi - 0.05 * TIME


@trajectory
def punch() -> tuple:
    """Punch fast from the guard to within 1 mm of full stretch, and draw the fist back."""
    stretched = _spherical(DEFAULT_D1 + DEFAULT_D2 - 1e-3, 0.15, 0.1)[0]
    guard, out = (0.22, 0.05, -0.08, np.pi - 0.4), (*stretched, np.pi - 1.0)
    return _via([guard, guard, out, guard], [0.0, 0.15, 0.45, 1.0])


@trajectory
def overhead() -> tuple:
    """Swing the hand in an arc from in front over the head to behind it, passing the z axis at 2 mm."""
    elevation = np.radians(20) + np.radians(140) * _minimum_jerk(TIME)
    position = _spherical(0.45, 0.0, elevation)
    position[:, 1] = 0.002
    return position, np.pi - 0.8


@trajectory
def fold_in() -> tuple:
    """Draw the hand in from in front of the body to within 1 mm of the inner radius |d1-d2|."""
    r = 0.50 + (DEFAULT_D1 - DEFAULT_D2 + 1e-3 - 0.50) * _minimum_jerk(TIME)
    return _spherical(r, -0.2, -0.3), np.pi - 0.7


@trajectory
def swivel_sweep() -> tuple:
    """Hold the hand still and turn the elbow one full turn about the line from shoulder to wrist."""
    return np.tile([0.38, -0.10, -0.12], (STEPS, 1)), -np.pi + _turn()


@trajectory
def unequal_arms() -> tuple:
    """Circle the hand of an arm whose upper arm is three times as long as its forearm."""
    angle = _turn()
    position = _points(0.40 + 0.05 * np.cos(angle), -0.05 + 0.08 * np.sin(angle), -0.12 + 0.08 * np.cos(angle))
    return position, np.pi - 0.1 * np.sin(angle), 0.45, 0.15


@trajectory
def two_arms() -> tuple:
    """Interleave two arms of different size: an adult's, which reaches out, and a child's, which circles."""
    half = STEPS // 2
    time = np.linspace(0.0, 1.0, half)
    adult, phi = _via([(0.33, -0.10, -0.17, np.pi), (0.48, 0.05, -0.02, np.pi - 0.1)], [0, 1], time)
    angle = _turn(time)
    child = _points(0.22, -0.03 + 0.07 * np.sin(angle), -0.07 + 0.07 * np.cos(angle))
    position = np.stack((adult, child), axis=1).reshape(STEPS, 3)
    phi = np.column_stack((phi, np.full(half, np.pi))).reshape(STEPS)
    return position, phi, np.tile([0.33, 0.19], half), np.tile([0.27, 0.16], half)


@trajectory
def random_walk() -> tuple:
    """Wander at random, but smoothly and from a fixed seed, within the space that the arm reaches."""
    # RandomState: its stream is frozen; numpy's newer generators may change between versions.
    random = np.random.RandomState(2008)
    home = np.array([0.30, -0.10, -0.10, np.pi])
    noise = np.array([0.004, 0.004, 0.004, 0.02])
    state, velocity = home, np.zeros(4)
    path = np.empty((STEPS, 4))
    for n in range(STEPS):
        path[n] = state
        # The pull toward home keeps the hand within reach.
        velocity = 0.95 * velocity + 0.02 * (home - state) + noise * random.standard_normal(4)
        state = state + velocity
    return path[:, :3], path[:, 3]


@trajectory
def out_of_reach() -> tuple:
    """Follow an object that moves 15 cm out of reach and comes back."""
    distances = 0.42, DEFAULT_D1 + DEFAULT_D2 + 0.15, 0.42
    position, _ = _via([(r, 0, 0, 0) for r in distances], [0.0, 0.5, 1.0])
    return _spherical(position[:, 0], 0.1, -0.1), np.pi - 0.7


@hands
def pick_and_place() -> tuple:
    """Pick up a part with the flange of a KUKA iiwa14, and put it down elsewhere, turned by a right angle."""
    over, part, aside, bin_ = (0.5, -0.2, 0.5), (0.6, -0.2, 0.3), (0.4, 0.35, 0.5), (0.4, 0.45, 0.35)
    rests = [(*over, 0.0), (*part, 0.5), (*part, 0.5), (*over, 0.5), (*aside, 2.07), (*bin_, 2.07), (*aside, 2.07)]
    position, yaw = _via(rests, [0.0, 0.2, 0.25, 0.4, 0.7, 0.85, 1.0])
    q = np.column_stack((0 * yaw, np.cos(yaw / 2), np.sin(yaw / 2), 0 * yaw))  # the flange points down
    return position, -1.0, 0.42, 0.4, q, 0.126


@hands
def writing() -> tuple:
    """Write a line of small loops on an upright board with a pen that leans, and rocks with each stroke."""
    stroke = 2 * np.pi * 6 * TIME
    position = _points(0.45, 0.10 - 0.20 * TIME + 0.015 * np.sin(stroke), -0.05 + 0.02 * np.cos(stroke))
    lean = np.radians(120 + 5 * np.sin(stroke)) / 2
    q = np.column_stack((np.cos(lean), 0 * lean, np.sin(lean), 0 * lean))
    return position, np.pi - 0.05 * TIME, DEFAULT_D1, DEFAULT_D2, q, 0.12


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the named trajectory as CSV."""
    parser = argparse.ArgumentParser("python -m model.io.trajectories", description=main.__doc__)
    parser.add_argument("name", choices=[*TRAJECTORIES, *HANDS])
    sys.stdout.write(format_csv(make(parser.parse_args(arguments).name)))


if __name__ == "__main__":
    main()
