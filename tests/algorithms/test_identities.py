"""Every algorithm against its definition, on random trees of every joint kind.

No other library is asked.  Derivatives are by complex steps (see complex_step.py), so that what is
compared carries rounding only.  TIGHT: a few thousand rounded operations on numbers near 1, with
cancellation in differences of torques.  SOLVED: the same times cond(M), which is up to 1e5 here.
"""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.fuzz.complex_step import along, gradient
from dualpin.model import Builder, Robot, revolute
from dualpin.spatial import Inertia, Matrix3, Vector3
from tests.random_robots import FIXED_BASE, SPECS, robot

TIGHT = 1e-12
REFERENCES = ("world", "local", "local_world_aligned")
SEEDS = (7, 8)


def scaled(x: np.ndarray, y: np.ndarray) -> float:
    """max|x - y| / max(1, max|y|)"""
    return float(np.abs(np.asarray(x) - y).max(initial=0.0) / max(1.0, np.abs(y).max(initial=0.0)))


@pytest.fixture(params=[(name, s) for name in SPECS for s in SEEDS], ids=lambda p: f"{p[0]}-{p[1]}")
def case(request: pytest.FixtureRequest, seed: int) -> tuple[Robot, np.ndarray, np.ndarray, np.ndarray]:
    r = robot(*request.param)
    return r, *r.sample(seed=seed)


def call(function: str, *args: object, **options: object) -> np.ndarray:
    return getattr(dp, function)(*args, engine="numpy", **options)


def hat(twist: np.ndarray) -> np.ndarray:
    """The 4x4 matrix of a twist [w; v]."""
    (x, y, z), v = twist[:3], twist[3:]
    return np.array([[0, -z, y, v[0]], [z, 0, -x, v[1]], [-y, x, 0, v[2]], [0, 0, 0, 0]])


def rotor_inertia(r: Robot) -> np.ndarray:
    """What the joints' rotors add to M: constant, and no part of any link."""
    M = np.zeros((r.nv, r.nv))
    for j in r:
        multiplier = float(j.coupling[0])
        M[j.v, j.v] += np.diag([float(x) * multiplier**2 for x in j.armature])
    return M


# --- kinematics ----------------------------------------------------------------------------------


@pytest.mark.parametrize("reference", REFERENCES)
def test_jacobian_columns_are_derivatives_of_forward_kinematics(case, reference):
    r, q, _, _ = case
    f = r.frame("tool")
    T, dT = call("fk", r, q, f), gradient(r, "frame_pose", q, frame=f)
    inverse = np.linalg.inv(T)
    J = call("jacobian", r, q, f, reference)
    for k in range(r.nv):
        if reference == "local":
            assert scaled(hat(J[:, k]), inverse @ dT[..., k]) < TIGHT
        elif reference == "world":
            assert scaled(hat(J[:, k]), dT[..., k] @ inverse) < TIGHT
        else:
            assert scaled(hat(J[:, k])[:3, :3], (dT[..., k] @ inverse)[:3, :3]) < TIGHT
            assert scaled(J[3:, k], dT[:3, 3, k]) < TIGHT


@pytest.mark.parametrize("reference", REFERENCES)
def test_jacobian_dot_is_the_time_derivative_of_the_jacobian(case, reference):
    r, q, v, _ = case
    options = {"frame": r.frame("tool"), "reference": reference}
    assert scaled(call("jacobian_dot", r, q, v, **options), along(r, "jacobian", q, v, **options)) < TIGHT


@pytest.mark.parametrize("reference", REFERENCES)
def test_frame_velocity_is_jacobian_times_v(case, reference):
    r, q, v, _ = case
    J = call("jacobian", r, q, "tool", reference)
    assert scaled(call("frame_velocity", r, q, v, "tool", reference), J @ v) < TIGHT


@pytest.mark.parametrize("reference", REFERENCES)
def test_frame_acceleration_is_the_derivative_of_the_twist(case, reference):
    r, q, v, a = case
    options = {"frame": r.frame("tool"), "reference": reference}
    rate = along(r, "frame_velocity", q, v, (v, a), **options)
    spatial = call("frame_acceleration", r, q, v, a, **options)
    classical = call("frame_acceleration", r, q, v, a, classical=True, **options)
    # an observer who moves with the origin sees the acceleration of the point
    assert scaled(classical if reference == "local_world_aligned" else spatial, rate) < TIGHT
    w, u = np.split(call("frame_velocity", r, q, v, **options), 2)
    assert scaled(classical - spatial, np.r_[0, 0, 0, np.cross(w, u)]) < TIGHT


