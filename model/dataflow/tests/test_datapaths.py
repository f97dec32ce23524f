# SPDX-License-Identifier: Apache-2.0
"""Test the bit-true datapaths: accuracy in the reachable workspace, unit quaternions and exact flags for arbitrary
words, equations of model and RTL, and the program of the fold datapath. For the whole arm, test also poses with exact
angles, branches, limits, and the choice of a branch against an independent search of all eight.

Angles are in radians, distances relative to the reach.
"""

import ast
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from model.bounds import predict, tolerances
from model.dataflow import fixed
from model.dataflow.angles import table
from model.dataflow.choose import STEP_BITS, eps
from model.dataflow.datapaths import CONFIGURATIONS, MODELS
from model.dataflow.fold.program import PROGRAMS, ConflictError, codes, encode, fields, program, schedule, schedules
from model.dataflow.fold.shown import shown
from model.io import stimuli
from model.io.flags import AT_SHOULDER, BAD_HAND, CORE_FLAGS, OVER_BIT, SATURATED, UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, corners, hand_poses, mixed, random_reachable, region
from model.io.words import FIELDS, RESULT_FIELDS, from_words, result_values
from model.reference.equations import solve_clamped
from model.reference.joints import NEGATED_BY, TURNED_BY
from model.reference.kinematics import angle_between, forward, rotate
from model.reference.lean_equations import solve_lean

WORST = {
    16: (-32753, -3, -22, -19265, 73, 32752),
    18: (58796, 28913, -498, 66209, 867, 65679),
    24: (8214755, -355, 3059, 4008309, 250, 8214765),
    27: (67077117, 0, 768, -67108864, 49495, 67108861),
    32: (1073715856, -320, 176, 434768086, 4177478, 1073729441),
}
"""Tested word length -> target for which a search found the largest wrist error of the lean datapath."""

ANGLE_ULPS = dict.fromkeys(WORST, 3) | {32: 21}
"""Word length -> tolerance of the lean datapath's shoulder and elbow angles, ulps of a result; 2e-8 rad at W = 32."""

every_width = pytest.mark.parametrize("width", WORST)


def ulp(width: int) -> float:
    return 2.0 ** (2 - width)


class Run:
    """Results of a datapath for input words, with their errors against double precision."""

    def __init__(self, words: np.ndarray, width: int, datapath: str = "lean", solve=solve_lean) -> None:
        self.words, self.width = words, width
        self.answer = fixed.run(words, width, datapath)
        values, self.at = result_values(self.answer.results, width), from_words(words, 0, width, "words")
        pose = solve(self.at.x, self.at.y, self.at.z, self.at.phi, self.at.d1, self.at.d2)
        self.exact = np.column_stack([pose[name] for name in RESULT_FIELDS])
        self.elbow, self.hand = self.off(values)
        self.shoulder_angle = angle_between(values[:, :4], self.exact[:, :4])
        self.elbow_angle = angle_between(*(np.pad(q[:, 4:], ((0, 0), (0, 2))) for q in (values, self.exact)))
        self.norms = [np.abs((q**2).sum(axis=1) - 1) / ulp(width) for q in (values[:, :4], values[:, 4:])]

    def off(self, poses: np.ndarray) -> list[np.ndarray]:
        """Return (distance from the correct point) / reach of elbow and wrist for result values (N, 6)."""
        at, reached = self.at, self.answer.flags & UNREACHABLE == 0
        exact, found = (forward(q[:, :4], q[:, 4:], at.d1, at.d2) for q in (self.exact, poses))
        aims = exact[0], np.where(reached[:, None], at.position, exact[1])
        reach = np.maximum(np.abs(at.d1) + np.abs(at.d2), ulp(self.width))
        return [np.linalg.norm(point - aim, axis=1) / reach for point, aim in zip(found, aims, strict=True)]

    def below(self, error: np.ndarray, tolerance, what: str) -> None:
        """Assert that no error exceeds its tolerance; name the worst target."""
        n = int(np.argmax(error / tolerance))
        most = np.broadcast_to(tolerance, error.shape)[n]
        assert error[n] <= most, f"{what} {error[n]:.3g}, above {most:.3g}, at {self.words[n].tolist()}"

    def check_accuracy(self) -> None:
        """Assert the tolerances of the lean datapath."""
        for name in ("hand", "elbow"):
            self.below(getattr(self, name), tolerances.LEAN[self.width], f"{name} error / reach")
        for name in ("shoulder_angle", "elbow_angle"):
            self.below(getattr(self, name), ANGLE_ULPS[self.width] * ulp(self.width), f"{name} error (rad)")

    def check_words(self, permitted, where: str = "") -> None:
        """Assert |Qs|^2 and |Qe|^2 within ``permitted`` ulps of 1, right signs and flags, and words inside formats."""
        for name, off, tolerance in zip(("Qs", "Qe"), self.norms, permitted, strict=True):
            self.below(off, tolerance, f"|{name}|^2 - 1 in ulps:")
        results, flags = self.answer.results, expected_flags(self.words, self.width)
        assert (results[:, 3] >= 0).all(), f"the k part of Qs is negative{where}"
        assert (results[:, 4] >= 0).all() and (results[:, 5] <= 0).all(), f"signs of Qe{where}"
        wrong = np.flatnonzero(self.answer.flags != flags)
        assert not len(wrong), f"flags of {self.words[wrong[0]].tolist()}: {self.answer.flags[wrong[0]]}"
        for name, node in self.answer.nodes.items():
            value = np.asarray(node.value)
            assert ((value >= node.format.low) & (value <= node.format.high)).all(), f"{name} leaves its format{where}"


