# SPDX-License-Identifier: Apache-2.0
"""Layer 1: blades, metric, entities, quaternions and angles of section 2 of the paper."""

import numpy as np
import pytest
import sympy

from model.reference import cga
from model.reference.cga import e1, e2, e3, e_0, e_inf, i, j, k

RNG = np.random.default_rng(20080101)


def values(mv):
    """Return the 32 coefficients as an array (32, N)."""
    return np.stack(np.broadcast_arrays(*cga.coefficients(mv).values())).astype(float).reshape(32, -1)


def assert_equal(a, b, what):
    np.testing.assert_allclose(values(a), values(b), rtol=0, atol=1e-12, err_msg=what)


def assert_zero(mv, what):
    assert np.abs(values(mv)).max() < 1e-10, f"{what}: {mv}"


def assert_same_entity(a, b, what):
    """Assert equality up to a nonzero scale."""
    a, b = values(a), values(b)
    lengths = np.linalg.norm(a, axis=0) * np.linalg.norm(b, axis=0)
    assert lengths.min() > 1e-6, f"{what}: an entity vanishes"
    cosine = np.abs((a * b).sum(axis=0)) / lengths
    np.testing.assert_allclose(cosine, 1, rtol=0, atol=1e-12, err_msg=what)


def grade(mv):
    """Return the only grade with a nonzero coefficient."""
    present = [g for g in range(6) for b, v in cga.coefficients(mv).items() if len(factors(b)) == g and np.any(v)]
    assert len(set(present)) == 1, f"grades {set(present)}"
    return present[0]


def factors(blade):
    return [] if blade == "1" else blade.split("^")


# -- table 2


@pytest.mark.parametrize("blade", cga.BLADES)
def test_each_blade_reads_as_itself(blade):
    vectors = {"e1": e1, "e2": e2, "e3": e3, "einf": e_inf, "e0": e_0}
    mv = cga.scalar(1)
    for name in factors(blade):
        mv = mv ^ vectors[name]
    expected = {name: float(name == blade) for name in cga.BLADES}
    assert cga.coefficients(mv) == expected, f"the outer product {blade} must have coefficient 1 there, 0 elsewhere"


def test_a_blade_that_table_2_has_not_is_refused():
    with pytest.raises(KeyError, match="e2\\^e1"):
        cga.coefficient(e1, "e2^e1")


def test_metric():
    basis = {"e1": e1, "e2": e2, "e3": e3, "einf": e_inf, "e0": e_0}
    expected = {(a, a): 1 for a in ("e1", "e2", "e3")} | {("einf", "e0"): -1, ("e0", "einf"): -1}
    for a in basis:
        for b in basis:
            assert cga.inner(basis[a], basis[b]) == expected.get((a, b), 0), f"{a} . {b}"


def test_coefficients_may_be_numbers_arrays_and_symbols():
    x, y, z = sympy.symbols("x y z")
    read = cga.coefficients(cga.point(x, y, z))
    assert read["einf"] == (x**2 + y**2 + z**2) / 2 and read["e0"] == 1, "exact for symbols"
    assert not cga.point(x, y, z).e4.atoms(sympy.Float), "no rounded numbers inside either"
    numbers = cga.coefficients(cga.point(1.0, 2.0, -2.0))
    assert (numbers["e3"], numbers["einf"], numbers["e0"]) == (-2.0, 4.5, 1.0), "exact for small numbers"
    arrays = cga.coefficients(cga.point(*RNG.normal(size=(3, 7))))
    assert arrays["einf"].shape == (7,), "an array stays an array"


# -- table 1


def points_on_sphere(centre, radius, count):
    out = []
    for _ in range(count):
        direction = RNG.normal(size=centre.shape)
        out.append(cga.point(*(centre + radius * direction / np.linalg.norm(direction, axis=0))))
    return out


def circle_frame(size=20):
    """Return a circle's centre (3, N), two orthogonal unit vectors in its plane, and that plane's unit normal."""
    frame = np.linalg.qr(RNG.normal(size=(size, 3, 3)))[0]
    return RNG.normal(size=(3, size)), frame[:, :, 0].T, frame[:, :, 1].T, frame[:, :, 2].T


def plane_through(centre, normal):
    return cga.plane(*normal, (centre * normal).sum(axis=0))


