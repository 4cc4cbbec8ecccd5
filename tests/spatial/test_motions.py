"""Rigid motions: group axioms by hypothesis, and exp, log and screws where formulas lose digits.

Tolerance: a product of unit dual quaternions keeps 1e-15 of its size; translations here are up to
10 m, so 1e-13 absolute leaves room for a few products.  Where w is recovered from a rotation by an
angle t near pi, or v from a translation, the same holds: nothing is amplified.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import dualpin as dp
from dualpin.spatial import compose, exp, from_matrix, inverse, log, sclerp, screw_parameters, to_matrix

CLOSE = 1e-13
IDENTITY = np.array([1.0, 0, 0, 0, 0, 0, 0, 0])
SHAPES = ((), (1,), (3, 1, 2), (0,), (2, 0, 3))

numbers = st.floats(-10, 10, allow_subnormal=False)


def twists(shape: tuple[int, ...] = ()):
    """Twists whose rotation stays well below a turn: any larger one is another motion's logarithm."""
    return arrays(float, (*shape, 6), elements=numbers).map(lambda x: x * [0.1, 0.1, 0.1, 1, 1, 1])


shaped = st.sampled_from(SHAPES).flatmap(twists)


def near(x: np.ndarray, y: np.ndarray, tolerance: float = CLOSE) -> bool:
    return np.shape(x) == np.shape(y) and bool((np.abs(np.asarray(x) - y) <= tolerance).all())


def same_motion(x: np.ndarray, y: np.ndarray, tolerance: float = CLOSE) -> bool:
    return near(to_matrix(x), to_matrix(y), tolerance)


@given(shaped)
def test_exp_is_a_unit_dual_quaternion(twist):
    x = exp(twist)
    assert x.shape == (*twist.shape[:-1], 8)
    r, d = x[..., :4], x[..., 4:]
    assert near(np.linalg.norm(r, axis=-1), np.ones(r.shape[:-1]), 1e-15 * 4)
    assert near(np.einsum("...i,...i", r, d), np.zeros(r.shape[:-1]))


@given(shaped)
def test_log_undoes_exp(twist):
    assert near(log(exp(twist)), twist)
    assert near(log(to_matrix(exp(twist))), twist)


@given(twists(), twists(), twists())
def test_composition_is_associative(a, b, c):
    x, y, z = exp(a), exp(b), exp(c)
    assert near(compose(compose(x, y), z), compose(x, compose(y, z)))


@given(shaped)
def test_identity_and_inverse(twist):
    x = exp(twist)
    one = np.broadcast_to(IDENTITY, x.shape)
    assert near(compose(x, one), x) and near(compose(one, x), x)
    assert near(compose(x, inverse(x)), one) and near(compose(inverse(x), x), one)
    assert near(inverse(x), exp(-twist))


@given(twists(), twists())
def test_composition_is_the_product_of_matrices(a, b):
    x, y = exp(a), exp(b)
    assert near(to_matrix(compose(x, y)), to_matrix(x) @ to_matrix(y))


@given(shaped)
def test_matrices_and_dual_quaternions_are_the_same_motions(twist):
    x = exp(twist)
    back = from_matrix(to_matrix(x))
    assert near(np.where(back[..., :1] * x[..., :1] < 0, -back, back), x) or same_motion(back, x)
    assert (back[..., 0] >= 0).all()


@given(twists(), st.floats(-2, 2))
def test_powers_lie_on_one_screw(twist, s):
    assert near(compose(exp(twist), exp(s * twist)), exp((1 + s) * twist), 1e-12)


@given(twists((3, 1, 2)), twists((2,)))
def test_shapes_broadcast_and_equal_a_loop(a, b):
    x = compose(exp(a), exp(b))
    assert x.shape == (3, 1, 2, 8)
    for i in np.ndindex(3, 1, 2):
        assert near(x[i], compose(exp(a[i]), exp(b[i[-1]])), 1e-15)


@given(twists(), twists())
def test_sclerp_goes_from_one_to_the_other_along_a_screw(a, b):
    x, y = exp(a), exp(b)
    assert same_motion(sclerp(x, y, 0.0), x) and same_motion(sclerp(x, y, 1.0), y, 1e-12)
    whole = log(compose(inverse(x), y))
    for s in (0.25, 0.5, 0.75):
        assert near(log(compose(inverse(x), sclerp(x, y, s))), s * whole, 1e-12)
    many = sclerp(x, y, np.linspace(0, 1, 5))
    assert many.shape == (5, 8) and same_motion(many[2], sclerp(x, y, 0.5))


