"""Identities of dual matrices on random cases: tall, wide, square, complex, batched.

Tolerance 1e-12 times the condition number of the real part: the identities hold to rounding, eps = 2e-16,
times the sizes of the products, which the condition number bounds.
"""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp

al = dp.algebra
SHAPES = [(4, 4), (5, 3), (3, 5), (1, 1), (6, 1), (1, 4), (7, 3, 3), (2, 3, 6, 4), (2, 3, 2, 5), (0, 3, 3)]
KINDS = ["real", "complex"]


def random(shape, kind, seed):
    rng = np.random.default_rng(seed)
    parts = [rng.standard_normal(shape) for _ in range(4)]
    return dp.Dual(parts[0] + 1j * parts[1], parts[2] + 1j * parts[3]) if kind == "complex" else dp.Dual(*parts[:2])


def small(x, A, power=1):
    """x vanishes, in both parts, relative to the condition of A."""
    size = np.linalg.cond(A.real).max(initial=1.0) ** power * max(1.0, np.abs(A.dual).max(initial=0.0))
    worst = max(np.abs(x.real).max(initial=0.0), np.abs(x.dual).max(initial=0.0))
    assert worst <= 1e-12 * size, (worst, size)


def eye(n):
    return np.eye(n)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", KINDS)
def test_qr_reconstructs_with_orthonormal_q_and_positive_triangular_r(shape, kind):
    A = random(shape, kind, 1)
    Q, R = al.qr(A)
    k = min(shape[-2:])
    assert Q.shape == (*shape[:-1], k)
    assert R.shape == (*shape[:-2], k, shape[-1])
    small(Q @ R - A, A)
    small(Q.H @ Q - eye(k), A)
    d = np.diagonal(R.real, axis1=-2, axis2=-1)
    assert (d.real > 0).all()
    assert np.abs(np.tril(R.real, -1)).max(initial=0) == 0 == np.abs(np.tril(R.dual, -1)).max(initial=0)
    assert np.abs(np.diagonal(R.dual, axis1=-2, axis2=-1).imag).max(initial=0) < 1e-12


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", KINDS)
def test_pinv_satisfies_the_four_penrose_conditions(shape, kind):
    A = random(shape, kind, 2)
    P = al.pinv(A)
    small(A @ P @ A - A, A, 2)
    small(P @ A @ P - P, A, 2)
    small((A @ P).H - A @ P, A, 2)
    small((P @ A).H - P @ A, A, 2)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", KINDS)
def test_svd_reconstructs_with_orthonormal_factors_and_descending_values(shape, kind):
    A = random(shape, kind, 3)
    U, S, Vh = al.svd(A)
    k = min(shape[-2:])
    small((U * S[..., None, :]) @ Vh - A, A, 2)
    small(U.H @ U - eye(k), A, 2)
    small(Vh @ Vh.H - eye(k), A, 2)
    assert (np.diff(S.real, axis=-1) < 0).all()
    assert S.dual.dtype.kind == "f"


@pytest.mark.parametrize("shape", [s for s in SHAPES if s[-1] == s[-2]])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("normalize", ["transpose", "unit"])
def test_eig_satisfies_its_equation_and_normalisation(shape, kind, normalize):
    A = random(shape, kind, 4)
    w, V = al.eig(A, normalize=normalize)
    scale = dp.Dual(V.real, 0 * V.real)
    small(A @ V - V * w[..., None, :], scale, 3)
    L = V.conj() if normalize == "unit" else V
    small((L * V).sum(axis=-2) - 1, scale, 3)
    e = al.eigvals(A)
    assert np.array_equal(e.real, w.real)
    assert np.array_equal(e.dual, w.dual)


@pytest.mark.parametrize("kind", KINDS)
def test_eigh_satisfies_its_equation(kind):
    A = random((8, 5, 5), kind, 5)
    A = A + A.H
    w, V = al.eigh(A)
    small(A @ V - V * w[..., None, :], A)
    small(V.H @ V - eye(5), A)
    assert (np.diff(w.real, axis=-1) > 0).all()


@pytest.mark.parametrize("shape", [s for s in SHAPES if s[-1] == s[-2]])
@pytest.mark.parametrize("kind", KINDS)
def test_inv_solve_and_det(shape, kind):
    A, b = random(shape, kind, 6), random((*shape[:-1], 2), kind, 7)
    small(A @ al.inv(A) - eye(shape[-1]), A, 2)
    small(A @ al.solve(A, b) - b, A, 2)
    if shape[0]:
        h = 1e-200j  # complex step: det is a polynomial, its dual part its derivative along A'
        if kind == "real":
            step = np.linalg.det(A.real + h * A.dual)
            assert np.allclose(al.det(A).dual, step.imag / 1e-200, rtol=1e-11)
        product = al.det(A @ A) - al.det(A) * al.det(A)
        small(product / (1 + np.abs(al.det(A).real) ** 2), A, 2)


def test_solve_takes_vectors_plain_arrays_and_lists_of_dual_numbers():
    A = dp.Dual([[4.0, 1.0], [2.0, 3.0]], [[1.0, 0.0], [-2.0, 5.0]])
    x = al.solve(A, [dp.Dual(1.0, 3.0), dp.Dual(2.0, -1.0)])
    assert np.allclose(x.dual, [1.25, -2.1])
    assert np.allclose(al.solve(A.real, np.array([1.0, 2.0])).dual, 0)
    assert np.allclose(np.linalg.solve(A, dp.Dual([1.0, 2.0], [3.0, -1.0])).dual, [1.25, -2.1])


