# SPDX-License-Identifier: Apache-2.0
"""Files of a run: results.csv and results.npz of each trajectory, score.json, and a clip with its arms turned."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pybvh

from model.io.files import write_atomically
from model.io.scoring import Score, write_score_json, write_tables
from model.io.words import result_values
from model.motion import clip as clips
from model.motion import gltf
from scripts.trajectory import Prepared
from tb.sim.simulate import Run

SCORES = "score.json"
CLIP_KINDS = ("bvh", "glb")


def result_paths(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the paths of the results.csv of each trajectory."""
    many = len(prepared) > 1
    return [folder / item.targets.name / "results.csv" if many else folder / "results.csv" for item in prepared]


def of_datapath(folder: Path, prepared: Sequence[Prepared]) -> list[Path]:
    """Return the paths that `write_results` writes for one datapath."""
    tables = result_paths(folder, prepared)
    clip = [folder / f"clip.{kind}" for kind in CLIP_KINDS if prepared[0].clip]
    return [*tables, *(path.with_suffix(".npz") for path in tables), *clip]


def written(out: Path, folders: Iterable[Path], prepared: Sequence[Prepared]) -> list[Path]:
    """Return all paths that `write_results` writes."""
    return [*(path for folder in folders for path in of_datapath(folder, prepared)), out / SCORES]


def elbow_errors(item: Prepared, result: Score) -> np.ndarray:
    """Return the distances between the elbows and the clip's elbows, relative to the reach, (N,)."""
    elbow = np.stack([move.elbow for move in item.moves], axis=1).reshape(-1, 3)
    ours = np.ldexp(result.each.elbow, -result.scale_exponent)
    return np.linalg.norm(ours - elbow, axis=1) / item.targets.reach


def turned(item: Prepared, ran: Run, width: int) -> pybvh.Bvh:
    """Return the clip with its arms turned by the core's quaternions."""
    values = result_values(ran.results, width)
    qs, qe = item.targets.from_core(values[:, :4]), np.pad(values[:, 4:], ((0, 0), (0, 2)))
    arms = len(item.moves)
    return clips.turned(item.clip, [(move, qs[n::arms], qe[n::arms]) for n, move in enumerate(item.moves)])


def turned_clip(item: Prepared, ran: Run, width: int) -> dict[str, bytes]:
    """Return the turned clip as the content of a file for each of CLIP_KINDS."""
    bvh = turned(item, ran, width)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "clip.bvh"
        bvh.write(path)
        return {"bvh": path.read_bytes(), "glb": gltf.animated(bvh, item.targets.name)}


def write_results(
    out: Path, folders: Iterable[Path], prepared: Sequence[Prepared], done: Sequence[Sequence[tuple[Run, Score]]]
) -> None:
    """Write the files of each datapath to its folder, and one score.json."""
    for folder, ran in zip(folders, done, strict=True):
        _write_datapath(folder, prepared, ran)
    write_score_json(out / SCORES, [result for ran in done for _, result in ran])


def _write_datapath(folder: Path, prepared: Sequence[Prepared], done: Sequence[tuple[Run, Score]]) -> None:
    for path, item, (ran, result) in zip(result_paths(folder, prepared), prepared, done, strict=True):
        targets = item.targets
        if item.clip:
            targets = replace(targets, others=targets.others | {"elbow_error": elbow_errors(item, result).tolist()})
            for kind, content in turned_clip(item, ran, result.width).items():
                write_atomically(path.with_name(f"clip.{kind}"), content)
        write_tables(path, targets, ran, result)
