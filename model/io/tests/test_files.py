# SPDX-License-Identifier: Apache-2.0
"""Test target files, host scaling, words, expected flags, built-in trajectories and example files."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from model.io import trajectories
from model.io.files import format_csv, read_csv
from model.io.flags import TOO_FAR, TOO_NEAR, expected_flags
from model.io.stimuli import extremes
from model.io.words import FIELDS, TargetError, Targets, from_words, scale_exponent, to_words
from model.reference.kinematics import matrix


def targets(x=0.3, y=0.0, z=0.0, phi=math.pi, d1=0.33, d2=0.27):
    """Return targets; phi, d1 and d2 default to the values that apply to a target file without these columns."""
    return Targets("t", x, y, z, phi, d1, d2)


def assert_same(a, b):
    for field in FIELDS:
        np.testing.assert_array_equal(getattr(a, field), getattr(b, field), err_msg=field)


@pytest.fixture
def read(tmp_path):
    """Return a function that writes text (or bytes) to a file and reads it as targets."""

    def read(content, **defaults):
        path = tmp_path / "t.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_csv(path, **defaults)

    return read


def test_defaults_and_columns_that_override_them(read):
    result = read("x,y,z\n0.1,0.2,0.3\n-4e-1,+.5,6.\n")
    assert_same(result, targets([0.1, -0.4], [0.2, 0.5], [0.3, 6.0]))
    result = read("d2,z,x,y\n0.5,3,1,2\n", d1=0.7, d2=9.0, phi=0.25)
    assert_same(result, targets(1, 2, 3, 0.25, 0.7, 0.5))


@pytest.mark.parametrize(
    "content",
    [
        b"\xef\xbb\xbfx,y,z\r\n1,2,3\r\n\r\n\r\n",
        b"x,y,z\r1,2,3\r",
        b" x , Y , z \n 1 ,\t2 , 3 ",
        b'"x","y","z"\n"1","2","3"\n',
        b"\n# made by hand\n\nx,y,z\n#0,0,0\n\n1,2,3\n",
        b"x;y;z\n1,0;2.0;+3,e0\n",
        b"x\ty\tz\n1\t2\t3\n",
        b"x,y,z\n1,2,3\n,,\n , ,\n",
    ],
)
def test_accepted_forms(read, content):
    assert_same(read(content), targets(1, 2, 3))


def test_other_columns_are_kept(read):
    result = read('t,Name,y,,PHI,x,z\n0.1,"a, b",2,,0.5,1,3\n0.2,c,2,-,0.5,1,3\n')
    assert_same(result, targets(1, [2, 2], 3, 0.5))
    assert result.others == {"t": ["0.1", "0.2"], "Name": ["a, b", "c"], "column 4": ["", "-"]}
    assert result.default_arm == ("d1", "d2")


def test_roll_pitch_and_yaw(read):
    """Check hand orientations against scipy, and check that writing and reading the targets preserves them."""
    angles = np.random.default_rng(1).uniform(-3, 3, (20, 3))
    result = read("x,y,z,Roll,pitch,YAW\n" + "".join(f"1,2,3,{','.join(map(repr, row))}\n" for row in angles.tolist()))
    np.testing.assert_allclose(matrix(result.hand), Rotation.from_euler("xyz", angles).as_matrix(), atol=1e-15)
    np.testing.assert_array_equal(read(format_csv(result)).hand, result.hand)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "the file is empty"),
        ("x,y,z\n", "row 1: a header but no targets below it"),
        ("x,y\n1,2\n", "row 1, column z: is missing"),
        ("1,2,3\n4,5,6\n", "row 1, column 1: '1,2,3' is not a header; expected x,y,z and optionally phi,d1,d2"),
        ("\n\n,2,3\n4,5,6\n", "row 3, column (no name): ',2,3' is not a header"),
        ("x,y,X,z\n1,2,3,4\n", "row 1, column x: 'x' appears twice in the header"),
        ("x;y;z\n1;2,1,1;3\n", "row 2, column y: '2.1,1' is not a number"),
        ("x\ty\tz\n1\t2,5\t3\n", "row 2, column y: '2,5' is not a number"),
        ("#\nx,y,z\n1,2,3\n\n# 1\n1,2\n", "row 6, column z: '' is missing: the header has 3 columns, this row has 2"),
        ("x,y,z\n1,2,3,4\n", "row 2, column 4: '4' is one too many: the header has 3 columns, this row has 4"),
        ("x,y,z\n1,,3\n", "row 2, column y: '' is empty"),
        ("x,y,z\n1,1_0,3\n", "row 2, column y: '1_0' is not a number"),
        ("x,y,z\n1,٣,3\n", "row 2, column y: '٣' is not a number"),
        ('x,y,z\n1,"2\n2",3\n', r"row 2, column y: '2\n2' is not a number"),
        ('x,y,z\n1,2,"3\n"\nq,2,3\n', "row 4, column x: 'q' is not a number"),
        ("x,y,z\n1," + "q" * 1000 + ",3\n", "row 2, column y: '" + "q" * 40 + "...' is not a number"),
        ("x,y,z\n1,2,nan\n", "row 2, column z: 'nan' is not a finite number"),
        ("x,y,z,d1,d2\n1,2,3,1,1e-400\n", "row 2, column d2: '1e-400' is not positive"),
        ("x,y,z,qw\n1,2,3,1\n", "row 1, columns qx, qy, qz: are missing; the header is 'x,y,z,qw'"),
        ("x,y,z,Roll,yaw\n1,2,3,1,2\n", "row 1, column pitch: is missing; the header is 'x,y,z,roll,yaw'"),
        ("x,y,z,qw,roll\n1,2,3,1,2\n", "row 1, column roll: 'x,y,z,qw,roll' has both a quaternion and roll"),
        ("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,.5,0,1\n", "row 3, column qw: '1' is part of a quaternion"),
        ("x,y,z,qw,qx,qy,qz\n1,2,3,0,0,0,0\n", "row 2, column qw: '0' is part of a quaternion of length 0, not 1"),
        ("x,y,z,qw,qx,qy,qz,tool\n1,2,3,1,0,0,0,\n", "row 2, column tool: '' is empty"),
        ("x,y,z,QW,qx,qy,qz,branch\n1,2,3,1,0,0,0,8\n", "row 2, column branch: '8' is not a whole number from 0 to 7"),
        ("x,y,z,qw,qx,qy,qz,branch\n1,2,3,1,0,0,0,.5\n", "row 2, column branch: '0.5' is not a whole number from 0"),
        ('x,y,z\n1,2,3\n1,"2,3\n', "row 3: not CSV: unexpected end of data"),
        (b"x,y,z\n1,2,3\n1,\xff,3\n", "row 3: not UTF-8 text (byte 0xff)"),
        ("x,y,z\n1,2,3\n".encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    ],
)
def test_bad_files_are_named_in_one_line(read, tmp_path, content, message):
    with pytest.raises(TargetError) as error:
        read(content)
    text = str(error.value)
    assert text.startswith(f"{tmp_path / 't.csv'}: {message}")
    assert len(text.splitlines()) == 1


@pytest.mark.parametrize(("name", "message"), [("none.csv", r"none\.csv: no such file$"), (".", "is a directory")])
def test_missing_file_and_directory(tmp_path, name, message):
    with pytest.raises(TargetError, match=message):
        read_csv(tmp_path / name)


@pytest.mark.parametrize("default", [{"d1": 0.0}, {"d2": math.nan}, {"phi": math.inf}])
def test_bad_defaults(read, default):
    with pytest.raises(TargetError, match=f"default of {next(iter(default))}: '.*' is not"):
        read("x,y,z\n1,2,3\n", **default)


def test_files_keep_every_bit(read):
    table = np.random.default_rng(1).integers(0, 2**64, (500, 6), dtype=np.uint64).view(np.float64)
    table[:, 4:] = np.abs(table[:, 4:])
    written = Targets("t", *table[np.isfinite(table).all(axis=1)].T)
    assert_same(read(format_csv(written)), written)


def test_far_targets_lower_the_exponent_until_the_headroom_ends():
    """Check the exponent for a reach of 1: coordinates below 2 use no headroom, those below 32 use up to four bits."""
    arm = {"d1": 0.5, "d2": 0.5}
    ends = (0.0, 0), (math.nextafter(2, 0), 0), (2.0, -1), (-2.0, 0), (math.nextafter(-2, -3), -1)
    for x, exponent in (*ends, (math.nextafter(32, 0), -4), (-32, -4)):
        assert scale_exponent(targets(x=x, **arm), 32) == exponent, x
    for d1, d2, exponent in ((0.33, 0.27, 1), (1.0, 0.9999, 0), (1.0, 1.0, -1), (1e-9, 1e-9, 29)):
        assert scale_exponent(targets(x=0.0, d1=d1, d2=d2), 32) == exponent, d1
    for x in (32.0, math.nextafter(-32, -math.inf), 1e300):
        with pytest.raises(TargetError, match=f"column x: '{x!r}' is too far out.*-32 to 32".replace("+", r"\+")):
            scale_exponent(targets(x=x, **arm), 32)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0.1,0.2,0.3,1,1\n0.1,50,0.3,1,1\n0.1,0.2,-1e6,1,1\n", "row 4, column z: '-1000000.0' is too far out"),
        ("0.1,0.2,0.3,1,1\n0.1,0.2,0.3,1,1e-5\n", "row 3, column d2: '1e-05' is too short.*rounds to 0 in 16 bits"),
        ("0,0,0,1,1\n0,0,0,1e308,1e308\n", r"row 3, column d1: '1e\+308' is too long"),
    ],
)
def test_a_target_without_words_is_named_with_its_row(read, rows, message):
    with pytest.raises(TargetError, match=rf"t\.csv: {message}"):
        to_words(read("x,y,z,d1,d2\n" + rows), 16)


def test_rounding_and_saturation():
    """Check that lengths round half to even, that a length just below 2 saturates, and that angles wrap."""
    words, exponent = to_words(targets(x=math.nextafter(2, 0), y=-2.0, d1=0.5, d2=0.5), 16)
    assert exponent == 0
    assert words[0].tolist() == [2**15 - 1, -(2**15), 0, -(2**15), 2**13, 2**13]
    x, y, z = np.array([0.5, 1.5, -2.5]) * 2.0**-14
    assert to_words(targets(x, y, z, d1=0.5, d2=0.5), 16)[0][0, :3].tolist() == [0, 2, -2]
    turns = {0: 0, 0.25: 2**14, 0.5: -(2**15), -7.25: -(2**14), 0.5 - 1e-9: -(2**15), 1e6 + 0.125: 2**13}
    words, _ = to_words(targets(phi=np.array([*turns]) * 2 * math.pi), 16)
    assert words[:, FIELDS.index("phi")].tolist() == [*turns.values()]


@pytest.mark.parametrize("width", [16, 17, 24, 31, 32])
@pytest.mark.parametrize("exponent", [-40, 0, 1, 40])
def test_words_come_back_from_their_targets(width, exponent):
    words = extremes(500, width, seed=1)
    there = from_words(words, exponent, width, "t")
    assert ((there.phi >= -math.pi) & (there.phi < math.pi)).all()
    back, same = to_words(there, width, exponent)
    np.testing.assert_array_equal(back, words)
    assert same == exponent


@pytest.mark.parametrize("name", [*trajectories.TRAJECTORIES, *trajectories.HANDS])
def test_trajectory(name):
    """Check reach and smooth motion: steps are below 5 cm (8 % of the reach), and successive steps differ by < 2 cm."""
    targets = trajectories.make(name)
    assert targets.name == name and len(targets) == 100
    for width in (16, 32) if targets.hand is None else ():
        flags = set(expected_flags(to_words(targets, width)[0], width).tolist())
        assert flags == ({0, TOO_FAR} if name == "out_of_reach" else {0})
    for arm in range(arms := 2 if name == "two_arms" else 1):
        step = np.diff(targets.position[arm::arms], axis=0)
        assert np.linalg.norm(step, axis=1).max() < 0.05
        assert np.linalg.norm(np.diff(step, axis=0), axis=1).max() < 0.02
        assert np.abs(np.diff(targets.phi[arm::arms])).max() < 0.25


@pytest.mark.parametrize("name", ["reach", "two_arms"])
def test_example_files_are_up_to_date(name, capsys):
    path = Path(__file__).parents[3] / "examples" / f"{name}.csv"
    trajectories.main([name])
    made = capsys.readouterr().out
    command = f"python -m model.io.trajectories {name} > examples/{name}.csv"
    assert path.read_text(encoding="utf-8") == made, f"run: {command}"


def test_flags_are_exact_at_the_limits():
    """Check targets so near a limit that the compared squares round to equal doubles; other tests cover other flags."""
    long, short = 2**30 + 1, 2**30 - 3
    wrists = [(long + short, 0), (long + short + 1, 0), (long + short, 1), (long - short, 0), (long - short - 1, 0)]
    words = np.array([(x, y, 0, 0, long, short) for x, y in wrists])
    assert expected_flags(words, 32).tolist() == [0, TOO_FAR, TOO_FAR, 0, TOO_NEAR]
    with pytest.raises(ValueError, match="31 bits"):
        expected_flags(words, 31)
