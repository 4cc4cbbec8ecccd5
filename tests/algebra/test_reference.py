"""The golden values of dual linear algebra, to 1e-12."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from tests.golden import REFERENCE, aligned, close, dual

al = dp.algebra


@pytest.mark.parametrize("case", REFERENCE["qr"], ids=lambda c: c["name"])
def test_qr(case):
    Q, R = al.qr(dual(case["A"]))
    close(Q, dual(case["Q"]))
    close(R, dual(case["R"]))


@pytest.mark.parametrize("case", REFERENCE["pinv"], ids=lambda c: c["name"])
def test_pinv_and_the_simple_inverse_of_eq_33(case):
    A = dual(case["A"])
    close(al.pinv(A), dual(case["pinv"]))
    close(al.pinv_simple(A), dual(case["pinv_eq33_of_paper002"]))
    S = A @ al.pinv_simple(A) if A.shape[0] > A.shape[1] else al.pinv_simple(A) @ A
    assert float(np.linalg.norm((S - S.T).dual)) == pytest.approx(float(case["eq33_symmetry_defect"]), rel=0.5)


@pytest.mark.parametrize("case", REFERENCE["svd"], ids=lambda c: c["name"])
def test_svd(case):
    U, S, Vh = al.svd(dual(case["A"]))
    close(S, dual(case["sigma"]))
    close(U, dual(case["U_thin"]))
    close(Vh.T, dual(case["V_thin"]))


@pytest.mark.parametrize("case", REFERENCE["eig"], ids=lambda c: c["name"])
def test_eig(case):
    w, V = al.eig(dual(case["A"]))
    close(w, dual([p["lam"] for p in case["pairs"]]))
    want = dual([p["v"] for p in case["pairs"]]).T
    close(aligned(V, want), want)


def test_solve():
    for case in REFERENCE["linsolve"]:
        close(al.solve(dual(case["A"]), dual(case["b"])), dual(case["x"]))


def test_lstsq():
    for case in REFERENCE["lstsq"]:
        A, b = dual(case["A"]), dual(case["b"])
        x = al.lstsq(A, b)
        close(x, dual(case["x"]))
        close(A @ x - b, dual(case["residual"]))


def test_inv():
    for case in REFERENCE["inverse"]:
        close(al.inv(dual(case["A"])), dual(case["inv"]))
