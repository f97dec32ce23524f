# SPDX-License-Identifier: Apache-2.0
"""Second opinions on what the core answers: by how much the results differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.io.words import result_values

Apart = dict[str, tuple[int, float]]
"""Opinion -> how many targets it was asked, and the largest difference of a result."""


@dataclass(frozen=True)
class Opinion:
    """The answers (N, 6) of somebody else; ``asked`` (N,) are the targets to which the core's are held."""

    of: str
    answers: np.ndarray
    asked: np.ndarray

    def apart(self, results: np.ndarray, width: int) -> np.ndarray:
        """The largest difference of a target's six results, (N,); inf without an answer, 0 where it was not asked.

        Either sign of Qs is right: where k is 0 within the rounding, which of the two has k >= 0 is chance."""
        values = result_values(results, width)
        sign = np.where((values[:, :4] * self.answers[:, :4]).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        differences = np.abs(values - self.answers * np.where(np.arange(6) < 4, sign, 1.0)).max(axis=1)
        return np.where(self.asked, np.nan_to_num(differences, nan=np.inf), 0.0)


def both(a: Apart, b: Apart) -> Apart:
    """Of the targets of either."""
    none = (0, 0.0)
    return {of: (a.get(of, none)[0] + b.get(of, none)[0], max(a.get(of, none)[1], b.get(of, none)[1])) for of in a | b}
