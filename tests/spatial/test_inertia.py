"""Maps from motions to forces, exactly: over fractions, without rounding."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from dualpin.errors import ShapeError
from dualpin.spatial import Connection, Inertia, Matrix3, Vector3, motor, power


def numbers(rng):
    return Vector3(*(Fraction(rng.randint(-99, 99), rng.randint(1, 9)) for _ in range(3)))


def body(rng):
    (xx, yy, zz), (xy, yz, zx) = numbers(rng), numbers(rng)
    return Inertia(numbers(rng).x, numbers(rng), Matrix3(Vector3(xx, xy, zx), Vector3(xy, yy, yz), Vector3(zx, yz, zz)))


def same(a, b):
    return all(x.real == y.real and x.dual == y.dual for x, y in zip(a, b, strict=True))


@pytest.mark.parametrize("seed", range(5))
def test_the_connection_is_its_definition(seed):
    rng = random.Random(seed)
    I, V, U, W = body(rng), *(motor(numbers(rng), numbers(rng)) for _ in range(3))
    B = Connection.of(I, V)
    assert same(B(U) * 2, V.cross(I(U)) + U.cross(I(V)) - I(V.cross(U)))
    assert power(W, B(U)) == power(U, B.transposed(W))
    assert same(Connection.of(I, V + W)(U), B(U) + Connection.of(I, W)(U))


@pytest.mark.parametrize("seed", range(3))
def test_power_is_the_dual_part_of_the_product(seed):
    rng = random.Random(seed)
    s, f = (motor(numbers(rng), numbers(rng)) for _ in range(2))
    assert power(s, f) == s.dot(f).dual


def test_power_of_batches_that_do_not_fit_says_so():
    ones, threes = (motor(*(Vector3(*([[1.0] * n] * 3)) for _ in range(2))) for n in (2, 3))
    with pytest.raises(ShapeError, match="shapes"):
        power(ones, threes)