def assert_entity(standard, direct, grades, points, what):
    """Assert that both representations have table 1's grades, are dual, and contain exactly these points."""
    assert (grade(standard), grade(direct)) == grades, "grades of table 1"
    assert_same_entity(standard, cga.dual(direct), what)
    for p in points:
        assert_zero(p | standard, f"{what}: inner product of a point on it with the standard representation")
        assert_zero(p ^ direct, f"{what}: outer product of a point on it with the direct representation")
    elsewhere = cga.point(5.0, 6.0, 7.0)
    assert np.abs(values(elsewhere | standard)).max(axis=0).min() > 1e-3, f"{what}: a point elsewhere is not on it"
    assert np.abs(values(elsewhere ^ direct)).max(axis=0).min() > 1e-9, f"{what}: a point elsewhere is not on it"


def test_point():
    p, q = RNG.normal(size=(2, 3, 20))
    P, Q = cga.point(*p), cga.point(*q)
    np.testing.assert_allclose(cga.inner(P, P), 0, atol=1e-12, err_msg="points are null vectors")
    distance = ((p - q) ** 2).sum(axis=0)
    np.testing.assert_allclose(cga.inner(P, Q), -distance / 2, atol=1e-12, err_msg="P . Q is -distance^2 / 2")
    scaled = P * cga.scalar(-3.0)
    np.testing.assert_allclose(cga.euclidean_coordinates(scaled), p, atol=1e-12, err_msg="a point is homogeneous")


def test_sphere():
    centre, radius = RNG.normal(size=(3, 20)), RNG.uniform(0.5, 2, 20)
    points = points_on_sphere(centre, radius, 5)
    standard = cga.sphere(cga.point(*centre), radius)
    direct = cga.sphere_direct(*points[:4])
    assert_entity(standard, direct, (1, 4), points[4:], "sphere")


def test_plane():
    centre, u, v, normal = circle_frame()
    points = [cga.point(*(centre + a * u + b * v)) for a, b in ((0, 0), (1, 0.3), (-0.5, 1), (2, 2))]
    standard, direct = plane_through(centre, normal), cga.plane_direct(*points[:3])
    assert_entity(standard, direct, (1, 4), points[3:], "plane")


def test_circle():
    centre, u, v, normal = circle_frame()
    radius = RNG.uniform(0.5, 2, 20)
    points = [cga.point(*(centre + radius * (np.cos(t) * u + np.sin(t) * v))) for t in (0, 1, 3, 5)]
    spheres = [cga.sphere(cga.point(*(centre + h * normal)), np.hypot(radius, h)) for h in (0.7, -0.4)]
    standard, direct = cga.circle(*spheres), cga.circle_direct(*points[:3])
    assert_entity(standard, direct, (2, 3), points[3:], "circle")


def test_line():
    centre, u, v, normal = circle_frame()
    points = [cga.point(*(centre + t * u)) for t in (-1, 0.5, 3)]
    standard = cga.line(plane_through(centre, v), plane_through(centre, normal))
    direct = cga.line_direct(*points[:2])
    assert_entity(standard, direct, (2, 3), points[2:], "line")


def test_point_pair():
    centre, u, v, normal = circle_frame()
    radius = RNG.uniform(0.5, 2, 20)
    points = [cga.point(*(centre + s * radius * u)) for s in (1, -1)]
    ball = cga.sphere(cga.point(*centre), radius)
    others = [cga.sphere(cga.point(*(centre + h)), np.sqrt(radius**2 + (h**2).sum(axis=0))) for h in (v, normal)]
    standard, direct = cga.point_pair(ball, *others), cga.point_pair_direct(*points)
    assert_entity(standard, direct, (3, 2), points, "point pair")


