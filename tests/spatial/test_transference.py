"""The principle of transference, and the vocabulary over floats, arrays, mpmath and SymPy alike."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

import dualpin as dp
from dualpin import spatial
from dualpin.dual import Dual, cos_sin, real_part
from dualpin.scalars import ONE, ZERO, Exact
from dualpin.spatial import (
    AXES,
    IDENTITY,
    IDENTITY_POSE,
    ZERO_MOTOR,
    ZERO_VECTOR,
    Inertia,
    Matrix3,
    Pose,
    Quaternion,
    Rotation,
    Vector3,
    dh_rotation,
    displaced,
    exp,
    motor,
    power,
    to_matrix,
)

RNG = np.random.default_rng(5)


def floats(n: int) -> list[float]:
    return RNG.uniform(-1, 1, n).tolist()


KINDS = {
    "float": (float, 1e-15),
    "array": (lambda x: np.array([x, 1.25 * x]), 1e-15),
    "mpmath": (mpmath.mpf, mpmath.mpf(10) ** -48),
    # exact, but equality of expressions is undecidable: compared by evaluating the difference to 60 digits
    "sympy": (lambda x: sp.Rational(round(1000 * x), 1000), sp.Float("1e-50", 60)),
}
kinds = pytest.mark.parametrize("kind", KINDS)


@pytest.fixture(autouse=True)
def fifty_digits():
    with mpmath.workdps(50):
        yield


def scalars(kind: str, n: int) -> list[Any]:
    return [KINDS[kind][0](x) for x in floats(n)]


def distance(a: Any, b: Any) -> Any:
    """The largest difference between two things made of scalars, in all parts of dual numbers."""
    if isinstance(a, Pose):
        return max(distance(a.rotation, b.rotation), distance(a.position, b.position))
    if isinstance(a, Inertia):
        return max(distance(x, y) for x, y in zip(a.parameters, b.parameters, strict=True))
    if isinstance(a, Matrix3):
        return max(distance(x, y) for x, y in zip(a.rows, b.rows, strict=True))
    if isinstance(a, (Vector3, Quaternion)):
        return max(distance(x, y) for x, y in zip(a, b, strict=True))
    if type(a) is Dual or type(b) is Dual:
        a, b = (x if type(x) is Dual else Dual(x, ZERO) for x in (a, b))
        return max(distance(a.real, b.real), distance(a.dual, b.dual))
    d = a - b
    if isinstance(d, np.ndarray):
        return float(np.abs(d).max())
    if isinstance(d, sp.Basic):
        return abs(sp.N(d, 60, chop=True))
    return abs(d.n if type(d) is Exact else d)


def unit(kind: str) -> Vector3:
    """A unit vector; over SymPy a rational one."""
    if kind == "sympy":
        return Vector3(sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(-6, 7))
    v = Vector3(*scalars(kind, 3))
    return v * (1 / real_sqrt(v.dot(v)))


def real_sqrt(x: Any) -> Any:
    return mpmath.sqrt(x) if isinstance(x, mpmath.mpf) else np.sqrt(x)


def line(kind: str) -> Vector3:
    """A unit line n + eps p x n."""
    n, p = unit(kind), Vector3(*scalars(kind, 3))
    return motor(n, p.cross(n))


def close(kind: str, a: Any, b: Any, times: float = 20) -> bool:
    return distance(a, b) <= KINDS[kind][1] * times


def dual_angle(kind: str) -> Dual:
    """Over SymPy a third of a turn, whose sine stays a short expression."""
    t, d = scalars(kind, 2)
    return Dual(2 * sp.pi / 3 if kind == "sympy" else t, d)


# --- the ring of vectors -------------------------------------------------------------------------


@kinds
@pytest.mark.parametrize("dual", [False, True], ids=["vectors", "motors"])
def test_identities_of_vectors_hold_for_motors(kind, dual):
    def vector() -> Vector3:
        v = Vector3(*scalars(kind, 3))
        return motor(v, Vector3(*scalars(kind, 3))) if dual else v

    a, b, c = vector(), vector(), vector()
    assert close(kind, a.cross(b), -b.cross(a))
    assert close(
        kind, a.cross(b.cross(c)) + b.cross(c.cross(a)) + c.cross(a.cross(b)), ZERO_MOTOR if dual else ZERO_VECTOR
    )
    assert close(kind, a.cross(b.cross(c)), b * a.dot(c) - c * a.dot(b))
    assert close(kind, a.dot(b.cross(c)), b.dot(c.cross(a)))
    assert close(kind, a.outer(b) @ c, a * b.dot(c))


@kinds
def test_motor_cross_product_is_the_spatial_one(kind):
    w, v, f, n = (Vector3(*scalars(kind, 3)) for _ in range(4))
    V = motor(w, v)
    U = motor(f, n)
    assert close(kind, V.cross(U), motor(w.cross(f), w.cross(n) + v.cross(f)))
    assert close(kind, power(V, U), w.dot(n) + v.dot(f))
    # forces are crossed by the same formula: power(V x U, F) + power(U, V x F) = 0
    F = motor(Vector3(*scalars(kind, 3)), Vector3(*scalars(kind, 3)))
    assert close(kind, power(V.cross(U), F) + power(U, V.cross(F)), ZERO)


# --- rotations and poses -------------------------------------------------------------------------


@kinds
def test_a_rotation_by_a_dual_angle_is_a_screw_displacement(kind):
    """Rodrigues' formula, fed a unit line and a dual angle, is the pose that turns and slides."""
    axis, (t, d) = unit(kind), scalars(kind, 2)
    L = line(kind)
    R = Rotation.about(L, Dual(t, d))
    n, moment = L.real, L.dual
    foot = n.cross(moment)  # the point of the line nearest to the origin
    there = Pose(position=foot) @ Pose.about(n, Dual(t, d)) @ Pose(position=-foot)
    assert close(kind, R, there.dual_matrix)
    assert close(kind, Rotation.about(motor(axis, ZERO_VECTOR), Dual(t, d)), Pose.about(axis, Dual(t, d)).dual_matrix)


