"""Dual numbers as 2 x 2 matrices, and a test of whether a function of a dual number is analytic."""

from collections.abc import Callable

import numpy as np

import dualpin as dp


def matrix(x: dp.Dual) -> np.ndarray:
    """a + eps b as (a b; 0 a): sums, products and quotients of the matrices are those of the numbers."""
    return np.array([[x.real, x.dual], [0.0, x.real]])


def analytic(F: Callable[[dp.Dual], dp.Dual], x: float, dx: float, h: float = 1e-5) -> bool:
    """F = f + eps g is analytic at x + eps dx where df/d(dx) = 0 and df/dx = dg/d(dx)."""
    along, across = (
        (F(dp.Dual(x + i * h, dx + j * h)), F(dp.Dual(x - i * h, dx - j * h))) for i, j in ((1, 0), (0, 1))
    )
    df_dx = (along[0].real - along[1].real) / (2 * h)
    df_deps, dg_deps = ((across[0].real - across[1].real) / (2 * h), (across[0].dual - across[1].dual) / (2 * h))
    return bool(abs(df_deps) < 1e-8 and abs(df_dx - dg_deps) < 1e-8)


a, b = dp.Dual(2.3, -1.7), dp.Dual(0.8, 0.6)
print("product: ", np.allclose(matrix(a) @ matrix(b), matrix(a * b), rtol=0, atol=1e-15))
print("quotient:", np.allclose(matrix(a) @ np.linalg.inv(matrix(b)), matrix(a / b), rtol=0, atol=1e-15))
print("sin:     ", analytic(np.sin, 0.7, -1.2))
print("with an extra eps h(x):", analytic(lambda x: np.sin(x) + dp.Dual(0.0, float(x.real) ** 2), 0.7, -1.2))
print("parts exchanged:       ", analytic(lambda x: dp.Dual(x.dual, x.real), 0.7, -1.2))