def test_dual_quaternions_and_matrices_are_the_same_poses(case):
    r, q, _, _ = case
    for f in r.frames:
        x = call("fk", r, q, f, as_="dual_quaternion")
        assert scaled(dp.spatial.to_matrix(x), call("fk", r, q, f)) < TIGHT


# --- dynamics ------------------------------------------------------------------------------------


def test_mass_matrix_is_the_hessian_of_the_kinetic_energy(case):
    r, q, v, _ = case
    M, T = call("crba", r, q), lambda u: call("kinetic_energy", r, q, u)
    I = np.eye(r.nv)
    basis = np.array([T(e) for e in I])
    # T is quadratic, so its polarisation is exact: M_jk = T(e_j + e_k) - T(e_j) - T(e_k)
    hessian = np.array([[T(e + f) - basis[j] - basis[k] for k, f in enumerate(I)] for j, e in enumerate(I)])
    assert scaled(M, hessian) < TIGHT
    assert scaled(T(v), v @ M @ v / 2) < TIGHT


def test_mass_matrix_is_symmetric_and_positive_definite(case):
    r, q, _, _ = case
    M = call("crba", r, q)
    assert (M == M.T).all()
    assert np.linalg.eigvalsh(M).min() > 0


def test_mass_matrix_is_the_derivative_of_torque_by_acceleration(case):
    r, q, v, a = case
    columns = [call("rnea", r, q, v, a + e) - call("rnea", r, q, v, a) for e in np.eye(r.nv)]
    assert scaled(np.stack(columns, -1), call("crba", r, q)) < 1e-11  # differences of torques near 1e2


def test_gravity_is_the_gradient_of_the_potential_energy(case):
    r, q, _, _ = case
    assert scaled(call("gravity", r, q), gradient(r, "potential_energy", q)) < TIGHT


def test_bias_is_coriolis_plus_gravity(case):
    r, q, v, a = case
    h, M = call("bias", r, q, v), call("crba", r, q)
    assert scaled(call("coriolis", r, q, v) @ v + call("gravity", r, q), h) < TIGHT
    assert scaled(M @ a + h, call("rnea", r, q, v, a)) < TIGHT


def test_coriolis_splits_the_rate_of_the_mass_matrix(case):
    r, q, v, _ = case
    C = call("coriolis", r, q, v)
    assert scaled(C + C.T, along(r, "crba", q, v)) < TIGHT


def test_coriolis_has_no_torsion(case):
    """C(v) w - C(w) v = M [v, w] with the brackets of the joints' own motions.

    Together with dM/dt = C + C^T this leaves one matrix only, that of the Levi-Civita connection.
    """
    r, q, v, w = case
    bracket = np.zeros(r.nv)
    for j in r:
        if not j.model.additive:
            V, W = (j.model.twist(x[j.v].tolist()) for x in (v, w))
            b = V.cross(W)
            b = np.array([float(x) for x in (*b.real, *b.dual)])
            bracket[j.v] = {"floating": b, "planar": b[[3, 4, 2]], "spherical": b[:3]}[j.kind]
            assert scaled(np.array(j.model.bracket(v[j.v].tolist(), w[j.v].tolist()), float), bracket[j.v]) < TIGHT
    one, other = call("coriolis", r, q, v) @ w, call("coriolis", r, q, w) @ v
    expected = other + (call("crba", r, q) - rotor_inertia(r)) @ bracket
    assert scaled(one, expected) < TIGHT  # relative to the two, whose difference may be nothing


@pytest.mark.parametrize("name", FIXED_BASE)
def test_coriolis_is_that_of_christoffels_symbols(name, seed):
    r = robot(name)
    q, v, _ = r.sample(seed=seed)
    D = gradient(r, "crba", q)  # D[i, j, k] = dM_ij / dq_k
    christoffel = (D + np.swapaxes(D, 1, 2) - np.moveaxis(D, 2, 0)) / 2
    assert scaled(call("coriolis", r, q, v), christoffel @ v) < TIGHT


def test_power_goes_into_energy(case):
    r, q, v, a = case
    tau = call("rnea", r, q, v, a)
    rate = along(r, "kinetic_energy", q, v, (v, a)) + along(r, "potential_energy", q, v)
    assert scaled(rate, v @ tau) < TIGHT


def solved(r: Robot, q: np.ndarray) -> float:
    """The tolerance of what involves M^-1: rounding times the conditioning."""
    return 1e-14 * max(100.0, float(np.linalg.cond(call("crba", r, q))))