def test_centre_radius_and_direction():
    """Entities built from a given centre, radius and direction, and a circle and a pair as intersections."""
    centre, radius = RNG.normal(size=(3, 20)), RNG.uniform(0.5, 2, 20)
    sphere = cga.sphere(cga.point(*centre), radius)
    np.testing.assert_allclose(cga.radius(sphere), radius, atol=1e-12)
    np.testing.assert_allclose(cga.euclidean_coordinates(cga.centre(sphere)), centre, atol=1e-12)
    normal = RNG.normal(size=(3, 20))
    normal /= np.linalg.norm(normal, axis=0)
    plane = cga.plane(*normal, (normal * centre).sum(axis=0) + radius / 2)
    np.testing.assert_allclose(cga.direction(plane), normal, atol=1e-12)
    circle = cga.circle(sphere, plane)
    np.testing.assert_allclose(cga.euclidean_coordinates(cga.centre(circle)), centre + normal * radius / 2, atol=1e-10)
    np.testing.assert_allclose(cga.radius(circle), radius * np.sqrt(3) / 2, atol=1e-10)
    ends = RNG.normal(size=(2, 3, 20))
    pair = cga.dual(cga.point_pair_direct(*(cga.point(*end) for end in ends)))
    np.testing.assert_allclose(cga.euclidean_coordinates(cga.centre(pair)), ends.mean(axis=0), atol=1e-10)
    line = cga.dual(cga.line_direct(*(cga.point(*end) for end in ends)))
    way = ends[1] - ends[0]
    np.testing.assert_allclose(cga.direction(line), way / np.linalg.norm(way, axis=0), atol=1e-10)
    apart = cga.circle(sphere, cga.plane(*normal, (normal * centre).sum(axis=0) + 2 * radius))
    assert np.isnan(cga.radius(apart)).all()


# -- quaternions


def test_quaternion_units_are_hamiltons():
    minus_one = cga.scalar(-1)
    for name, product in {"i^2": i * i, "j^2": j * j, "k^2": k * k, "ijk": i * j * k}.items():
        assert_equal(product, minus_one, f"{name} = -1, (1)-(3)")


def test_rotation_about_any_line_through_the_origin():
    axis, v = RNG.normal(size=(2, 3, 50))
    axis /= np.linalg.norm(axis, axis=0)
    phi = RNG.uniform(-7, 7, 50)
    L = cga.dual(cga.line_direct(e_0, cga.point(*axis)))
    turned = cga.rotate(cga.rotation(L, phi), cga.vector(*v))
    rodrigues = (
        v * np.cos(phi) + np.cross(axis.T, v.T).T * np.sin(phi) + axis * (axis * v).sum(axis=0) * (1 - np.cos(phi))
    )
    np.testing.assert_allclose(values(turned)[1:4], rodrigues, atol=1e-12, err_msg="(4) against Rodrigues' formula")


# -- angles


def test_angle_between_lines():
    shared, a, b = RNG.normal(size=(3, 3, 50))
    cosine = (a * b).sum(axis=0) / np.linalg.norm(a, axis=0) / np.linalg.norm(b, axis=0)
    direct = [cga.line_direct(cga.point(*shared), cga.point(*(shared + d))) for d in (a, b)]
    np.testing.assert_allclose(cga.cos_angle(*direct), cosine, atol=1e-10, err_msg="(5), direct lines")
    standard = [cga.dual(o) for o in direct]
    np.testing.assert_allclose(cga.cos_angle(*standard), -cosine, atol=1e-10, err_msg="(5), standard lines")


def test_angle_between_planes():
    a, b = RNG.normal(size=(2, 3, 50))
    d = RNG.normal(size=(2, 50))
    cosine = (a * b).sum(axis=0) / np.linalg.norm(a, axis=0) / np.linalg.norm(b, axis=0)
    standard = [cga.plane(*a, d[0]), cga.plane(*b, d[1])]
    np.testing.assert_allclose(cga.cos_angle(*standard), cosine, atol=1e-10, err_msg="(5), standard planes")
    direct = [cga.dual(o) for o in standard]
    np.testing.assert_allclose(cga.cos_angle(*direct), -cosine, atol=1e-10, err_msg="(5), direct planes")


def test_half_angles():
    phi = np.linspace(0, np.pi, 101)
    cos_half, sin_half = cga.half_angle(np.cos(phi))
    np.testing.assert_allclose(cos_half, np.cos(phi / 2), atol=1e-8, err_msg="(6)")
    np.testing.assert_allclose(sin_half, np.sin(phi / 2), atol=1e-8, err_msg="(7)")
    beyond = 1 + 1e-15
    assert cga.half_angle(beyond) == (1.0, 0.0), "a cosine above 1 by roundoff is 1"
    assert cga.half_angle(-beyond) == (0.0, 1.0), "a cosine below -1 by roundoff is -1"


# -- symbols
