"""Samples, and the limits they respect."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.model import Builder, Limits, Mimic, prismatic, revolute
from tests.random_robots import SPECS, robot

names = pytest.mark.parametrize("name", SPECS)


@names
def test_samples_are_reproducible_and_within_limits(name):
    r = robot(name)
    q, v, a = r.sample(200, seed=1)
    assert q.shape == (200, r.nq) and v.shape == a.shape == (200, r.nv)
    for x, y in zip((q, v, a), r.sample(200, seed=1), strict=True):
        assert np.array_equal(x, y)
    assert not np.array_equal(q, r.sample(200, seed=2)[0])
    low, high = (np.where(np.isfinite(x), x, s * np.pi) for x, s in ((r.lower, -1), (r.upper, 1)))
    assert (q >= low - 1e-15).all() and (q <= high + 1e-15).all()
    assert (np.abs(v) <= np.minimum(r.velocity_limit, 2 * np.pi)).all()
    for j in r:
        if j.kind == "floating":
            assert np.abs(np.linalg.norm(q[:, j.q][:, 3:], axis=1) - 1).max() < 1e-15 * 4


def limited(lower: float, upper: float, model=None, **more: float) -> dp.Robot:
    b = Builder("limited")
    b.joint("j", model or prismatic(), limits=Limits((lower,), (upper,), **more))
    return b.robot()


@pytest.mark.parametrize(
    ("lower", "upper"),
    [(-2, 3), (5, 9), (-9, -5), (0, 0), (2, 1), (-1e308, 1e308), (-1.7e308, 1.7e308), (1, np.inf), (-np.inf, -7),
     (-np.inf, np.inf)],
)  # fmt: skip
def test_samples_respect_odd_limits(lower, upper):
    for model in (prismatic(), revolute()):
        q, _, _ = limited(lower, upper, model).sample(100, seed=0)
        assert np.isfinite(q).all()
        assert (q >= lower).all() and (q <= max(lower, upper)).all()
        assert lower >= upper or q.min() < q.max()


def test_a_velocity_limit_of_zero_means_that_none_is_known():
    for speed in (0.0, np.inf, 0.5):
        _, v, _ = limited(-1, 1, velocity=speed).sample(100, seed=0)
        assert np.ptp(v) > 0 and np.abs(v).max() <= {0.0: 1.0, 0.5: 0.5}.get(speed, 2 * np.pi)


def coupled(own: tuple[float, float], *followers: tuple[float, float, tuple[float, float]], maker=revolute) -> dp.Robot:
    """A leader with limits, and joints that follow it: (multiplier, offset, own limits)."""
    b = Builder("coupled")
    b.joint("leader", maker(), limits=Limits((own[0],), (own[1],), velocity=3.0))
    for i, (multiplier, offset, (low, high)) in enumerate(followers):
        limits = Limits((low,), (high,), velocity=1.0)
        b.joint(f"f{i}", maker(), "leader", mimic=Mimic("leader", multiplier, offset), limits=limits)
    return b.robot()


@pytest.mark.parametrize(
    ("followers", "lower", "upper"),
    [
        ([(2.0, 0.0, (-1.0, 1.0))], -0.5, 0.5),
        ([(-2.0, 0.5, (-1.0, 2.0))], -0.75, 0.75),
        ([(-1.0, 0.0, (0.0, 5.0))], -3.0, 0.0),
        ([(2.0, 0.0, (-1.0, 9.0)), (-4.0, 0.0, (-1.0, 9.0))], -0.5, 0.25),
        ([(0.0, 0.3, (0.0, 1.0))], -3.0, 3.0),
        ([(1.0, 0.0, (2.0, 1.0))], -3.0, 3.0),  # crossed limits bound nothing
        ([(1.0, 0.0, (-np.inf, 1.0))], -3.0, 1.0),
    ],
)
def test_limits_of_followers_bound_their_leader(followers, lower, upper):
    r = coupled((-3.0, 3.0), *followers)
    assert (r.lower.tolist(), r.upper.tolist(), r.notes) == ([lower], [upper], ())
    assert r.velocity_limit.tolist() == [min([3.0, *(1 / abs(m) for m, *_ in followers if m)])]
    q, v, _ = r.sample(500, seed=0)
    assert lower <= q.min() < q.max() <= upper
    for j in r:
        multiplier, offset = map(float, j.coupling)
        if j.mimic is not None and multiplier and j.limits.lower[0] <= j.limits.upper[0]:
            x = multiplier * q + offset
            assert j.limits.lower[0] - 1e-15 <= x.min() and x.max() <= j.limits.upper[0] + 1e-15
            assert np.abs(multiplier * v).max() <= 1.0 + 1e-15


def test_limits_of_followers_of_followers():
    b = Builder("chain")
    b.joint("c", revolute(), limits=Limits((-3.0,), (3.0,)))
    b.joint("a", revolute(), "c", mimic=Mimic("b", -2.0, 0.5), limits=Limits((-1.0,), (1.0,)))
    b.joint("b", revolute(), "a", mimic=Mimic("c", 0.5, 0.25))
    r = b.robot()  # a = -2 (q / 2 + 1/4) + 1/2 = -q
    assert (r.lower.tolist(), r.upper.tolist()) == ([-1.0], [1.0])


@pytest.mark.parametrize("follower", [(1.0, 0.0, (4.0, 5.0)), (-1.0, 0.0, (4.0, 5.0)), (0.0, 2.0, (0.0, 1.0))])
def test_limits_that_leave_nothing_are_said_and_the_leaders_own_hold(follower):
    r = coupled((-3.0, 3.0), follower)
    assert (r.lower.tolist(), r.upper.tolist()) == ([-3.0], [3.0])
    assert any("'leader'" in n and "'f0'" in n and "limit" in n for n in r.notes)
    again = Builder.of(r).robot()
    assert again.notes == r.notes
    q, _, _ = r.sample(50, seed=0)
    assert -3 <= q.min() < q.max() <= 3


def test_limits_that_meet_in_a_point_but_for_rounding():
    r = coupled((0.0, 0.3), (0.1, 0.0, (0.03 + 1e-17, 1.0)))
    assert r.lower <= r.upper == 0.3 and r.notes == ()


@pytest.mark.parametrize(
    ("make", "lower", "upper", "low", "high"),
    [
        (revolute, -1e308, 1e308, -np.pi, np.pi),
        (revolute, -1e9, 1e9 + 20, 10 - np.pi, 10 + np.pi),
        (revolute, 1e300, 1e308, -np.pi, np.pi),
        (revolute, -201.0, 0.0, -np.pi, 0.0),
        (revolute, -199.0, 199.0, -199.0, 199.0),
        (prismatic, -1e308, 1e308, -1.0, 1.0),
        (prismatic, 0.5, 101.0, 0.5, 1.5),
        (prismatic, -99.0, 99.0, -99.0, 99.0),
    ],
)
def test_huge_limits_count_as_none_where_configurations_are_sampled(make, lower, upper, low, high):
    r = limited(lower, upper, make())
    with np.errstate(all="raise"):
        q, _, _ = r.sample(200, seed=0)
    assert low <= q.min() < q.max() <= high and np.ptp(q) > 0.9 * (high - low)
    assert any("j: farther than" in n for n in r.notes) == (max(-lower, upper) > (200 if make is revolute else 100))


@pytest.mark.parametrize("arguments", [{"n": -1}, {"n": 1.5}, {"n": "3"}, {"seed": -1}, {"seed": "a"}, {"seed": 0.5}])
def test_samples_refuse_what_is_no_number(arguments):
    with pytest.raises(dp.ArgumentError, match="sample: "):
        robot("arm").sample(**arguments)