@kinds
def test_dual_orthogonal_matrices_carry_motors_as_poses_do(kind):
    X = Pose.about(unit(kind), dual_angle(kind)).moved(Pose(position=Vector3(*scalars(kind, 3))))
    m = motor(Vector3(*scalars(kind, 3)), Vector3(*scalars(kind, 3)))
    D = X.dual_matrix
    assert close(kind, D @ m, X @ m)
    assert close(kind, D.T @ m, X.pull(m)) and close(kind, X.inverse @ m, X.pull(m))
    assert close(kind, D @ D.T, motor_identity())
    assert close(kind, (X @ X).dual_matrix, D @ D)
    assert close(kind, X @ X.inverse, IDENTITY_POSE)


def motor_identity() -> Matrix3:
    return Matrix3(*(motor(a, ZERO_VECTOR) for a in AXES))


@kinds
def test_dual_quaternions_rotate_as_dual_matrices(kind):
    L, angle = line(kind), dual_angle(kind)
    q, R = Quaternion.about(L, angle), Rotation.about(L, angle)
    assert close(kind, q.rotation, R)
    m = motor(Vector3(*scalars(kind, 3)), Vector3(*scalars(kind, 3)))
    turned = q * Quaternion(Dual(ZERO, ZERO), *m) * q.conjugate
    assert close(kind, turned.v, R @ m) and close(kind, turned.w, Dual(ZERO, ZERO))
    assert close(kind, q.dot(q), Dual(ONE, ZERO))
    assert close(kind, (q * q).rotation, R @ R)
    assert close(kind, q.inverse, q.conjugate)
    back = Pose.from_quaternion(q)
    assert close(kind, back.dual_matrix, R)
    assert close(kind, displaced(back.quaternion.real, back.position).rotation, R)