@given(twists(), twists())
def test_sclerp_does_not_depend_on_signs(a, b):
    x, y = exp(a), exp(b)
    if abs(float(log(compose(inverse(x), y))[:3] @ log(compose(inverse(x), y))[:3]) - np.pi**2) > 1e-6:
        assert same_motion(sclerp(x, -y, 0.3), sclerp(x, y, 0.3), 1e-12)


# --- near 0 and near pi --------------------------------------------------------------------------

AXES = [np.array(a, float) / np.linalg.norm(a) for a in ([0, 0, 1], [1, 0, 0], [0, -1, 0], [1, 2, -2], [-1, 1e-9, 0])]
SMALL = (1e-300, 1e-160, 1e-18, 1e-15, 1e-12, 1e-9, 1e-8, 1e-6, 1e-3)
NEAR_PI = (np.pi - 1e-3, np.pi - 1e-6, np.pi - 1e-9, np.pi - 1e-12, np.pi - 1e-15, np.pi)
POINT = np.array([0.3, -0.2, 0.5])


def screw(axis: np.ndarray, angle: float, distance: float, point: np.ndarray = POINT) -> np.ndarray:
    """The twist of the screw motion about a line: w = t n, v = d n + point x w."""
    return np.r_[angle * axis, distance * axis + np.cross(point, angle * axis)]


@pytest.mark.parametrize("angle", SMALL)
@pytest.mark.parametrize("axis", AXES, ids=str)
def test_log_keeps_small_angles_to_the_last_digit(axis, angle):
    twist = screw(axis, angle, 0.0)
    back = log(exp(twist))
    # relative to the angle itself: no floor at 1e-8 as of acos(w)
    assert np.abs(back - twist).max() <= 4e-16 * angle


@pytest.mark.parametrize("angle", NEAR_PI)
@pytest.mark.parametrize("axis", AXES, ids=str)
def test_log_is_exact_near_half_turns(axis, angle):
    twist = screw(axis, angle, 0.7)
    for x in (exp(twist), to_matrix(exp(twist))):
        back = log(x)
        if angle >= np.pi - 1e-14:  # both directions are the same motion there
            back = back if back[:3] @ twist[:3] > 0 else -_other_way(back)
        assert np.abs(back - twist).max() < 4e-15 if np.ndim(x) == 1 else np.abs(back - twist).max() < 1e-14


def _other_way(m: np.ndarray) -> np.ndarray:
    """Minus the screw by t - 2 pi instead of t about the same line."""
    s = screw_parameters(exp(m))
    t = float(s.angle) - 2 * np.pi
    return -np.r_[t * s.axis, float(s.distance) * s.axis + t * s.moment]


@pytest.mark.parametrize("angle", [1e-12, 1e-9, 1e-6, 1e-3, 1.0, *NEAR_PI[:-2]])
@pytest.mark.parametrize("axis", AXES, ids=str)
def test_screw_parameters_of_a_screw(axis, angle):
    distance = 0.4
    s = screw_parameters(exp(screw(axis, angle, distance)))
    foot = POINT - (POINT @ axis) * axis
    assert abs(float(s.angle) - angle) < 1e-15 * 8
    assert np.abs(s.axis - axis).max() < 1e-15 * 8
    assert abs(float(s.distance) - distance) < 1e-15 * 8
    # v = d n + t m is known to 1e-16, so m only to 1e-16 / t
    assert np.abs(s.moment - np.cross(foot, axis)).max() < 1e-15 * (8 + 8 / angle)
    assert np.abs(s.point - foot).max() < 1e-15 * (8 + 8 / angle)
    assert abs(float(s.pitch) * angle - distance) < 1e-15 * 8


@pytest.mark.parametrize("length", [1e-150, 1e-12, 1e-9, 1.0, 1e6])
@pytest.mark.parametrize("axis", AXES, ids=str)
def test_pure_translations(axis, length):
    twist = np.r_[0, 0, 0, length * axis]
    x = exp(twist)
    assert near(x[:4], IDENTITY[:4], 0) and near(log(x), twist, 4e-16 * length)
    for s in (screw_parameters(x), screw_parameters(to_matrix(x))):
        assert s.angle == 0 and np.isinf(s.pitch)
        assert np.abs(s.axis - axis).max() < 4e-16
        assert abs(s.distance - length) < 4e-16 * length
        assert (s.moment == 0).all() and (s.point == 0).all()