def test_forward_dynamics_undoes_inverse_dynamics(case):
    r, q, v, a = case
    assert scaled(call("aba", r, q, v, call("rnea", r, q, v, a)), a) < solved(r, q)


def test_minv_is_the_inverse_of_the_mass_matrix(case):
    r, q, v, a = case
    M, inverse = call("crba", r, q), call("minv", r, q)
    assert np.abs(inverse @ M - np.eye(r.nv)).max() < solved(r, q)
    tau = call("rnea", r, q, v, a)
    assert scaled(inverse @ (tau - call("bias", r, q, v)), a) < solved(r, q)


def test_external_wrenches_act_through_the_jacobians(case, seed):
    r, q, v, a = case
    f = np.random.default_rng(seed).uniform(-5, 5, (len(r), 6))
    pushed = sum(call("jacobian", r, q, j.name, "local").T @ f[j.index] for j in r)
    assert scaled(call("rnea", r, q, v, a, f), call("rnea", r, q, v, a) - pushed) < TIGHT
    tau = call("rnea", r, q, v, a)
    assert scaled(call("aba", r, q, v, tau - pushed, f), a) < solved(r, q)


def test_joint_wrenches_are_what_holds_each_subtree(case, seed):
    """Their power on the screws is the torque; at the roots, what changes the momentum of everything."""
    r, q, v, a = case
    f = np.random.default_rng(seed).uniform(-5, 5, (len(r), 6))
    for pushed in ((), (f,)):
        F = call("joint_wrenches", r, q, v, a, *pushed)
        tau = rotor_inertia(r) @ a
        for j in r:
            S = np.array([[float(x) for x in (*s.real, *s.dual)] for s in j.model.screws])
            tau[j.v] += S @ F[j.index]
        assert scaled(tau, call("rnea", r, q, v, a, *pushed)) < TIGHT
    T = call("fk", r, q)
    total = sum(T[j.index][:3, :3] @ F[j.index][3:] for j in r if j.parent is None)
    pushing = sum(T[j.index][:3, :3] @ f[j.index][3:] for j in r)
    gravity = np.array([float(x) for x in r.gravity])
    rate = along(r, "centroidal_momentum_matrix", q, v) @ v + call("centroidal_momentum_matrix", r, q) @ a
    assert scaled(total, rate[3:] - r.mass * gravity - pushing) < TIGHT


def test_link_terms_sum_to_the_whole(case):
    r, q, v, _ = case
    terms = call("link_terms", r, q, v)
    assert [t.name for t in terms] == r.joint_names
    assert scaled(sum(t.M for t in terms), call("crba", r, q)) < TIGHT
    assert scaled(sum(t.C for t in terms), call("coriolis", r, q, v)) < TIGHT
    assert scaled(sum(t.g for t in terms), call("gravity", r, q)) < TIGHT


# --- momentum and parameters ---------------------------------------------------------------------


def test_centroidal_momentum_is_the_sum_of_the_links_own(case):
    r, q, v, _ = case
    c, total, momentum = call("com", r, q), 0.0, np.zeros(6)
    first = np.zeros(3)
    for link in r.links:
        if link.joint is None:
            continue
        T = call("fk", r, q, link.name)
        R, p = T[:3, :3], T[:3, 3]
        twist = call("frame_velocity", r, q, v, link.name, "local")
        w, u = twist[:3], twist[3:]
        m, h = float(link.inertia.mass), np.array([float(x) for x in link.inertia.moment])
        J = np.array([[float(x) for x in row] for row in link.inertia.rotational.rows])
        linear, angular = R @ (m * u + np.cross(w, h)), R @ (J @ w + np.cross(h, u))
        momentum += np.r_[angular + np.cross(p - c, linear), linear]
        total, first = total + m, first + m * p + R @ h
    A = call("centroidal_momentum_matrix", r, q)
    assert scaled(A @ v, momentum) < TIGHT
    assert scaled(c, first / total) < TIGHT
    assert scaled(r.mass, total) < TIGHT
    assert scaled(call("com_jacobian", r, q) * total, A[3:]) < TIGHT


def test_com_jacobian_is_the_derivative_of_the_com(case):
    r, q, _, _ = case
    assert scaled(call("com_jacobian", r, q), gradient(r, "com", q)) < TIGHT