@kinds
def test_quaternions_of_rotations(kind):
    n = unit(kind)
    for t in (KINDS[kind][0](0.3), KINDS[kind][0](2.9), KINDS[kind][0](-2.9)):
        q = Quaternion.about(n, t)
        if kind == "sympy":
            continue  # comparisons of unevaluated square roots are SymPy's own subject
        back = Quaternion.from_rotation(q.rotation)
        assert close(kind, back.rotation, q.rotation)
    assert list(Quaternion.from_rotation(IDENTITY)) == [1, 0, 0, 0]
    assert list(IDENTITY_POSE.quaternion.real) == [1, 0, 0, 0] and list(IDENTITY_POSE.quaternion.dual) == [0, 0, 0, 0]


@pytest.mark.parametrize("kind", ["float", "array", "mpmath"])
def test_exp_and_log_of_dual_quaternions(kind):
    for scale in (1.0, 1e-3, 1e-9, 1e-40 if kind == "mpmath" else 1e-12):
        m = motor(Vector3(*scalars(kind, 3)) * (0.6 * scale), Vector3(*scalars(kind, 3)))
        assert close(kind, Quaternion.exp(m).log, m, 40)  # half angles below pi / 2, where log is unique
    v = Vector3(*scalars(kind, 3)) * 0.6
    assert close(kind, Quaternion.exp(v).log, v, 40)
    L, (t, d) = line(kind), scalars(kind, 2)
    assert close(kind, Quaternion.exp(L * (Dual(t, d) / 2)), Quaternion.about(L, Dual(t, d)), 40)


def test_exp_near_half_turns_in_fifty_digits():
    n = unit("mpmath")
    for short in (mpmath.mpf(10) ** -k for k in (3, 9, 20, 45)):
        m = motor(n * ((mpmath.pi - short) / 2), Vector3(*scalars("mpmath", 3)))
        assert close("mpmath", Quaternion.exp(m).log, m, 100)


def test_exp_and_log_of_known_constants():
    assert [float(x) for x in Quaternion.exp(ZERO_VECTOR)] == [1, 0, 0, 0]
    q = Quaternion.exp(ZERO_MOTOR)
    assert [float(x) for x in (*q.real, *q.dual)] == [1, 0, 0, 0, 0, 0, 0, 0]
    still = IDENTITY_POSE.quaternion.log
    assert [float(x) for x in (*still.real, *still.dual)] == [0] * 6


def test_closed_form_of_the_exponential_in_sympy():
    t, d = sp.symbols("t d", positive=True)
    q = Quaternion.exp(motor(Vector3(ZERO, ZERO, t / 2), Vector3(ZERO, ZERO, d / 2)))
    expected = [sp.cos(t / 2), 0, 0, sp.sin(t / 2), -d / 2 * sp.sin(t / 2), 0, 0, d / 2 * sp.cos(t / 2)]
    found = [sp.sympify(x) for x in (*q.real, *q.dual)]
    assert all(sp.simplify(x - y) == 0 for x, y in zip(found, expected, strict=True))


def test_arrays_and_classes_agree():
    twist = np.array(floats(6))
    q = Quaternion.exp(motor(Vector3(*twist[:3].tolist()), Vector3(*twist[3:].tolist())) / 2)
    assert np.allclose([*q.real, *q.dual], exp(twist), atol=1e-15)
    assert np.allclose(np.array(Pose.from_quaternion(q).rows, dtype=float), to_matrix(exp(twist)), atol=1e-15)


# --- Denavit and Hartenberg ----------------------------------------------------------------------


