# SPDX-License-Identifier: Apache-2.0
"""Affine arithmetic encloses the bit-true model at every node and at the hand, and is tight."""

import numpy as np
import pytest

from model.bounds import affine, predict, ranges
from model.bounds.affine import Form
from model.dataflow import fixed
from model.dataflow.reals import Real
from model.io import monte_carlo

WIDTHS = (18, 24, 32)


@pytest.mark.parametrize("width", WIDTHS)
def test_every_node_is_enclosed(width):
    bits = fixed.run(monte_carlo.words_of(monte_carlo.regular_poses(1000, 3), width), width).bits
    forms, exact = affine.Affine(bits), Real(bits, {}).nodes
    checked = 0
    for name, node in bits.nodes.items():
        if node.section in ("guard", "results") or node.format.width == 1:
            continue
        bound = forms.error_ulps(name)
        seen = np.abs(node.value - exact[name].value / node.format.ulp)
        # double precision has only a few more digits than wide words
        assert (seen <= bound * (1 + 1e-6) + 1e-3).all(), name
        if node.error != (0.0, 0.0):
            checked += 1
            # ... and is tight: a bound that is never approached proves nothing
            assert seen.max() > np.median(bound) / 50, name
    assert checked > 100


@pytest.mark.parametrize("width", WIDTHS)
def test_the_hand_is_enclosed(width):
    poses = monte_carlo.regular_poses(2500, 4)
    bound = affine.hand_bound(monte_carlo.words_of(poses, width), width)
    error = monte_carlo.hand_errors(width, poses)
    assert bound.shape == error.shape
    assert (error <= bound).all()
    assert np.median(bound / error) < 30


def test_the_prediction_of_first_order_stays_below_the_proof():
    words = monte_carlo.words_of(monte_carlo.regular_poses(200, 5), 32)
    ratio = predict.hand_bar(words, 32) / affine.hand_bound(words, 32)
    assert 0.8 < ratio.min() and ratio.max() < 1.3


def _form(random, centre, radius):
    return Form(
        np.array([centre]), {"a": np.array([radius * 0.7]), "b": np.array([-radius * 0.2])}, np.array([radius * 0.1])
    )


def _points(form, e, rest):
    return form.centre + e[0] * form.terms["a"] + e[1] * form.terms["b"] + rest * form.rest


@pytest.mark.parametrize(
    ("made", "true"),
    [
        (lambda f, g: f * g, lambda x, y: x * y),
        (lambda f, g: f - g, lambda x, y: x - y),
        (lambda f, g: f.inverse(), lambda x, y: 1 / x),
        (lambda f, g: f.root(), lambda x, y: np.sqrt(x)),
        (lambda f, g: f * f - g, lambda x, y: x * x - y),
    ],
    ids=["product", "difference", "inverse", "root", "square"],
)
def test_operations_enclose_every_point(made, true):
    random = np.random.default_rng(6)
    for _ in range(200):
        centre, other = random.uniform(0.3, 2.0, 2)
        f, g = _form(random, centre, centre * random.uniform(0, 0.9)), _form(random, other, random.uniform(0, 1))
        answer = made(f, g)
        e = random.choice([-1.0, 1.0, 0.3], (2, 64))
        rests = random.choice([-1.0, 1.0], (2, 64))
        value = true(_points(f, e, rests[0]), _points(g, e, rests[1]))
        kept = answer.centre + sum(c * e[k] for k, s in enumerate("ab") for c in [answer.terms[s]])
        assert (np.abs(value - kept) <= answer.rest * (1 + 1e-12) + 1e-15).all()


def test_shared_roundings_cancel():
    f = Form(np.array([1.0]), {"a": np.array([0.1])}, np.zeros(1))
    assert (f - f).radius == pytest.approx(0.0, abs=1e-15)
    assert (f.inverse() * f).radius < 0.025 < 0.2  # intervals would give 0.2


def test_no_bound_where_a_divisor_or_a_root_may_be_zero():
    f = Form(np.array([0.1]), {"a": np.array([0.2])}, np.zeros(1))
    assert np.isinf(f.inverse().rest).all()
    assert f.root().radius + f.root().centre >= np.sqrt(0.3)


class _Both(ranges.Ranges):
    """Ranges with an affine form per interval of products and sums; ``narrowed`` lists the nodes that forms narrow."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.forms, self.narrowed = {}, []

    def _form(self, node):
        if node.name not in self.forms:
            low, high = node.value.low, node.value.high
            symbol = {node.name: np.float64(high - low) / 2} if high > low else {}
            self.forms[node.name] = Form(np.float64(low + high) / 2, symbol, np.float64(0))
        return self.forms[node.name]

    def _compare(self, name, form, bound):
        if 2 * form.radius < (bound.high - bound.low) * (1 - 1e-9):
            self.narrowed.append(name)
        if 2 * form.radius <= (bound.high - bound.low) * (1 + 1e-9):
            # the nonlinear part gets its own symbol here, so that it cancels as well
            self.forms[name] = Form(form.centre, {**form.terms, name: form.rest}, np.float64(0))
        return bound

    def product(self, name, a, b, fmt, scale):
        f, g = self._form(a), self._form(b)
        half = f.radius**2 / 2
        form = f.linear(2 * f.centre, f.centre**2 + half, half) if a is b else f * g
        return self._compare(name, form.linear(2.0**scale), super().product(name, a, b, fmt, scale))

    def total(self, name, signs, nodes, fmt):
        first, *others = (self._form(n) if s > 0 else -self._form(n) for s, n in zip(signs, nodes, strict=True))
        return self._compare(name, sum(others, first), super().total(name, signs, nodes, fmt))


def test_affine_forms_narrow_no_range():
    """Check the statement of docs/generated/wordlengths.md: over whole ranges intervals and rules are as good."""
    for case in ranges.cases(32):
        assert _Both(32, case).run().narrowed == []


def test_affine_forms_would_narrow_a_range_of_terms_in_common():
    domain = _Both(32, ranges.cases(32)[0]).run()
    a = domain.nodes["p_w_x"]
    domain.mul("twice", a, domain.nodes["sin_h"], domain.word(2))
    domain.sum("nothing", domain.nodes["twice"], -domain.nodes["twice"], fmt=domain.word(2))
    assert domain.narrowed == ["nothing"]


@pytest.mark.parametrize("z", [0.0, 0.001, -0.001, 0.5])
def test_a_choice_that_its_operand_may_turn_is_enclosed(z):
    words = monte_carlo.words_of(monte_carlo.regular_poses(1, 7), 24)
    domain = affine.Affine(fixed.run(words, 24).bits)
    domain.nodes["z_wide"] = domain.constant(0.0, domain.word(1))
    domain.nodes["z_wide"].value = Form(np.array([z]), {"a": np.array([0.01])}, np.zeros(1))
    form = domain.op("height", ("z_wide",), domain.word(1), "mux", abs, abs).value
    assert all(abs(abs(z + e) - form.centre) <= form.radius + 1e-12 for e in np.linspace(-0.01, 0.01, 21))
