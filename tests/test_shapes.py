"""The array boundary: batches equal loops, leading axes broadcast, and what does not fit is named."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.interpret import SLICE
from tests.random_robots import robot

# name -> inputs, and the options that make it callable
FUNCTIONS = {
    "fk": ("q",), "jacobian": ("q",), "jacobian_dot": ("q", "v"), "frame_velocity": ("q", "v"),
    "frame_acceleration": ("q", "v", "a"), "rnea": ("q", "v", "a"), "bias": ("q", "v"), "gravity": ("q",),
    "crba": ("q",), "coriolis": ("q", "v"), "aba": ("q", "v", "a"), "minv": ("q",), "kinetic_energy": ("q", "v"),
    "potential_energy": ("q",), "com": ("q",), "com_jacobian": ("q",), "centroidal_momentum_matrix": ("q",),
    "joint_torque_regressor": ("q", "v", "a"), "joint_wrenches": ("q", "v", "a"),
    "integrate": ("q", "v"), "difference": ("q", "q"),
}  # fmt: skip
OPTIONS = {name: {"frame": "tool"} for name in ("jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration")}
TAIL = {
    "fk": lambda r: (len(r), 4, 4), "jacobian": lambda r: (6, r.nv), "jacobian_dot": lambda r: (6, r.nv),
    "frame_velocity": lambda r: (6,), "frame_acceleration": lambda r: (6,), "crba": lambda r: (r.nv, r.nv),
    "coriolis": lambda r: (r.nv, r.nv), "minv": lambda r: (r.nv, r.nv), "kinetic_energy": lambda r: (),
    "potential_energy": lambda r: (), "com": lambda r: (3,), "com_jacobian": lambda r: (3, r.nv),
    "centroidal_momentum_matrix": lambda r: (6, r.nv), "integrate": lambda r: (r.nq,),
    "joint_torque_regressor": lambda r: (r.nv, 10 * len(r)), "joint_wrenches": lambda r: (len(r), 6),
}  # fmt: skip

functions = pytest.mark.parametrize("name", FUNCTIONS)
robots = pytest.mark.parametrize("kind", ["floating", "mixed", "mimic"])


def states(r, shape, seed=3):
    """q, v, a with these leading axes."""
    n = int(np.prod(shape, dtype=int))
    return {k: x.reshape(*shape, x.shape[-1]) for k, x in zip("qva", r.sample(n, seed=seed), strict=True)}


def call(name, r, *arrays):
    return getattr(dp, name)(r, *arrays, engine="numpy", **OPTIONS.get(name, {}))


def tail(name, r):
    return TAIL.get(name, lambda r: (r.nv,))(r)


@robots
@functions
@pytest.mark.parametrize("shape", [(), (1,), (3, 1, 2), (0,), (2, 0, 3)], ids=str)
def test_a_batch_equals_a_loop(name, kind, shape):
    r = robot(kind)
    given = [states(r, shape, seed=i)[k] for i, k in enumerate(FUNCTIONS[name])]
    result = call(name, r, *given)
    assert result.shape == (*shape, *tail(name, r)) and result.dtype == np.float64
    for i in np.ndindex(*shape):
        one = call(name, r, *(x[i] for x in given))
        # one sample runs on floats, many on arrays: the same operations, libm against NumPy's loops
        assert np.abs(result[i] - one).max(initial=0) <= 1e-12 * max(1, np.abs(one).max(initial=0))


@robots
@functions
def test_leading_axes_broadcast(name, kind):
    r, inputs = robot(kind), FUNCTIONS[name]
    shapes = [(3, 1), (2,), (1, 1)]
    given = [states(r, shapes[i], seed=i)[k] for i, k in enumerate(inputs)]
    batch = np.broadcast_shapes(*shapes[: len(inputs)])
    whole = [np.broadcast_to(x, (*batch, x.shape[-1])) for x in given]
    assert np.array_equal(call(name, r, *given), call(name, r, *whole))


@pytest.mark.parametrize("n", [1, 2, 1023, 1024, 1025, 2049])
def test_slices_of_a_batch_join_without_a_seam(n):
    assert SLICE == 1024
    r = robot("floating")
    s = states(r, (n,))
    tau = dp.rnea(r, s["q"], s["v"], s["a"], engine="numpy")
    for i in {0, n // 2, min(n, 1023) - 1, min(n, 1024) - 1, n - 1}:
        one = dp.rnea(r, s["q"][i], s["v"][i], s["a"][i], engine="numpy")
        assert np.abs(tau[i] - one).max() < 1e-12 * np.abs(one).max()


def test_fk_of_one_frame_and_as_dual_quaternions():
    r = robot("floating")
    q = states(r, (2, 3))["q"]
    assert dp.fk(r, q, "tool", engine="numpy").shape == (2, 3, 4, 4)
    assert dp.fk(r, q, "tool", as_="dual_quaternion", engine="numpy").shape == (2, 3, 8)
    assert dp.fk(r, q, as_="dual_quaternion", engine="numpy").shape == (2, 3, len(r), 8)
    assert dp.fk(r, q[:0], as_="dual_quaternion", engine="numpy").shape == (0, 3, len(r), 8)


def test_external_wrenches_and_link_terms_broadcast():
    r = robot("floating")
    s, f = states(r, (3, 1)), np.ones((2, len(r), 6))
    assert dp.rnea(r, s["q"], s["v"], s["a"], f, engine="numpy").shape == (3, 2, r.nv)
    terms = dp.link_terms(r, s["q"], s["v"], engine="numpy")
    assert len(terms) == len(r)
    assert terms[-1].M.shape == (3, 1, r.nv, r.nv) and terms[0].g.shape == (3, 1, r.nv)


def test_inputs_are_not_modified():
    r = robot("mixed")
    s = states(r, (4,))
    before = {k: x.copy() for k, x in s.items()}
    for name, inputs in FUNCTIONS.items():
        call(name, r, *(s[k] for k in inputs))
    assert all(np.array_equal(s[k], before[k]) for k in s)


def test_results_can_be_written_to():
    r = robot("arm")
    for name, inputs in FUNCTIONS.items():
        for shape in ((), (2,)):
            result = call(name, r, *(states(r, shape)[k] for k in inputs))
            assert isinstance(result, np.ndarray) and result.flags.writeable, name


@pytest.mark.parametrize("kind", [list, tuple, np.float32, np.float16, int, bool, np.longdouble])
def test_what_is_real_is_accepted(kind):
    r = robot("arm")
    q = np.array([1, 0, 1, 0, 1, 1])
    given = kind(q.tolist()) if kind in (list, tuple) else q.astype(kind)
    assert np.array_equal(dp.gravity(r, given, engine="numpy"), dp.gravity(r, q.astype(float), engine="numpy"))


def test_arrays_of_any_layout_are_accepted():
    r = robot("arm")
    q = states(r, (5,))["q"]
    for same in (
        np.asfortranarray(q),
        q[::-1][::-1],
        np.broadcast_to(q, (1, 5, 6))[0],
        q.view(np.ndarray).astype(">f8"),
    ):
        assert np.array_equal(dp.crba(r, same, engine="numpy"), dp.crba(r, q, engine="numpy"))


@pytest.mark.parametrize(
    ("q", "error", "match"),
    [
        (np.zeros(5), dp.ShapeError, r"crba: q of shape \(\.\.\., 6\) expected for tree7 \(nq = 6\), got \(5,\)"),
        (np.zeros((6, 3)), dp.ShapeError, r"got \(6, 3\)"),
        (0.0, dp.ShapeError, r"got \(\)"),
        ([], dp.ShapeError, r"got \(0,\)"),
        ([[0] * 6, [0] * 5], dp.ShapeError, "crba: q: not an array"),
        (np.zeros(6, complex), dp.ArgumentError, "real numbers expected, got complex128"),
        (np.zeros(6, object), dp.ArgumentError, "real numbers expected, got object"),
        (["a"] * 6, dp.ArgumentError, "real numbers expected"),
        (None, dp.ArgumentError, "real numbers expected, got object .NoneType."),
        ({"q": 0}, dp.ArgumentError, "real numbers expected"),
        (np.zeros(6, "datetime64[s]"), dp.ArgumentError, "real numbers expected"),
    ],
    ids=str,
)
def test_what_does_not_fit_is_named(q, error, match):
    with pytest.raises(error, match=match):
        dp.crba(robot("arm"), q, engine="numpy")


def test_axes_that_do_not_broadcast_are_named():
    r = robot("arm")
    with pytest.raises(dp.ShapeError, match=r"bias: the leading axes of q \(2, 6\), v \(3, 6\) do not broadcast"):
        dp.bias(r, np.zeros((2, 6)), np.zeros((3, 6)))
    with pytest.raises(dp.ShapeError, match=r"a wrench \[n; f\] for each of 6 joints"):
        dp.rnea(r, *np.zeros((3, 6)), np.zeros((5, 6)))


def test_quaternions_must_have_unit_norm():
    r = robot("floating")
    q = states(r, (4, 2))["q"]
    q[2, 1, 3:7] *= 1.01
    with pytest.raises(dp.ArgumentError, match=r"q\[3:7\] of joint 'joint0'.*norm is 1\.01.*at sample \(2, 1\)"):
        dp.crba(r, q)
    with pytest.raises(dp.ArgumentError, match=r"unit quaternion \(w, x, y, z\); its norm is 0"):
        dp.difference(r, np.zeros(r.nq), r.neutral)
    q[2, 1, 3:7] /= 1.01
    assert np.isfinite(dp.crba(r, q, engine="numpy")).all()


def test_not_a_number_comes_out_where_it_goes_in():
    r = robot("arm")
    q = states(r, (3,))["q"]
    q[1, 2] = np.nan
    M = dp.crba(r, q, engine="numpy")
    assert np.isnan(M[1]).any() and np.isfinite(M[[0, 2]]).all()
    assert np.isnan(dp.crba(r, q[1], engine="numpy")).any()
    assert np.isnan(dp.gravity(r, [np.inf] * 6, engine="numpy")).any()


@pytest.mark.parametrize(
    ("run", "match"),
    [
        (lambda r, q: dp.jacobian(r, q, "tool", "wrld"), "reference 'wrld' is not known; did you mean 'world'"),
        (lambda r, q: dp.fk(r, q, as_="quaternion"), "as_ 'quaternion' is not known; did you mean 'dual_quaternion'"),
        (lambda r, q: dp.fk(r, q, "tol"), "did you mean 'tool'"),
        (lambda r, q: dp.fk(r, q, 99), "it has .* frames"),
        (lambda r, q: dp.fk(r, q, ["tool"]), "a name, an index or a Frame"),
        (lambda r, q: dp.fk(r, q, robot("pendulum").frame("tool")), "another robot"),
        (lambda r, q: dp.crba(r, q, engine="numby"), "did you mean 'numpy'"),
        (lambda r, q: dp.crba("panda", q), r"a Robot expected, got str; dualpin.load\('panda'\) reads one"),
        (lambda r, q: dp.jacobian(None, q, "tool"), "a Robot expected"),
    ],
    ids=range(9),
)
def test_options_that_do_not_exist_are_named(run, match):
    r = robot("arm")
    with pytest.raises(dp.DualpinError, match=match):
        run(r, np.zeros(6))