def walks(width: int) -> np.ndarray:
    """Return targets at limits of formats, reach and equations, and the same with one word moved by up to 24 LSBs."""
    steps = np.arange(-24, 25)[:, None] * np.eye(len(FIELDS), dtype=np.int64)[:, None]
    rows = np.concatenate([target + steps.reshape(-1, len(FIELDS)) for target in corners(width).values()])
    return rows[(np.abs(rows) < 1 << (width - 1)).all(axis=1)]


@every_width
def test_lean_is_accurate_in_each_region_and_across_each_limit(width):
    for name in REGIONS:
        run = Run(region(name, 9000, width, seed=1), width)
        assert not (run.answer.flags & UNREACHABLE).any(), name
        run.check_accuracy()
        run.check_words(tolerances.LEAN_NORMS[width], f" in {name}")
    run = Run(walks(width), width)
    run.check_accuracy()
    for bit in CORE_FLAGS.values():
        assert set((run.answer.flags & bit).tolist()) == {0, bit}, "walks cross each limit"


@every_width
def test_worst_targets(width):
    run = Run(np.array([WORST[width]]), width)
    for most in (tolerances.sought(width), predict.predicted_error(run.words, width, "lean")):
        run.below(run.hand, most, "hand error / reach")
    run.check_words(tolerances.LEAN_NORMS[width])


@pytest.mark.parametrize(
    "width", [w if w == 18 else pytest.param(w, marks=[pytest.mark.slow, pytest.mark.cost(5)]) for w in WORST]
)
def test_hand_error_of_the_paper_stays_below_its_prediction(width):
    run = Run(random_reachable(2000, width, 3), width, "paper", solve_clamped)
    predicted = predict.predicted_error(run.words, width, "paper")
    run.below(run.hand, predicted, "hand error / reach")
    assert np.median(run.hand / predicted) > 0.05, "the prediction is too wide"


@every_width
@pytest.mark.parametrize("datapath", ["lean", "paper"])
def test_every_input_has_a_unit_answer_and_exact_flags(datapath, width):
    tiny = np.random.default_rng((1, width)).integers(-3, 4, (3000, len(FIELDS)))
    words = np.concatenate([mixed(12000, width, 1), tiny, stimuli.edges(3000, width, 1), walks(width)])
    run = Run(words, width, datapath, solve_clamped)
    run.check_words(tolerances.LEAN_NORMS[width] if datapath == "lean" else [tolerances.PAPER_NORM] * 2)
    assert np.bitwise_or.reduce(run.answer.flags) == sum(CORE_FLAGS.values()), "every kind of target"


