# SPDX-License-Identifier: Apache-2.0
"""Inputs and results of a simulation, independent of the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


class SimulationError(Exception):
    """Simulation that did not complete; the message has one or more lines for the user."""


@dataclass
class Job:
    """Targets to run in order: ``words`` (N, 6) are signed input words."""

    name: str
    words: np.ndarray


@dataclass
class Run:
    """Results of the RTL for a job.

    ``results`` (N, 6) signed words and ``flags`` (N,) in input order; ``latency_cycles`` from first in to first out;
    ``total_cycles`` from first in to last out, both included, None for hardware behind a link; ``bit_mismatches`` over
    all visible named nodes, ``first_mismatch`` the first of them as text.
    """

    results: np.ndarray
    flags: np.ndarray
    latency_cycles: int | None
    total_cycles: int | None
    bit_mismatches: int
    first_mismatch: str | None