@kinds
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_dh_rotations_are_textbook_matrices(kind, convention):
    theta, d, alpha, a = scalars(kind, 4)
    (ct, st), (ca, sa) = cos_sin(theta), cos_sin(alpha)
    expected = {
        "standard": [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]],
        "modified": [[ct, -st, 0, a], [st * ca, ct * ca, -sa, -d * sa], [st * sa, ct * sa, ca, d * ca], [0, 0, 0, 1]],
    }[convention]
    X = Pose.dh(Dual(theta, d), Dual(alpha, a), convention)
    for row, wanted in zip(X.rows, expected, strict=True):
        for x, y in zip(row, wanted, strict=True):
            assert distance(x, y) <= KINDS[kind][1] * 20
    # and by transference: Rz Rx of dual angles about the coordinate lines
    assert close(kind, dh_rotation(Dual(theta, d), Dual(alpha, a), convention), X.dual_matrix)
    assert close(kind, dh_rotation(theta, alpha, convention), X.rotation)


@pytest.mark.parametrize("step", [dh_rotation, Pose.dh])
def test_other_conventions_are_refused(step):
    with pytest.raises(dp.ArgumentError, match="'standart' is not known; did you mean 'standard'"):
        step(Dual(0.1, 0.2), Dual(0.3, 0.4), "standart")


# --- inertia -------------------------------------------------------------------------------------


@kinds
def test_inertias_move_as_what_they_multiply(kind):
    s = scalars(kind, 10)
    J = Matrix3(Vector3(s[4], s[5], s[7]), Vector3(s[5], s[6], s[8]), Vector3(s[7], s[8], s[9]))
    body = Inertia(s[0], Vector3(*s[1:4]), J)
    X = Pose.about(unit(kind), dual_angle(kind)).moved(Pose(position=Vector3(*scalars(kind, 3))))
    V, U = (motor(Vector3(*scalars(kind, 3)), Vector3(*scalars(kind, 3))) for _ in range(2))
    assert close(kind, (X @ body)(X @ V), X @ body(V), 60)
    assert close(kind, power(U, body(V)), power(V, body(U)))
    assert close(kind, (X @ (X.inverse @ body))(V), body(V), 60)
    basis = Inertia.basis()
    total = ZERO_MOTOR
    for p, E in zip(body.parameters, basis, strict=True):
        total = total + E(V) * p
    assert close(kind, total, body(V))


def test_inertia_is_not_dual_linear():
    """I(eps V) differs from eps I(V): why poses must be applied to inertias as congruences."""
    body = Inertia(2.0, Vector3(0.1, 0.2, 0.3), Matrix3(*(a * 1.0 for a in AXES)))
    V = motor(Vector3(1.0, 2.0, 3.0), Vector3(4.0, 5.0, 6.0))
    assert distance(body(V * Dual(ZERO, ONE)), body(V) * Dual(ZERO, ONE)) > 0.1


def test_real_parts_of_dual_numbers():
    assert real_part(Dual(2.0, 3.0)) == 2.0 and real_part(2.0) == 2.0 and real_part(ONE) is ONE


@pytest.mark.parametrize("s", [ZERO, ONE, -ONE, 2, 2.5, np.float64(2), Dual(2.0, 3.0)], ids=repr)
def test_a_scalar_may_stand_on_either_side(s):
    for thing in (Vector3(1.0, 2.0, 3.0), Quaternion(1.0, 2.0, 3.0, 4.0)):
        left, right = s * thing, thing * s
        assert type(left) is type(right) is type(thing)
        assert distance(left, right) == 0


@pytest.mark.parametrize(
    ("old", "new"), [("NOUGHT", "ZERO_VECTOR"), ("REST", "ZERO_MOTOR"), ("GROUND", "IDENTITY_POSE")]
)
def test_former_names_of_constants_work_and_say_the_new_ones(old, new):
    with pytest.warns(DeprecationWarning, match=f"is now .*{new}"):
        assert getattr(spatial, old) is getattr(spatial, new)
    with pytest.raises(AttributeError, match="no_such"):
        spatial.no_such