@pytest.mark.parametrize(("datapath", "width"), [*(("lean", w) for w in WORST), ("paper", 18), ("paper", 32)])
def test_clamps_as_double_precision_does(datapath, width):
    """Check clamped targets against double precision, and that Qe is exactly -i or 1."""
    words = stimuli.unreachable(6000, width, 6)
    if datapath == "lean":
        words = np.concatenate([words, walks(width)])
        words = words[expected_flags(words, width) & (UNREACHABLE | AT_SHOULDER) != 0]
    run = Run(words, width, datapath, solve_clamped)
    one = 1 << (width - 2)
    assert set(map(tuple, run.answer.results[:, 4:].tolist())) == {(0, -one), (one, 0)}
    if datapath == "lean":
        run.check_accuracy()
    else:
        run.below(run.elbow_angle, 1e-12, "elbow angle error (rad)")
        assert np.quantile(run.shoulder_angle, 0.99) < 2.0 ** (9 - width)


@pytest.mark.parametrize(("datapath", "width"), [*(("lean", w) for w in WORST), ("paper", 32)])
def test_scale_does_not_matter(datapath, width):
    """Check that lengths divided by 4 give the same bits."""
    lengths = [0, 1, 2, 4, 5]
    words = np.concatenate([region(name, 200, width, 9) for name in REGIONS])
    words[:, lengths] &= ~3
    words = words[(words[:, 4:] > 0).all(axis=1)]
    if datapath == "paper":  # paper drops a bit of long d1 and d2
        words = words[(words[:, 4:].sum(axis=1) < 1 << (width - 1)) & (expected_flags(words, width) == 0)]
    assert len(words) > 100
    quarter = words.copy()
    quarter[:, lengths] >>= 2
    big, little = (fixed.run(w, width, datapath) for w in (words, quarter))
    assert (big.flags == little.flags).all() and (big.results == little.results).all()


PYTHON = {r"\|([^|]+)\|": r"abs(\1)", r"\^": "**", " = ": " == ", r"sqrt (\w+)": r"sqrt(\1)", r"\?": "if", ":": "else"}
"""Pattern in an equation -> Python; c ? a : b gives c if a else b, in which :func:`python` exchanges c and a."""

FUNCTIONS = {"sqrt": lambda v: np.sqrt(max(v, 0)), "most": np.inf}


def python(text: str):
    """Return the right side of an equation as code for one target."""
    for pattern, replacement in PYTHON.items():
        text = re.sub(pattern, replacement, text)
    tree = ast.parse(text, mode="eval")
    for choice in ast.walk(tree):
        if isinstance(choice, ast.IfExp):
            choice.test, choice.body = choice.body, choice.test
    return compile(tree, "equation", "eval")


@pytest.mark.parametrize("datapath", ["lean", "arm", "paper"])
def test_the_equation_is_what_the_operation_computes(datapath):
    """Check that each node's equation text, evaluated in double precision, gives the node's value."""
    words = random_reachable(200, 24, 3)
    run = fixed.run(hand_poses(words, 24, 1) if datapath == "arm" else words, 24, datapath).nodes
    values, no_text = predict.Real(run, {}).values, ("input", "even", "trig", "sincos", "normalize")
    nodes = [n for n in run.values() if n.kind not in no_text and not re.search("leading|outside", n.right_side)]
    nodes = [node for node in nodes if datapath != "arm" or node.section == "hand"]
    assert len(nodes) > {"lean": 100, "arm": 20, "paper": 180}[datapath]
    for node in nodes:
        columns = (values[o.name] if o.format.width == 1 else values[o.name] * 1.0 for o in node.operands)
        rows = zip(*(np.broadcast_to(column, len(words)) for column in columns), strict=True)
        code, names = python(node.right_side), [operand.name for operand in node.operands]
        with np.errstate(divide="ignore", invalid="ignore"):
            computed = [eval(code, FUNCTIONS, dict(zip(names, row, strict=True))) for row in rows]
            off = np.abs(np.array(computed) * 1.0 - values[node.name] * 1.0)
        most = 4 * node.format.ulp if node.section == "guard" and node.frac else 1e-9
        assert off[np.isfinite(off)].max() <= most, node.name


SECTIONS = [(name, of) for name in ("choose", "paper") for of in MODELS[name].sections if of != "results"]


