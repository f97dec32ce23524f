# SPDX-License-Identifier: Apache-2.0
"""Test the BVH reader and writer against each other, on usual variants of a file and on random files."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.motion import clip as clips
from model.motion.bvh import ClipError, parse
from model.motion.tests import figure

FILE = Path("clip.bvh")


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    return figure.write(tmp_path_factory.mktemp("bvh") / "clip.bvh", frames=4, rich=True).read_text()


def rows_of(text, change):
    head, frames, rows = text.partition("0.0083333\n")
    return head + frames + change(rows)


SAME = {
    "two joints of one name": lambda t: re.sub("LeftShoulder|RightShoulder", "Collar", t),
    "end": lambda t: t.replace("End Site", "END SITE"),
    "other keywords": lambda t: t.replace("JOINT", "Joint").replace("OFFSET", "Offset").replace("CHANNELS", "Channels"),
    "one line": lambda t: t.replace("\n{", " {"),
    "frames": lambda t: t.replace("Frames: 4", "Frames:4").replace("Frame Time: ", "Frame Time:\t"),
    "comments": lambda t: rows_of("# a clip\n" + t.replace("{", "{ # here", 3), lambda rows: "# frames\n" + rows),
    "wrapped rows": lambda t: rows_of(t, lambda rows: re.sub(r"((?:\S+ ){9})", r"\1\n", rows)),
    "lines that ignore rows": lambda t: rows_of(t, lambda rows: "\n".join(rows.split())),
    "dos": lambda t: t.replace("\n", "\r\n"),
    "blank lines": lambda t: t.replace("\n", " \n\n"),
}


@pytest.mark.parametrize("change", SAME.values(), ids=SAME)
def test_variants_of_one_clip(text, change):
    clip, original = parse(change(text).encode(), FILE), parse(text.encode(), FILE)
    assert (clip.table == original.table).all() and not clip.notes
    assert [node.channels for node in clip.nodes] == [node.channels for node in original.nodes]
    assert clip.content().decode().startswith(change(text).partition("Frames")[0])


def test_a_position_channel_replaces_a_coordinate_of_offset(text):
    moved = re.sub("OFFSET .*(?=\nCHANNELS 6)", "OFFSET 7 8 9", text)
    assert moved != text and (parse(moved.encode(), FILE).positions == parse(text.encode(), FILE).positions).all()


@pytest.mark.parametrize(
    ("change", "rows", "note"),
    [
        (lambda t: t.replace("Frames: 4", "Frames: 5"), 4, "4 frames are read; 'Frames: 5' is another number"),
        (lambda t: t.replace("Frames: 4", "Frames: 3"), 4, "4 frames are read; 'Frames: 3' is another number"),
        (lambda t: t[:-20], 3, r"line \d+: \d+ numbers, not \d+: the frame is left out"),
        (lambda t: t.replace("0.0083333", "0"), 4, "'Frame Time: 0': 30 frames per second are shown"),
    ],
)
def test_doubts(text, change, rows, note):
    clip = parse(change(text).encode(), FILE)
    assert re.fullmatch(note, clip.notes[0]) and (clip.table == parse(text.encode(), FILE).table[:rows]).all()
    assert clip.period == (1 / 30 if "Time" in note else 0.0083333)
    assert f"Frames: {rows}\n".encode() in clip.content()


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig", "utf-16"])
def test_encodings(text, encoding):
    content = text.replace("Spine", "Wirbels\u00e4ule").encode(encoding)
    clip = parse(content, FILE)
    assert clip.names[1] == "Wirbels\u00e4ule"
    assert clip.content().startswith(text.partition("Frame Time")[0].replace("Spine", clip.names[1]).encode(encoding))


WORDS = [*"{ } JOINT ROOT End OFFSET CHANNELS MOTION Frames: 0 -1 1e999 1e29 nan".split(), "\n"]


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_a_spoiled_file_is_a_clip_or_an_error(text, data):
    content = text.encode()
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content)))
        new = data.draw(st.sampled_from(WORDS).map(str.encode) | st.binary(max_size=4))
        content = content[:start] + new + content[start + data.draw(st.integers(0, 12)) :]
    try:
        clip = parse(content, FILE)
        again = parse(clip.content(), FILE)
        assert (again.table == clip.table).all() and again.nodes == clip.nodes
        clips.up_axis(clip)
        moves = [clips.motion(clip, arm) for arm in clips.arms(clip)]
        assert all(np.isfinite(move.phi).all() for move in moves)
    except ClipError as error:
        assert "\n" not in str(error)
