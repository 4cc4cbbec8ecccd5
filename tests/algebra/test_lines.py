"""Lines, motors, screws: the golden values, and what holds of any two lines."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from tests.golden import REFERENCE, array, close, dual

al = dp.algebra


def case_lines(case):
    return (al.line(array(case[k]["point"]), array(case[k]["direction"])) for k in ("line1", "line2"))


@pytest.mark.parametrize("case", REFERENCE["line_pairs"], ids=lambda c: c["name"])
def test_golden_pairs_of_lines(case):
    l1, l2 = case_lines(case)
    close(l1, dual(case["E1"]))
    close(l2, dual(case["E2"]))
    close(al.dual_angle(l1, l2), dual(case["dual_angle"]))
    E3, P1, P2 = al.common_perpendicular(l1, l2)
    close(E3, dual(case["E3"]))
    close(P1, array(case["P1"]))
    close(P2, array(case["P2"]))
    given = [
        al.Motor(array(case[k]["direction"]), np.cross(array(case[k]["point"]), array(case[k]["direction"])))
        for k in ("line1", "line2")
    ]
    close(given[0].dot(given[1]), dual(case["dot_of_given_lines"]))
    close(given[0].cross(given[1]), dual(case["cross_of_given_lines"]))


def test_golden_sum():
    for case in REFERENCE["motor_sum"]:
        a, b = dual(case["A1"]), dual(case["A2"])
        s = al.screw_sum(a, b)
        close(s.theta, dual(case["theta"]))
        close(s.perpendicular, dual(case["E12"]))
        close(s.alpha1, dual(case["alpha1"]))
        close(s.magnitude, dual(case["magnitude"]))
        close(s.axis, dual(case["E"]))
        close(s.sum, dual(case["sum"]))
        close(al.motor_sum(a, b), dual(case["sum"]))
        assert float(s.sum.pitch) == pytest.approx(float(case["pitch"]), rel=1e-12)


@pytest.mark.parametrize("case", REFERENCE["screw"], ids=lambda c: c["name"])
def test_golden_screws(case):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = array(case["R"]), array(case["t"])
    close(dp.spatial.from_matrix(T), np.concatenate([array(case["dual_quaternion"][p]) for p in ("real", "dual")]))
    e = al.euler_parameters(T)
    close(e, dual(case["dual_quaternion"]))
    s = dp.spatial.screw_parameters(T)
    close(dp.Dual(s.angle, s.distance), dual(case["dual_angle"]))
    close(s.axis, array(case["axis"]))
    if case["moment"] != "undetermined":
        close(s.moment, array(case["moment"]))
        close(s.point, array(case["foot_point"]))
        close(s.pitch, float(case["pitch_per_radian"]))
        close(2 * np.pi * s.pitch, float(case["pitch_per_turn"]))
        close(al.dual_matrix(T), dual(case["dual_matrix"]))
        close(al.screw_matrix(al.Motor(s.axis, s.moment), dp.Dual(s.angle, s.distance)), dual(case["dual_matrix"]))


def test_golden_composition_of_finite_screws():
    for case in REFERENCE["compose"]:
        E = [dual(case[k]["axis"]) for k in ("first", "second")]
        t = [dual(case[k]["dual_angle"]) for k in ("first", "second")]
        T1, T2 = (al.rodrigues(*pair) for pair in zip(E, t, strict=True))
        close(T1, dual(case["T1"]))
        close(T2, dual(case["T2"]))
        T3 = al.compose_screws(T1, T2)
        close(T3, dual(case["T3"]))
        angle, axis = al.screw_of(T3)
        close(angle, dual(case["result"]["dual_angle"]))
        close(axis, dual(case["result"]["axis"]))
        A = al.screw_matrix(E[1], t[1]) @ al.screw_matrix(E[0], t[0])
        T = al.homogeneous(A)
        close(T[:3, :3], array(case["R"]))
        close(T[:3, 3], array(case["t"]))
        # the second axis carried by the body: the same motion with a plus sign
        moved = al.screw_matrix(E[0], t[0]).T @ E[1]
        body = al.compose_screws(T1, al.rodrigues(moved, t[1]), body=True)
        fixed = al.compose_screws(T1, al.rodrigues(E[1], t[1]))
        angle_b, angle_f = al.screw_of(body)[0], al.screw_of(fixed)[0]
        close(angle_b, angle_f)


def random_lines(n, seed=0):
    rng = np.random.default_rng(seed)
    return (al.line(rng.standard_normal((n, 3)), rng.standard_normal((n, 3))) for _ in range(2))


def test_products_of_lines_are_cosine_and_sine_of_their_dual_angle():
    l1, l2 = random_lines(200)
    theta = al.dual_angle(l1, l2)
    E3, P1, P2 = al.common_perpendicular(l1, l2)
    close(np.cos(theta), l1.dot(l2), 1e-11)
    close(E3 * np.sin(theta), l1.cross(l2), 1e-11)
    # the feet: on the lines, their difference along the perpendicular, and as the 2 x 2 system says
    for line, P in ((l1, P1), (l2, P2)):
        assert np.abs(np.cross(P, line.real) - line.dual).max() < 1e-10
    close(P2 - P1, theta.dual[:, None] * E3.real, 1e-10)
    u1, u2, gap = l1.real, l2.real, l2.point - l1.point
    c = (u1 * u2).sum(-1)
    A = np.stack([np.stack([np.ones_like(c), -c], -1), np.stack([c, -np.ones_like(c)], -1)], -2)
    rhs = np.stack([(gap * u1).sum(-1), (gap * u2).sum(-1)], -1)
    t = np.linalg.solve(A, rhs[..., None])[..., 0]
    close(l1.at(t[:, 0]), P1, 1e-9)
    close(l2.at(t[:, 1]), P2, 1e-9)


@pytest.mark.parametrize("slant", [1e-3, 1e-6, 1e-9, np.pi - 1e-6])
def test_near_parallel_lines(slant):
    # z-axis, and a line at distance 2 along x, tilted in the yz-plane
    l1, l2 = al.line([0, 0, 1.0], [0, 0, 1]), al.line([2.0, 0, 0], [0, np.sin(slant), np.cos(slant)])
    theta = al.dual_angle(l1, l2)
    # E1 x E2 points along -x
    assert float(theta.real) == pytest.approx(slant, rel=1e-6)
    assert float(theta.dual) == pytest.approx(-2.0)
    _, P1, P2 = al.common_perpendicular(l1, l2)
    assert np.abs(P1).max() < 1e-9
    assert np.abs(P2 - [2, 0, 0]).max() < 1e-9


def test_parallel_lines_have_a_dual_angle_but_no_single_perpendicular():
    l1, l2 = al.line([1.0, 2, 3], [1, 1, 0]), al.line([1.0, 2, 5], [3, 3, 0])
    close(al.dual_angle(l1, l2), dp.Dual(0.0, 2.0))
    close(al.dual_angle(l1, -l2), dp.Dual(np.pi, 2.0))
    close(al.dual_angle(l1, l1), dp.Dual(0.0, 0.0))
    with pytest.raises(al.AssumptionError, match="parallel"):
        al.common_perpendicular(l1, l2)


def test_classes_of_motors_do_not_depend_on_the_origin():
    m = al.Motor([[0, 0, 1.0], [0, 0, 1], [0, 0, 0], [0, 0, 0]], [[0, 0, 2.0], [1, 0, 0], [1, 2, 3], [0, 0, 0]])
    assert m.kind.tolist() == ["screw", "line", "couple", "zero"]
    moved = m.shifted([0.3, -2.0, 7.0])
    assert moved.kind.tolist() == m.kind.tolist()
    assert np.allclose(moved.pitch, m.pitch, equal_nan=True)
    assert al.pitch(m)[2] == np.inf
    assert np.isnan(al.pitch(m)[3])
    assert al.classify(m[0]).item() == "screw"
    with pytest.raises(dp.DualDivisionError):
        _ = m.axis


def test_sum_by_dual_angles_is_the_plain_sum():
    rng = np.random.default_rng(1)
    for _ in range(50):
        a, b = al.Motor(*rng.standard_normal((2, 3))), al.Motor(*rng.standard_normal((2, 3)))
        s = al.screw_sum(a, b)
        close(s.sum, a + b, 1e-9)  # 1 / sin of a random angle
        close(s.magnitude, (a + b).magnitude, 1e-9)


def test_all_screws_of_a_cylindroid_lie_on_it():
    rng = np.random.default_rng(2)
    a, b = al.Motor(*rng.standard_normal((2, 3))), al.Motor(*rng.standard_normal((2, 3)))
    c = al.cylindroid(a, b)
    s1, s2 = c.principal
    close(s1.dot(s2), dp.Dual(0.0, 0.0), 1e-12)  # orthogonal and reciprocal: they meet at right angles
    phi = np.linspace(0, np.pi, 50)
    screws = c.screw(phi)
    close(screws.pitch, c.pitch(phi), 1e-11)
    for x, y in ((0.3, 1.1), (-2.0, 0.7)):
        s = a * x + b * y
        lam = np.linalg.solve([[s1.dot(s1).real, 0], [0, s2.dot(s2).real]], [s1.dot(s).real, s2.dot(s).real])
        angle = np.arctan2(lam[1], lam[0])
        assert float(s.pitch) == pytest.approx(float(c.pitch(angle)), abs=1e-11)
        # its axis meets the nodal line at right angles, at the height Ball gives
        _, foot, other = al.common_perpendicular(c.nodal, s)
        assert np.abs(foot - other).max() < 1e-10
        assert float((foot - c.center) @ c.nodal.real) == pytest.approx(float(c.height(angle)), abs=1e-10)
    with pytest.raises(al.AssumptionError, match="parallel"):
        al.cylindroid(a, a)


def test_four_cases_of_the_euler_parameters():
    for angle in (0.0, 1e-9, 0.5, 3.0, np.pi - 1e-9, np.pi):
        for axis in np.eye(3):
            A = al.screw_matrix(al.line([0.3, -0.2, 0.5], axis), dp.Dual(angle, 0.7))
            e = al.euler_parameters(A)
            q = np.concatenate((e.real, e.dual))
            close(al.dual_matrix(dp.spatial.to_matrix(q)), A, 1e-15 * 100)
    with pytest.raises(dp.ArgumentError, match="orthogonal"):
        al.euler_parameters(dp.Dual(np.eye(3), np.eye(3)))


def test_half_turns_have_no_rodrigues_vector():
    z = al.line([0, 0, 0], [0, 0, 1])
    T = al.rodrigues(z, dp.Dual(np.pi / 2, 0.1))
    with pytest.raises(dp.DualDivisionError, match="half turn"):
        al.compose_screws(T, T)


def test_twist_between_poses_is_the_screw_of_the_motion():
    twist = np.array([0.1, -0.2, 0.3, 1.0, 2.0, -1.0])
    T0 = dp.spatial.to_matrix(dp.spatial.exp([0.4, 0.1, 0.2, 1, 0, 3]))
    T1 = dp.spatial.to_matrix(dp.spatial.exp(twist * 0.5)) @ T0
    close(al.twist_between(T0, T1, 0.5).six, twist, 1e-13)


def test_arguments_of_wrong_shape():
    with pytest.raises(dp.ShapeError):
        al.line([0, 0], [1, 0])
    with pytest.raises(dp.DualDivisionError, match="direction"):
        al.line([0, 0, 0], [0, 0, 0])
    with pytest.raises(dp.ShapeError):
        al.pitch([1, 2, 3, 4])


def test_a_motor_is_made_of_a_dual_vector_too():
    m = dp.algebra.Motor(dp.Dual([0.0, 1.0, 1.0], [0.0, 0.0, 1.0]))
    assert m.real.tolist() == [0, 1, 1]
    assert m.dual.tolist() == [0, 0, 1]
    assert float(m.pitch) == 0.5