@pytest.mark.parametrize(("datapath", "section"), SECTIONS)
def test_the_verilog_has_the_equation_of_each_operator(datapath, section):
    """Check that each operator has a comment with the paper's number and the equation, both as in the model."""
    path = MODELS[datapath]
    (file,) = (Path(__file__).parents[3] / "rtl").glob(f"**/{path.module(section)}.v")
    text = file.read_text(encoding="utf-8")
    nodes = {node.name: node for node in fixed.nodes(datapath, 32).values() if node.section == section}
    commented = re.findall(r"^ *// (?:\(\d+\) )*(\w+) = (.*)$", text, re.MULTILINE)
    in_rtl = {name: equation for name, equation in commented if name in nodes}
    assert in_rtl == {name: nodes[name].right_side for name in in_rtl}
    for node in nodes.values():
        if node.kind not in ("choose", "input"):  # these may be a line of Verilog instead of an operator
            named = re.search(rf"{re.escape(node.equation)}.*\b{node.name} = ", text) and node.name in in_rtl
            assert named, f"{path.module(section)}.v lacks the comment {node.equation} {node.name} = {node.right_side}"


each_program = pytest.mark.parametrize("name", PROGRAMS)


@each_program
def test_a_schedule_has_the_same_program_at_every_word_length(name):
    for width in CONFIGURATIONS["fold"].widths:
        pair = program(width, name)[1], program(min(of for of in schedules(name) if width <= of), name)[1]
        one, other = ([of.word(clock) for clock in range(of.period)] for of in pair)
        assert one == other, f"W = {width}"


def test_the_units_of_both_programs_have_the_same_codes():
    """Check that the whole arm's codes extend the core's: ik_fold_arm contains units of ik_fold."""
    own = "source", "input", "result", "sign", "b_by"
    for field, of in codes().items():
        if field not in own[:3]:
            assert codes("fold_arm")[field][: len(of)] == of and fields("fold_arm")[field] == fields()[field]
        assert field in own or codes("fold_arm")[field] == of


@each_program
def test_steps_in_the_clocks_of_another_step_are_refused(name):
    """Check that two steps that need a field or a place in the same clock are refused.  A step in a wrong clock without
    such a conflict gives wrong nodes in the RTL, which `tb/core/test_every_node.py` finds."""
    lowering, found = PROGRAMS[name](24), schedule(24, name)
    first, *others = lowering.groups()
    for other in others[::7]:
        with pytest.raises(ConflictError, match="twice|lives|no place"):
            encode(lowering, replace(found, starts=found.starts | {other: found.starts[first]}), name)


@pytest.mark.parametrize(("name", "flow"), [("fold", "lean"), ("fold_arm", "arm")])
def test_every_node_is_shown_before_the_result_leaves(name, flow):
    lowering, made = program(24, name)
    _, last = made.results
    found = shown(lowering, made)
    assert list(found) == list(fixed.nodes(flow, 24))
    assert max(of.time for of in found.values()) == last + 1
    assert fixed.latency(name, 24) == last + 1 - max(made.loads.values())
    without = replace(made, steps=[placed for placed in made.steps if placed.step.name != "az_tilt_sq"])
    with pytest.raises(LookupError, match="no location in the fold datapath for az_tilt_sq"):
        shown(lowering, without)


# ---- whole arm -------------------------------------------------------------------------------------------------------


@every_width
def test_the_arm_is_accurate_in_each_region(width):
    for name in REGIONS:
        words = hand_poses(region(name, 900, width, seed=1), width, 1)
        answer = fixed.run(words, width, "arm", np.arange(len(words)) % 8)
        flags, errors = answer.flags, tolerances.pose_errors(words, answer.results, answer.flags, width)
        assert not (flags & (SATURATED | BAD_HAND)).any() and (flags & UNREACHABLE == 0).mean() > 0.5, name
        for what, error in zip(("point", "orientation"), np.nan_to_num(errors), strict=True):
            n = int(error.argmax())
            assert error[n] <= 1, f"{what} is off by {error[n]:.3g} of the tolerance at {words[n].tolist()}"