def test_the_identity():
    assert (exp(np.zeros(6)) == IDENTITY).all()
    assert (log(IDENTITY) == 0).all() and (log(-IDENTITY) == 0).all() and (log(np.eye(4)) == 0).all()
    s = screw_parameters(np.eye(4))
    assert (s.angle, s.distance, s.pitch) == (0, 0, 0)
    assert (s.axis == [0, 0, 1]).all() and (s.point == 0).all()


@pytest.mark.parametrize("axis", AXES, ids=str)
def test_exact_half_turns_from_matrices(axis):
    """2 a a^T - 1 has no antisymmetric part: the axis must come from the diagonal."""
    T = np.eye(4)
    T[:3, :3] = 2 * np.outer(axis, axis) - np.eye(3)
    T[:3, 3] = [1.0, 2.0, 3.0]
    s = screw_parameters(T)
    assert abs(float(s.angle) - np.pi) < 1e-15
    assert abs(abs(float(s.axis @ axis)) - 1) < 1e-15
    assert abs(float(s.distance) - T[:3, 3] @ s.axis) < 1e-14
    assert same_motion(exp(log(T)), from_matrix(T), 1e-14)


def test_pure_rotations_have_pitch_zero():
    s = screw_parameters(exp(screw(AXES[3], 1.0, 0.0)))
    assert abs(float(s.pitch)) < 1e-15 and abs(float(s.distance)) < 1e-15


def test_screws_of_a_batch_equal_a_loop():
    rng = np.random.default_rng(0)
    x = exp(rng.uniform(-1, 1, (3, 1, 2, 6)))
    x[0, 0, 0], x[1, 0, 1] = IDENTITY, exp([0, 0, 0, 1, 2, 2])
    s = screw_parameters(x)
    for i in np.ndindex(3, 1, 2):
        one = screw_parameters(x[i])
        for name in ("angle", "distance", "axis", "moment", "point", "pitch"):
            a, b = getattr(s, name)[i], getattr(one, name)
            assert np.array_equal(a, b) or np.abs(a - b).max() < 1e-15, name


# --- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("function", "arguments", "match"),
    [
        (exp, (np.zeros(5),), r"exp: twist of shape \(\.\.\., 6\) expected, got \(5,\)"),
        (exp, (np.zeros(6, complex),), "real numbers expected"),
        (exp, ("twist",), "real numbers expected"),
        (exp, ([[1, 2], [3]],), "exp: twist"),
        (log, (np.zeros((4, 5)),), "expected, got"),
        (log, (3.0,), "expected, got"),
        (to_matrix, (np.zeros(8),), "unit"),
        (to_matrix, ([2.0, 0, 0, 0, 0, 0, 0, 0],), "unit"),
        (log, ([1.0, 0, 0, 0, 1, 0, 0, 0],), "unit"),
        (screw_parameters, (np.zeros((4, 4)),), "rotation"),
        (from_matrix, (np.diag([1.0, 1, -1, 1]),), "det R is negative"),
        (from_matrix, (np.full((4, 4), np.nan),), "rotation"),
        (from_matrix, (2 * np.eye(4),), "rotation"),
        (compose, (np.zeros((2, 8)), np.zeros((3, 8))), "broadcast"),
        (sclerp, (IDENTITY, IDENTITY, "half"), "real numbers"),
        (sclerp, (np.tile(IDENTITY, (2, 1)), np.tile(IDENTITY, (2, 1)), np.zeros(3)), "broadcast"),
    ],
)
def test_what_is_no_motion_is_refused(function, arguments, match):
    with pytest.raises(dp.DualpinError, match=match):
        function(*arguments)


def test_what_is_not_finite_stays_so():
    for twist in (np.full(6, np.nan), np.full(6, 1e200), np.full((2, 6), np.inf)):
        assert np.isnan(exp(twist)).any()
    s = screw_parameters(np.full(8, np.nan))
    assert np.isnan(s.angle) and np.isnan(s.distance)


def test_lists_and_integers_are_accepted():
    assert near(exp([0, 0, 0, 2, 0, 0]), [1, 0, 0, 0, 0, 1, 0, 0])
    assert near(to_matrix([1, 0, 0, 0, 0, 0, 0, 0]), np.eye(4))