@pytest.mark.parametrize("shape", [(6, 3), (3, 6), (4, 4), (5, 6, 2)])
def test_lstsq_solves_the_dual_normal_equations_with_least_norm(shape):
    A, b = random(shape, "real", 8), random((*shape[:-1], 2), "real", 9)
    x = al.lstsq(A, b)
    small(A.mT @ (A @ x - b), A, 3)
    small(x - al.pinv(A) @ b, A, 3)


def test_pinv_of_a_rank_deficient_matrix_exists_where_the_dual_part_keeps_the_rank():
    rng = np.random.default_rng(10)
    L = dp.Dual(*rng.standard_normal((2, 5, 2)))
    R = dp.Dual(*rng.standard_normal((2, 2, 4)))
    A = L @ R  # rank 2 in dual numbers too
    P = al.pinv(A)
    for defect in (A @ P @ A - A, P @ A @ P - P, (A @ P).T - A @ P, (P @ A).T - P @ A):
        assert max(np.abs(defect.real).max(), np.abs(defect.dual).max()) < 1e-12 * 100
    with pytest.raises(al.SingularError, match="rank 2 of 4"):
        al.pinv(A + dp.Dual(0.0, rng.standard_normal((5, 4))))


def test_det_of_singular_real_parts():
    A = dp.Dual([[1.0, 2.0], [2.0, 4.0]], [[0.5, 1.0], [3.0, -1.0]])
    # d(ad - bc) = a'd + a d' - b'c - b c'
    assert float(al.det(A).dual) == pytest.approx(0.5 * 4 - 1.0 - 1.0 * 2 - 2 * 3.0)
    assert abs(float(al.det(A).real)) < 1e-15


def test_norm_is_the_root_of_the_square():
    x = dp.Dual([3.0, 4.0], [1.0, -2.0])
    n = al.norm(x)
    assert (n * n).dual == pytest.approx(float((x * x).sum().dual))
    with pytest.raises(dp.DualDivisionError):
        al.norm(dp.Dual([0.0, 0.0], [1.0, 0.0]))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: al.inv(dp.Dual([[1, 2], [2, 4]], [[1, 0], [0, 1]])), "singular"),
        (lambda: al.solve(dp.Dual([[1.0, 2], [2, 4]], 0.0), [1.0, 2.0]), "singular"),
        (lambda: al.qr(dp.Dual([[1.0, 2], [2, 4]], 0.0)), "linearly dependent"),
        (lambda: al.svd(dp.Dual(np.eye(3), np.ones((3, 3)))), "repeated"),
        (lambda: al.svd(dp.Dual([[1.0, 2], [2, 4]], 1.0)), "full rank"),
        (lambda: al.eig(dp.Dual(np.eye(2), [[0, 1], [0, 0]])), "repeated"),
        (lambda: al.eig(dp.Dual([[1.0, 1.0], [0.0, 1.0]], np.ones((2, 2)))), "repeated"),
        (lambda: al.eigh(dp.Dual(np.eye(2), np.ones((2, 2)))), "repeated"),
        (lambda: al.pinv(dp.Dual([[1.0, 2], [2, 4]], [[1, 0], [0, 1]])), "rank"),
    ],
)
def test_failed_assumptions_are_named(call, words):
    with pytest.raises(al.AssumptionError, match=words) as e:
        call()
    assert isinstance(e.value, dp.DualpinError)


def test_the_index_of_the_singular_matrix_of_a_batch_is_said():
    A = np.stack([np.eye(2), np.zeros((2, 2)), np.eye(2)])
    with pytest.raises(al.SingularError, match=r"at index \(1,\)"):
        al.inv(A)


def test_isotropic_eigenvectors_are_announced_and_returned_unit():
    A = dp.Dual([[0.0, -1.0, 0], [1.0, 0.0, 0], [0, 0, 2.0]], [[1.0, 2.0, 0], [3.0, 4.0, 1], [0, 1, 1.0]])
    with pytest.warns(dp.DualpinWarning, match="isotropic"):
        w, V = al.eig(A)
    defect = A @ V - V * w[None]
    assert max(np.abs(defect.real).max(), np.abs(defect.dual).max()) < 1e-14


def test_ndarray_shape_errors_are_sentences():
    with pytest.raises(dp.ShapeError, match="square"):
        al.inv(np.ones((2, 3)))
    with pytest.raises(dp.ShapeError, match="rows"):
        al.solve(np.eye(3), np.ones(2))
    with pytest.raises(dp.ArgumentError):
        al.inv(np.array([["a", "b"], ["c", "d"]]))


@pytest.mark.parametrize("f", ["svd", "eig", "eigh", "eigvals", "pinv", "det"])
def test_entries_that_are_not_finite_are_named(f):
    A = np.eye(3)
    A[1, 2] = np.nan
    with pytest.raises(dp.ArgumentError, match=rf"{f}: A: finite entries expected, got nan at index \(1, 2\)"):
        getattr(dp.algebra, f)(dp.Dual(A, np.ones((3, 3))))
    with pytest.raises(dp.ArgumentError, match="polyroots: c: finite"):
        dp.algebra.polyroots([1.0, np.inf, 1.0])


def test_newton_wants_a_function():
    with pytest.raises(dp.ArgumentError, match="a function of x expected"):
        dp.algebra.newton(3.0, 1.0)
