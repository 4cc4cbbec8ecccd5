"""The RCCC linkage: golden positions, the tables of the paper, spurious roots, sweeps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import dualpin as dp
from tests.golden import REFERENCE, close, dual

GOLD = REFERENCE["rccc"]
LINKAGE = dp.mechanisms.RCCC(dual(GOLD["cases"][0]["alpha_a"]))
INPUT = np.radians(40)


@pytest.mark.parametrize("case", GOLD["cases"], ids=lambda c: c["name"])
def test_golden_positions(case):
    linkage = dp.mechanisms.RCCC(dual(case["alpha_a"]))
    found = linkage.solve(dual(case["theta1"]))
    assert len(found) == len(case["solutions"])
    for p, want in zip(found, case["solutions"], strict=True):
        for name in ("theta2", "theta3", "theta4"):
            close(getattr(p, name), dual(want[name]))
        assert p.closure < 1e-13


def test_dimensions_as_pairs_duals_or_an_array():
    a = LINKAGE.alpha
    for alpha in (a, list(a), [(x.real, x.dual) for x in a]):
        assert np.all(dp.mechanisms.RCCC(alpha).alpha == a)
    with pytest.raises(dp.ShapeError, match="4 dual angles"):
        dp.mechanisms.RCCC([1.0, 2.0])


def test_coefficients_and_table_5_the_iterates_of_method_a():
    for got, name in zip(LINKAGE.coefficients(INPUT), "ABC", strict=True):
        close(got, dual(GOLD[name]))
    first = dual(GOLD["newton"][0]["theta4"])
    run = LINKAGE.method_a(INPUT, first)
    for k, want in enumerate(GOLD["newton"]):
        close(run.iterates[k], dual(want["theta4"]))
        if k < len(run.values):
            close(run.values[k], dual(want["F"]), 1e-14)


def test_method_b_has_roots_that_do_not_close_the_loop():
    want = {k: dp.Dual(*map(float, v)) for k, v in GOLD["spurious_root_of_eq64"].items() if k != "note"}
    start = [np.radians(100), np.radians(100), want["theta4"]]
    run = LINKAGE.method_b(INPUT, start, check=False)
    for name in ("theta2", "theta3", "theta4"):
        close(getattr(run.position, name), want[name], 1e-6)  # printed to 8 digits
    assert run.position.closure > 1
    with pytest.raises(dp.algebra.AssumptionError, match="leaves the loop open"):
        LINKAGE.method_b(INPUT, start)


def test_method_b_finds_the_position_from_nearby():
    p = LINKAGE.solve(INPUT)[1]
    start = [dp.Dual(t.real + 1e-3, t.dual) for t in (p.theta2, p.theta3, p.theta4)]
    q = LINKAGE.method_b(INPUT, start).position
    close(q.theta3, p.theta3, 1e-12)
    assert q.closure < 1e-12


@pytest.mark.parametrize("variant", ["C1", "C1-listing", "C2", "C3", "C4"])
def test_method_c_in_all_variants(variant):
    run = LINKAGE.method_c(INPUT, variant=variant, tol=1e-12)
    want = LINKAGE.solve(INPUT)[1]
    for name in ("theta2", "theta3", "theta4"):
        close(getattr(run.position, name), getattr(want, name), 1e-12)


def test_the_stale_correction_of_the_listing_costs_two_iterations_a_degree():
    degrees = np.radians(np.arange(0, 61))
    _, right = LINKAGE.sweep_by_iteration(degrees, variant="C1")
    _, listing = LINKAGE.sweep_by_iteration(degrees, variant="C1-listing")
    assert np.mean(right[1:]) == pytest.approx(3.0, abs=0.1)
    assert np.mean(listing[1:]) == pytest.approx(5.0, abs=0.1)


def test_sweep_is_the_closed_form_at_every_angle():
    theta = np.radians(np.arange(361.0))
    both = LINKAGE.sweep(theta)
    assert both.shape == (361, 2, 3)
    assert np.isfinite(both.real).all()
    for i in (0, 40, 90, 271):
        found = {round(float(p.theta4.real), 9): p for p in LINKAGE.solve(theta[i])}
        for branch in both[i]:
            p = found[round(float(branch[2].real), 9)]
            close(branch, np.stack([p.theta2, p.theta3, p.theta4]), 1e-12)
    t1 = dp.Dual(np.broadcast_to(theta[:, None], (361, 2)), np.zeros((361, 2)))
    defect = LINKAGE.closure([t1, both[..., 0], both[..., 1], both[..., 2]])
    assert max(np.abs(defect.real).max(), np.abs(defect.dual).max()) < 1e-12
    positions, _ = LINKAGE.sweep_by_iteration(theta)
    close(np.stack([p.theta4 for p in positions]), both[:, 0, 2], 1e-10)


angle = st.floats(0.2, 2.9)
length = st.floats(-5, 5)


@settings(max_examples=80, deadline=None)
@given(st.lists(st.tuples(angle, length), min_size=4, max_size=4), st.floats(-7, 7), length)
def test_every_position_of_any_linkage_closes_the_loop(alpha, theta1, s1):
    linkage = dp.mechanisms.RCCC(alpha)
    t1 = dp.Dual(theta1, s1)
    A, B, C = linkage.coefficients(t1)
    size = np.hypot(float(A.real), float(B.real))
    assume(size > 1e-3)
    cosine = abs(float(C.real)) / size
    assume(abs(cosine - 1) > 1e-3)
    found = linkage.solve(t1)
    assert len(found) == (2 if cosine < 1 else 0)
    for p in found:
        assert p.closure < 1e-8  # 1e-16 / (distance from the dead centre)^2 times lengths
        N = linkage._left(t1, p.theta4).rows
        assume(abs(abs(float(N[2].z.real)) - 1) > 1e-6)


def test_dead_centres_and_impossible_positions():
    flat = dp.mechanisms.RCCC([(0.3, 1.0), (0.2, 1.0), (0.3, 1.0), (1.5, 1.0)])
    assert flat.solve(0.0) == []
    assert np.isnan(flat.sweep([0.0]).real).all()
    with pytest.raises(dp.DualDivisionError):
        dp.mechanisms.RCCC([(0.3, 1.0), (0.2, 1.0), (0.0, 1.0), (1.5, 1.0)]).solve(0.4)
    with pytest.raises(dp.ArgumentError, match="C9"):
        LINKAGE.method_c(INPUT, variant="C9")


@pytest.mark.parametrize("angle", ["a", None, np.nan])
def test_input_angles_that_are_no_numbers_are_refused(angle):
    linkage = dp.mechanisms.RCCC(dp.Dual([0.5, 1.0, 0.8, 1.0], [2.0, 4.0, 3.0, 5.0]))
    with pytest.raises(dp.DualpinError, match="theta"):
        linkage.solve(angle)


@pytest.mark.parametrize("links", [None, 3.0, dp.Dual([np.nan, 1.0, 1.0, 1.0], 0.0)])
def test_links_that_are_no_dual_angles_are_refused(links):
    with pytest.raises(dp.DualpinError, match="alpha_hat"):
        dp.mechanisms.RCCC(links)