def with_other_inertias(r: Robot, seed: int) -> Robot:
    rng, b = np.random.default_rng(seed), Builder.of(r)
    for part in b._parts.values():
        m, *h = rng.uniform(-1, 1, 4).tolist()
        xx, xy, yy, xz, yz, zz = rng.uniform(-1, 1, 6).tolist()
        if any(map(float, part.armature)):
            part.armature = tuple(rng.uniform(0.1, 1, len(part.armature)).tolist())
        part.inertia = Inertia(m, Vector3(*h), Matrix3(Vector3(xx, xy, xz), Vector3(xy, yy, yz), Vector3(xz, yz, zz)))
    return b.robot()


def test_torque_is_linear_in_the_inertial_parameters(case, seed):
    r, q, v, a = case
    Y = call("joint_torque_regressor", r, q, v, a)
    other = with_other_inertias(r, seed)
    for body in (r, other):  # the regressor does not depend on the inertias that multiply it
        assert scaled(Y @ dp.inertial_parameters(body), call("rnea", body, q, v, a)) < TIGHT
    assert (call("joint_torque_regressor", other, q, v, a) == Y).all()


# --- the group -----------------------------------------------------------------------------------


def test_integrate_and_difference_undo_each_other(case):
    r, q, v, _ = case
    step = 0.25 * v  # |w| <= 0.25 sqrt(3) 2 pi < pi: what turns further has a shorter way
    there = call("integrate", r, q, step)
    assert scaled(call("difference", r, q, there), step) < TIGHT
    assert scaled(call("fk", r, call("integrate", r, q, call("difference", r, q, there))), call("fk", r, there)) < TIGHT
    assert scaled(call("integrate", r, q, 0 * v), q) < TIGHT
    assert scaled(call("difference", r, q, q), 0 * v) < TIGHT


def test_integrate_moves_with_a_constant_body_twist(case):
    """Two half steps are a whole one; and the twist on the way is J v at every point of it."""
    r, q, v, _ = case
    half = call("integrate", r, q, 0.5 * v)
    assert scaled(call("fk", r, call("integrate", r, half, 0.5 * v)), call("fk", r, call("integrate", r, q, v))) < TIGHT


# --- mimic ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["mimic", "floating_mimic"])
def test_mimic_is_the_projection_of_the_free_robot(name, seed):
    r = robot(name)
    b = Builder.of(r)
    for part in b._parts.values():
        part.mimic = None
    free = b.robot()
    assert free.nv > r.nv
    q, v, a = r.sample(seed=seed)
    G, x = np.zeros((free.nv, r.nv)), np.zeros(free.nq)
    for j, k in zip(r, free, strict=True):
        ratio, offset, here = 1.0, 0.0, j
        while here.mimic is not None:
            offset, ratio = offset + ratio * here.mimic.offset, ratio * here.mimic.multiplier
            here = r.joint(here.mimic.joint)
        G[k.v, here.v] = ratio * np.eye(k.model.nv)
        x[k.q] = ratio * q[here.q] + offset
    v_, a_ = G @ v, G @ a
    assert scaled(call("fk", r, q), call("fk", free, x)) < TIGHT
    assert scaled(call("crba", r, q), G.T @ call("crba", free, x) @ G) < TIGHT
    assert scaled(call("coriolis", r, q, v), G.T @ call("coriolis", free, x, v_) @ G) < TIGHT
    assert scaled(call("rnea", r, q, v, a), G.T @ call("rnea", free, x, v_, a_)) < TIGHT
    assert scaled(call("jacobian", r, q, "tool"), call("jacobian", free, x, "tool") @ G) < TIGHT
    assert scaled(call("centroidal_momentum_matrix", r, q), call("centroidal_momentum_matrix", free, x) @ G) < TIGHT


@pytest.mark.parametrize("known", [True, False], ids=["no_inertia", "inertia_of_zeros"])
def test_a_joint_that_moves_no_mass_has_no_finite_acceleration(known):
    """Not an exception: nan where M is singular, for one sample as for many."""
    b = Builder("weightless")
    rows = [Vector3(*row) for row in np.eye(3).tolist()]
    nothing = Inertia(0.0, Vector3(0.0, 0.0, 0.0), Matrix3(*(row * 0.0 for row in rows)))
    b.joint("arm", revolute(), inertia=Inertia(1.0, Vector3(0.1, 0.2, 0.3), Matrix3(*rows)))
    b.joint("hand", revolute(), "arm", inertia=None if known else nothing)
    r = b.robot()
    for shape in ((), (1,), (3,)):
        x = np.ones((*shape, 2))
        assert not np.isfinite(call("aba", r, x, x, x)[..., 1]).any()
        assert not np.isfinite(call("minv", r, x)[..., 1, 1]).any()
        assert np.isfinite(call("rnea", r, x, x, x)).all()