@every_width
def test_every_input_has_an_answer(width):
    words = stimuli.any_hands(3000, width, 1)
    ends = [(1 << width - 2) + side * (1 << width - 10) - less for side in (1, -1) for less in (0, 1)]
    words[:4, 7:] = [(0, end, 0, 0) for end in ends]  # just inside and outside both limits of a good hand's length
    answer = fixed.run(words, width, "arm")
    for name, node in answer.nodes.items():
        value = np.asarray(node.value)
        assert ((value >= node.format.low) & (value <= node.format.high)).all(), f"{name} leaves its format"
    # flags, in Python's integers
    one, (low, high) = 1 << width - 2, (-(1 << width - 1), (1 << width - 1) - 1)
    square = (words[:, 7:].astype(object) ** 2).sum(axis=1)
    bad = (256**2 * square < (255 * one) ** 2) | (256**2 * square >= (257 * one) ** 2)
    assert (answer.flags & BAD_HAND > 0).tolist() == bad.tolist() and 0.5 < bad.mean() < 1
    core = np.column_stack([*(answer.nodes[axis].value for axis in "xyz"), words[:, 3:6]])
    assert (answer.flags & sum(CORE_FLAGS.values()) == expected_flags(core, width)).all()
    # the wrist is exact without a tool, and limited to the format
    hand = np.where(bad[:, None], (1, 0, 0, 0), words[:, 7:] / one)
    offset = rotate(hand, (0.0, 0.0, 1.0)) * np.where(bad, 0, words[:, 6])[:, None]
    offset[:, 2] += (1 - (hand**2).sum(axis=1)) * np.where(bad, 0, words[:, 6])  # 1 - 2 ii - 2 jj
    wrist = words[:, :3] - offset
    assert np.abs(core[:, :3] - np.clip(wrist, low, high)).max() <= 1.5  # roundings of r, times a tool of 2
    beyond = ((wrist > high + 1.5) | (wrist < low - 1.5)).any(axis=1)
    inside = ((wrist < high - 1) & (wrist > low + 1)).all(axis=1)
    saturated = answer.flags & SATURATED > 0
    assert saturated[beyond].all() and not saturated[inside].any() and beyond.any()
    # |Qw| = |Qs| |Qe| |h|
    qs, qe, qw = (((answer.results[:, a:b] / one) ** 2).sum(axis=1) for a, b in ((7, 11), (11, 13), (13, 17)))
    assert np.abs(qw - qs * qe * (hand**2).sum(axis=1)).max() <= 3 / one
    assert answer.flags.max() < 512


@every_width
def test_poses_with_exact_angles(width):
    """Check angles 0 (th2, th4, th6 of straight arms) and half a turn (th4 of a closed arm, th6 of a reversed hand)."""
    one, half = 1 << width - 2, 1 << width - 1
    arm = 0, one // 2, one // 2, 0  # phi, d1, d2, tool
    hands = np.array([(one, 0, 0, 0), (-one, 0, 0, 0), (0, 0, 0, one), (one, 0, 0, 0), (0, one, 0, 0)])
    heights = np.array([one, one, one, 0, one])[:, None]
    words = np.column_stack([0 * heights, 0 * heights, heights, np.tile(arm, (5, 1)), hands])
    th = fixed.run(words, width, "arm").results[:, :7]
    assert (th[:3, [1, 3, 5]] == 0).all() and th[3, 3] == th[4, 5] == -half
    sums = (th[:3, [0, 2, 4, 6]].sum(axis=1) + half) % (2 * half) - half
    assert (np.abs(sums[:2]) <= 2).all() and abs(abs(sums[2]) - half) <= 2


@every_width
def test_a_branch_turns_and_negates_words(width):
    words, half = stimuli.any_hands(400, width, 2), 1 << width - 1
    own = fixed.run(words, width, "arm").results
    for branch in range(1, 8):
        found = fixed.run(words, width, "arm", branch).results
        bits = np.array([branch >> k & 1 for k in range(3)])
        moved = np.where(NEGATED_BY @ bits & 1, -own[:, :7], own[:, :7]) + half * (TURNED_BY @ bits & 1)
        off = (found[:, :7] - moved) % (2 * half)
        assert (found[:, 7:] == own[:, 7:]).all() and set(off.ravel().tolist()) <= {0, 1}  # 1: a negated tie
        ties = (NEGATED_BY @ bits & 1 > 0) & (sum(table(width)) % 2 == 0)  # no tie if the sum of the table is odd
        assert off.any(axis=0).tolist() == ties.tolist()


