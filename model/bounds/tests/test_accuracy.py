# SPDX-License-Identifier: Apache-2.0
"""Test the proved accuracy: results against the theorems, and the error of each group of nodes against its constant."""

import math

import numpy as np
import pytest

from model.bounds import accuracy as proof
from model.bounds.accuracy import accuracy
from model.bounds.predict import Real
from model.dataflow import fixed
from model.dataflow.fixed import dataflow
from model.io.flags import BAD_HAND, SATURATED, UNREACHABLE, expected_flags
from model.io.stimuli import REGIONS, hand_poses, mixed, region, right_angles, unreachable
from model.io.words import RESULT_FIELDS
from model.reference.joints import Branch, reached, turned
from model.reference.kinematics import angle_between, forward

COUNT = 7000
OTHERS = (16, "lean"), (17, "lean"), (24, "lean"), (27, "lean"), (24, "lean16"), (19, "lean16"), (32, "lean25")
CORES = [(32, "lean"), (18, "lean"), *(pytest.param(*core, marks=pytest.mark.slow) for core in OTHERS)]
WIDTHS = [18, 32, *(pytest.param(width, marks=pytest.mark.slow) for width in (16, 17, 24, 27, 31))]


def poses(width: int, seed: int) -> np.ndarray:
    """Return targets in reach: some of every kind, and some for which roots and rounding have the greatest effect."""
    words = np.concatenate([right_angles(COUNT // 2, width, seed), mixed(COUNT, width, seed)])
    return words[(expected_flags(words, width) & UNREACHABLE == 0) & words[:, :3].any(axis=1)]


def hands(width: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return hand poses (N, 11) of all kinds, many with th2 or th6 near 0 or half a turn, and random branches (N,)."""
    targets = [poses(width, seed), *(region(name, 1500, width, seed) for name in REGIONS)]
    words = hand_poses(np.concatenate(targets), width, seed)
    branch = np.random.default_rng(seed).integers(8, size=len(words))
    good = fixed.run(words, width, "arm", branch).flags & (UNREACHABLE | SATURATED | BAD_HAND) == 0
    return words[good], branch[good]


def length(vectors):
    return np.linalg.norm(vectors, axis=1)


@pytest.mark.parametrize("width, datapath", CORES)
def test_wrists(width, datapath):
    """Check the limits of the wrist's distance from targets in reach and, for all other targets (some are at the
    shoulder), from the nearest point in reach."""
    a, b, c = (float(accuracy(width, datapath)[name]) for name in "abc")
    out = unreachable(COUNT, width, 5)
    for words, clamped in ((poses(width, 1), False), (out[(out[:, 4:] > 0).all(axis=1)], True)):
        p, (d1, d2), answer = words[:, :3].astype(float), words[:, 4:].T, fixed.run(words, width, datapath)
        limit = a * length(p) + b * d2
        if clamped:
            p[~p.any(axis=1), 2] = 1
            reach = np.where(answer.nodes["too_far"].value, d1 + d2, np.abs(d1 - d2))
            p, limit = p * (reach / length(p))[:, None], c * np.maximum(reach, 1)
            assert (reach == 0).any()
        q = answer.results * 2.0 ** (2 - width)
        share = length(forward(q[:, :4], q[:, 4:], d1, d2)[1] - p) / limit * 2.0 ** (width - 2)
        assert 0.1 < share.max() <= 1


@pytest.mark.parametrize("width", WIDTHS)
def test_hands(width):
    """Check the whole arm's theorem, the angles of its CORDICs, and the wrist computed from normalized Qs and Qe."""
    words, branch = hands(width, 1)
    answer, of = fixed.run(words, width, "arm", branch), {name: float(k) for name, k in accuracy(width, "arm").items()}

    def v(names):
        return np.stack([answer.nodes[name].value for name in names.split()], axis=1) * 2.0 ** (2 - width)

    qs, qw, qe, h = v("qs_w qs_i qs_j qs_k"), v("qw_w qw_i qw_j qw_k"), v("qe_w qe_i"), v("h_w h_i h_j h_k")
    (d1, d2, tool), p, th = v("d1 d2 tool_h").T, v("x y z"), answer.results[:, :7].T * (2 * np.pi / 2**width)
    bend, still = np.column_stack([-qe[:, 1], qe[:, 0], 0 * qe]), 0 * th[3]
    plain = branch & Branch.ELBOW == 0  # otherwise both bones are turned about themselves
    errors = {
        "ball, Qs": angle_between(turned(*th[:3]).T, qs) * plain / of["ball, Qs"],
        "elbow": angle_between(turned(still, th[3], still).T, bend) * plain / of["elbow"],
        "ball, Qw": angle_between(turned(*th[4:]).T, qw) * plain / of["ball, Qw"],
    }
    point, hand = reached(th, d1, d2, tool[:, None] * (0.0, 0.0, 1.0))
    errors["orientation"] = angle_between(hand, h) / of["orientation"]
    off = length(point - v("hand_x hand_y hand_z")) - 2 * np.abs((h * h).sum(axis=1) - 1) * np.abs(tool)
    share = of["point"] - of["coordinates"]
    errors["point"] = off / (share * (d1 + d2 + np.abs(tool)) + of["coordinates"])
    off = length(forward(qs / length(qs)[:, None], qe / length(qe)[:, None], d1, d2)[1] - p)
    errors["a, b"] = off / (of["a, arm"] * length(p) + of["b, arm"] * d2)
    for name, error in errors.items():
        assert 0.2 < error.max() * 2.0 ** (width - 2) <= 1, name


def displaced(nodes, members):
    """Yield, eight times, the values (N,) of all nodes when only ``members`` have errors, each at a random end
    of its range. For nodes of tables, the stated error is halved, because any table may have errors of that size."""
    random = np.random.default_rng(3)
    for _ in range(8):
        moved = (nodes[member] for member in members.split())
        sizes = {n: random.choice(n.error, len(nodes["d1"].value)) for n in moved}
        yield Real(nodes, {n.name: e * (0.5 if n.kind in ("rsqrt", "trig") else 1) for n, e in sizes.items()}).values


GROUPS = {
    "azimuth": "u_x u_y",
    "tilt": "sin_el cos_el root_rho inv_s_el",
    "bend": "k_scaled cos_a sin_a inv_11 inv_law_raw root_far root_near root_ab inv_law_ab_raw",
    "phi k": "sin_h cos_h",
    "length k": "az_tilt_sq length_sq inv_q",
    "first products": "cc ss sc cs",
    "tilt products": "w_0 i_0 j_0 k_0",
    "bend products": "wi_c i_dif w_sum kj_c j_dif k_sum",
    "inv_q products": "w_q i_q j_q k_q",
    "Qs rounding": "qs_w qs_i qs_j qs_k",
    "Qe": "inv_12_raw inv_12_far_raw inv_12_near_raw elbow_w elbow_i qe_w qe_i",
}
"""NAME -> nodes whose errors are covered by the constant NAME or by the constants NAME k and NAME w."""


@pytest.mark.parametrize("width, datapath", CORES)
def test_no_group_of_errors_moves_the_wrist_further_than_its_constant(width, datapath):
    """Skip targets on the axis and straight or closed arms, because products with 0 are exact. Skip targets whose cos_a
    is within 99 ulps of 0, because errors could change ``bend_swap``."""
    words, most = poses(width, 2), {name: float(part) for name, part in accuracy(width, datapath).items()}
    exact = fixed.run(words, width, datapath).nodes
    regular = [exact[name].value != 0 for name in ("rho_sq", "a_far", "b_near")]
    nodes = fixed.run(words[np.all([*regular, np.abs(exact["cos_a"].value) > 99], axis=0)], width, datapath).nodes
    d1, d2, s = (Real(nodes, {}).word(name).astype(float) for name in ("d1", "d2", "s"))

    def hand(values):
        q = np.stack([values[name] for name in RESULT_FIELDS], axis=1)
        return forward(q[:, :4], q[:, 4:], d1, d2)[1]

    still, most["Qe"] = hand(Real(nodes, {}).values), 2 * (most["Qe factors"] + most["Qe rests"])
    for name, members in GROUPS.items():
        constant = most[name] if name in most else math.hypot(most[f"{name} k"], most[f"{name} w"])
        limit = constant * (d2 if name == "Qe" else np.sqrt(s)) + 2 * most["Qe factors"] * d2 * (name == "bend")
        limit = 2.0 ** (2 - width) * (1 + 1e-3) * limit + 1e-14 * (d1 + d2)  # second order, double precision
        assert 0.1 < max((length(hand(v) - still) / limit).max() for v in displaced(nodes, members)) <= 1, name


@pytest.mark.parametrize("width", WIDTHS)
def test_no_group_of_errors_moves_the_hand_further_than_its_constant(width):
    words, branch = hands(width, 2)
    nodes, of = fixed.run(words, width, "arm", branch).nodes, accuracy(width, "arm")
    frame = " ".join(node.name for node in nodes.values() if node.section == "frame" and any(node.error))
    still, tool = Real(nodes, {}).values, np.abs(words[:, 6]) * 2.0 ** (2 - width)
    for name, members, results, limit in (
        ("Qw", frame, "qw_w qw_i qw_j qw_k", 0.5),
        ("tool", "h_ik h_wj h_jk h_wi h_ii h_jj", "x y z", tool),
        ("coordinates", "x y z off_x off_y off_z", "x y z", 1),
    ):
        limit = 2.0 ** (2 - width) * (float(of[name]) * limit + 1e-3)
        moved = (np.array([values[n] - still[n] for n in results.split()]).T for values in displaced(nodes, members))
        assert 0.2 < max((length(vectors) / limit).max() for vectors in moved) <= 1, name


@pytest.mark.parametrize("datapath", ["lean", "lean25", "lean16"])
def test_every_rounding_is_counted(datapath, monkeypatch):
    """Check that the constants include the error of every node that rounds, except tables, and nodes of half angles,
    which :func:`proof.turn` and test_half_angles cover."""
    counted, ulps = set(), proof.ulps
    monkeypatch.setattr(proof, "ulps", lambda node: counted.add(node.name) or ulps(node))
    proof.core.__wrapped__(dataflow(datapath, 24))
    rounded = {n.name: n.kind for n in dataflow(datapath, 24).nodes.values() if n.frac and n.error != (0, 0)}
    halves = {f"{pair}_{part}" for pair in ("az", "tilt", "bend") for part in ("sq", "c", "s")}
    tables = {name for name, kind in rounded.items() if kind in ("even", "rsqrt", "trig")}
    assert rounded.keys() - counted == halves | tables | {"bend_dif", "bend_sum"}


@pytest.mark.parametrize("width, datapath", CORES)
def test_half_angles(width, datapath):
    """Check identities of words that docs/generated/accuracy.md uses, and rotations by words against exact ones."""
    nodes = fixed.run(poses(width, 4), width, datapath).nodes
    v = {name: np.asarray(node.value) for name, node in nodes.items()}
    real = {name: word.astype(float) * nodes[name].format.ulp for name, word in v.items()}
    one, axis, unit = 1 << nodes["u_y"].frac, v["on_axis"].astype(bool), 2.0 ** (width - 2)
    rho, p, roots = np.sqrt(real["rho_sq"]), np.sqrt(real["s"]), np.sqrt(real["a_far"]) * np.sqrt(real["b_near"])
    r, reach = np.where(axis, 1, rho), 2 * real["d1"] * p
    for name, pair, cosine, sine, sign, exact in (
        ("azimuth", "az", "u_y", "u_x", -1, (-real["y"] / r, np.where(axis, 1, real["x"] / r))),
        ("tilt", "tilt", "sin_el", "cos_el", 1, (real["z"] / p, rho / p)),
        ("bend", "bend", "cos_a", "sin_a", 1, (real["k_law"] / reach, roots / reach)),
    ):
        large, small = one + np.where(v[cosine] < 0, ~v[cosine], v[cosine]) >> 1, v[sine] >> 1
        small = np.where(axis, large, small) if pair == "az" else small
        parts = (large, small) if sign > 0 else (small, large)
        assert np.array_equal(v[f"{pair}_sq"], large)
        for part, word, other in zip("cs", parts, parts[::-1], strict=True):
            assert np.array_equal(v[f"{pair}_{part}"], np.where(v[cosine] >= 0, word, other))
        c, s, square = (real[f"{pair}_{part}"] for part in ("c", "s", "sq"))
        twice_c, twice_s = c * c - s * s, 2 * c * s
        off = np.arctan2(twice_s * exact[0] - twice_c * exact[1], twice_c * exact[0] + twice_s * exact[1])
        for kind, error in (("k", (c * c + s * s) / square - 1), ("w", off)):
            assert 0.2 < np.abs(error).max() * unit / float(accuracy(width, datapath)[f"{name} {kind}"]) <= 1
    assert np.array_equal(v["bend_sum"], v["bend_c"] + v["bend_s"])
    assert np.array_equal(v["bend_dif"], (v["bend_c"] - v["bend_s"]) * np.where(v["cos_a"] < 0, -1, 1))
    assert axis.any() and (roots == 0).any() and not v["sin_a"][roots == 0].any()
    assert not any(v[name][axis].any() for name in ("u_x", "u_y", "cos_el"))
    for m, e, d in (("m_1", "e_1", "d1"), ("m_2", "e_2", "d2")):  # not cut
        assert np.array_equal(real[m] * 4.0 ** (1 - v[e]) * 2.0 ** (width % 2), real[d])


def test_rotation_by_any_parts():
    """Check :func:`proof.turned` against the exact rotation, for random errors, often at the ends of their ranges."""
    random = np.random.default_rng(5)
    for _ in range(300):
        unit = 2.0 ** -random.integers(9, 30)
        ends = np.sort(random.uniform(-9, 9, (4, 2)) * unit)
        (r, c), (o, e) = ([proof.iv.mpf(list(pair)) for pair in pairs] for pairs in (ends[:2], ends[2:]))
        k, w = (float(abs(part).b) for part in proof.turned([(r, c)], [(o, e)])[:2])
        r, c, o, e = np.clip(random.uniform(*(2 * ends - ends[:, ::-1]).T[..., None], (4, 50)), *ends.T[..., None])
        g = np.where(random.random(50) < 0.5, random.random(50), 1 - unit * random.random(50)).astype(np.longdouble)
        cosine, sine = (1 - g * g) / (1 + g * g), 2 * g / (1 + g * g)
        large, small = (1 + cosine * (1 + r) + c) / 2, sine * (1 + r) * (1 + o) / 2 + e / 2
        valid = large >= 0.5  # the word of a magnitude is not negative
        stretch, angle = large + small * small / large - 1, 2 * np.arctan2(small, large) - 2 * np.arctan(g)
        assert np.abs(stretch[valid]).max() <= k and np.abs(angle[valid]).max() <= w
