# SPDX-License-Identifier: Apache-2.0
"""What a simulation is given and what it gives, however it is run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


class SimulationError(Exception):
    """The simulation did not come to an end; the message is one or more lines for a person."""


@dataclass
class Job:
    """Targets to run one after the other: ``words`` (N, 6) signed input words."""

    name: str
    words: np.ndarray


@dataclass
class Run:
    """What the RTL made of a job.

    ``results`` (N, 6) signed words and ``flags`` (N,) in input order; ``latency_cycles`` from first in to first out;
    ``total_cycles`` from first in to last out, both included, None of hardware that is only seen through a link;
    ``bit_mismatches`` over all named nodes, or those that are seen, and the first of them as text.
    """

    results: np.ndarray
    flags: np.ndarray
    latency_cycles: int | None
    total_cycles: int | None
    bit_mismatches: int
    first_mismatch: str | None