@every_width
def test_over_limit_is_exact(width):
    half = 1 << width - 1
    words, random = stimuli.any_hands(600, width, 3), np.random.default_rng(width)
    th = fixed.run(words, width, "arm").results[:, :7]
    for _ in range(12):
        anywhere, angles = random.integers(-half, half, (7, 2)), th[random.integers(len(th)), :, None]
        limits = np.where(random.random((7, 2)) < 0.5, angles, anywhere)
        limits += random.integers(-1, 2, limits.shape)
        limits[random.integers(7)] = -half, half - 1
        limits = (limits + half) % (2 * half) - half
        over = fixed.run(words, width, "arm", 0, limits.tolist()).flags >> OVER_BIT
        for k, (low, high) in enumerate(limits.tolist()):
            arc = [(low <= v <= high) if low <= high else (v >= low or v <= high) for v in th[:, k].tolist()]
            assert (over >> k & 1).tolist() == [not within for within in arc]


def searched(joints, references, limits, width):
    """Return each branch's largest joint step (8, N) and joints (8, N, 7), and the mask (N,) of singular poses."""
    turn, half, joints = 1 << width, 1 << width - 1, joints.copy()
    singular = np.zeros(len(joints), dtype=bool)
    for first, middle, last in ((0, 1, 2), (4, 5, 6)):
        distance = np.abs((joints[:, middle] + half // 2) % half - half // 2)
        near = distance < eps(width)
        opposite = np.abs(joints[:, middle]) > turn // 4
        swing = joints[:, first] - references[:, first]
        joints[:, last] += np.where(near, np.where(opposite, -swing, swing), 0)
        joints[:, first] -= np.where(near, swing, 0)
        singular |= near
    low, high = np.transpose(limits)
    steps, all_joints = [], []
    for branch in range(8):
        bits = branch >> np.arange(3) & 1
        changed = np.where(NEGATED_BY @ bits & 1, -joints, joints) + half * (TURNED_BY @ bits & 1)
        at, span = (changed - low) % turn, (high - low) % turn
        gap = at - (references - low) % turn
        gap = np.where(span == turn - 1, (gap + half) % turn - half, gap)
        size = np.where(gap < 0, -gap - 1, gap) >> width - STEP_BITS
        steps.append(np.where(at > span, 2 * (1 << STEP_BITS) - 1, size).max(axis=1))
        all_joints.append((changed + half) % turn - half)
    return np.array(steps), np.array(all_joints), singular


@pytest.mark.parametrize("width", [16, 24, 32])
def test_no_branch_has_a_smaller_step(width):
    limits = stimuli.arm_limits(width, long=True)
    words = stimuli.referenced(stimuli.arm_targets(3000, width, 1), width, 1)
    answer = fixed.run(words[:, :-1], width, "choose", words[:, -1], limits)
    given = fixed.run(words[:, :11], width, "arm", words[:, -1], limits)
    steps, joints, singular = searched(given.results[:, :7], words[:, 11:18], limits, width)
    flags, rows = answer.flags, np.arange(len(words))
    changed = (flags >> 16 & 7) ^ words[:, -1]
    assert (steps[changed, rows] == steps.min(axis=0)).all()
    assert (flags >> 19 & (2 << STEP_BITS) - 1 == steps.min(axis=0)).all()
    assert (answer.results[:, :7] == joints[changed, rows]).all()
    assert (answer.results[:, 7:] == given.results[:, 7:]).all()
    assert (flags >> 32 & 255 == (steps < 1 << STEP_BITS).T @ (1 << np.arange(8))).all()
    assert (flags >> 40 == singular).all()
    inside = (flags >> 31 & 1) == 0
    assert (flags[inside] >> 9 & 127 == 0).all() and (flags[~inside] >> 9 & 127 != 0).all()
    assert 0.1 < inside.mean() < 0.95 and 0.01 < singular.mean() < 0.5
