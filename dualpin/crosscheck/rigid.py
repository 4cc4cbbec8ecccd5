"""Poses, twists and momenta as matrices of mpmath numbers, used by `definitions`.

Arrays are on the left of numbers in products: otherwise mpmath first tries to convert the array to a number, which
takes longer than the product.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..model.robot import Joint
from ..scalars import Exact

Array = np.ndarray  # of mpmath numbers


def number(mp: Any, x: Any) -> Any:
    return mp.mpf(x.n) if isinstance(x, Exact) else mp.mpf(x)


def exact(mp: Any, values: Any) -> Array:
    """An array of mpmath numbers."""
    x = np.asarray(values, dtype=object)
    return np.array([number(mp, y) for y in x.ravel()], dtype=object).reshape(x.shape)


def pose(mp: Any, X: Any) -> Array:
    return exact(mp, [[number(mp, x) for x in row] for row in X.rows])


def six(mp: Any, m: Any) -> Array:
    """[w; v] of a motor."""
    return exact(mp, [number(mp, x) for x in (*m.real, *m.dual)])


def matrix(mp: Any, R: Array, p: Sequence[Any] | Array) -> Array:
    T = exact(mp, np.eye(4).astype(int))
    T[:3, :3], T[:3, 3] = R, p
    return T


def skew(w: Array) -> Array:
    x, y, z = w
    return np.array([[0 * x, -z, y], [z, 0 * x, -x], [-y, x, 0 * x]], dtype=object)


def turn(mp: Any, axis: Array, c: Any, s: Any) -> Array:
    """Rodrigues: the rotation about a unit axis by the angle of cosine c and sine s."""
    K = skew(axis)
    return exact(mp, np.eye(3).astype(int)) + K * s + K @ K * (1 - c)


def displacement(mp: Any, joint: Joint, q: Array) -> Array:
    """The 4x4 matrix of a joint at its coordinates, by what they are: angles, lengths, a quaternion."""
    model = joint.model
    axis = getattr(model, "axis", None)
    if axis is not None:
        axis = exact(mp, [number(mp, x) for x in axis])
        angle, slide = number(mp, model.offset.real), number(mp, model.offset.dual)  # type: ignore[attr-defined]
        for u, x in zip(model.units, q, strict=True):  # type: ignore[attr-defined]
            angle, slide = angle + number(mp, u.real) * x, slide + number(mp, u.dual) * x
        return matrix(mp, turn(mp, axis, mp.cos(angle), mp.sin(angle)), axis * slide)
    by = {kind: [x for k, x in zip(model.coordinates, q, strict=True) if k == kind] for kind in set(model.coordinates)}
    p = [*by.get("length", []), mp.mpf(0), mp.mpf(0), mp.mpf(0)][:3]
    z = exact(mp, [0, 0, 1])
    if "quaternion" in by:
        x = np.array(by["quaternion"], dtype=object)
        x = x / mp.sqrt(x @ x)
        K = skew(x[1:])
        R = exact(mp, np.eye(3).astype(int)) + K * (2 * x[0]) + K @ K * 2
    else:
        (angle,) = by["angle"]
        R = turn(mp, z, mp.cos(angle), mp.sin(angle))
    return matrix(mp, R, p)


def small_motion(mp: Any, twist: Array) -> Array:
    """exp of a twist [w; v] of the size of STEP, to the third order; [w]^2 = w w^T - w.w, and [w]^3 = -w.w [w]."""
    w, v = np.split(twist, 2)
    ww = w @ w
    R = skew(w) * (1 - ww / 6) + np.outer(w, w) / 2
    R[range(3), range(3)] += 1 - ww / 2
    return matrix(mp, R, v + cross(w, v + cross(w, v) / 3) / 2)


def product(A: Array, B: Array) -> Array:
    """One displacement after another: their last rows are known."""
    C = A.copy()
    C[:3] = A[:3, :3] @ B[:3]
    C[:3, 3] += A[:3, 3]
    return C


def cross(a: Array, b: Array) -> Array:
    """The vector product, also of columns; NumPy's takes several times as long for numbers that are objects."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], dtype=object)


def inverse(T: Array) -> Array:
    R = T.copy()
    R[:3, :3], R[:3, 3] = T[:3, :3].T, -(T[:3, :3].T @ T[:3, 3])
    return R


def logarithm(mp: Any, T: Array) -> Array:
    """The twist [w; v] whose exponential is T, of an angle below pi."""
    R = T[:3, :3]
    w = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]], dtype=object) / 2
    s, c = mp.sqrt(w @ w), (R[0, 0] + R[1, 1] + R[2, 2] - 1) / 2
    angle = mp.atan2(s, c)
    if angle == 0:
        return np.concatenate([w, T[:3, 3]])
    w = w * (angle / s)
    K = skew(w)
    k = (1 - angle * s / (2 * (1 - c))) / angle**2
    inverse = exact(mp, np.eye(3).astype(int)) - K / 2 + K @ K * k
    return np.concatenate([w, inverse @ T[:3, 3]])


def carried(T: Array, s: Array) -> Array:
    """A twist of the frame T, about the world's origin."""
    w = T[:3, :3] @ s[:3]
    return np.concatenate([w, T[:3, :3] @ s[3:] + cross(T[:3, 3], w)])


def carried_wrench(T: Array, wrench: Array) -> Array:
    """[n; f] in the frame T, about the world's origin."""
    f = T[:3, :3] @ wrench[3:]
    return np.concatenate([T[:3, :3] @ wrench[:3] + cross(T[:3, 3], f), f])


def seen(T: Array, twist: Array, reference: str) -> Array:
    """A world twist as one sees it from the frame T."""
    if reference == "world":
        return twist
    v = twist[3:] - cross(T[:3, 3], twist[:3])
    parts = twist[:3], v
    return np.concatenate(parts if reference == "local_world_aligned" else [T[:3, :3].T @ x for x in parts])


def tensor(body: Array) -> Array:
    _, _, _, _, xx, xy, yy, xz, yz, zz = body
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=object)


def momentum(T: Array, twist: Array, body: Array) -> Array:
    """[l0; p] of a body of ten parameters about its own origin; of twists that are columns, columns."""
    R, p = T[:3, :3], T[:3, 3:]
    w, v = np.split(twist.reshape(6, -1), 2)
    v = v + cross(w, p)  # of its origin
    h = R @ body[1:4, None]
    P = v * body[0] + cross(w, h)
    return np.concatenate([cross(h, v) + R @ (tensor(body) @ (R.T @ w)) + cross(p, P), P]).reshape(twist.shape)


def weight(T: Array, body: Array, field: Array) -> Array:
    """[n0; f] of gravity."""
    return np.concatenate([cross(T[:3, 3] * body[0] + T[:3, :3] @ body[1:4], field), field * body[0]])


def factors(M: Array, least: Any) -> Array:
    """L and D of M = L^T D L, D on the diagonal: elimination from the last unknown to the first.

    In this order the matrix of a tree of bodies keeps its zeros.

    Raises
    ------
    ZeroDivisionError
        If what is left of a diagonal entry is not more than so large a part of it: M is singular.
    """
    A, smallest = M.copy(), np.diag(M) * least
    for k in reversed(range(len(A))):
        if not A[k, k] > smallest[k]:
            raise ZeroDivisionError("the matrix is singular")
        for i in reversed(range(k)):
            if A[k, i]:
                f = A[k, i] / A[k, k]
                A[i, : i + 1] -= A[k, : i + 1] * f
                A[k, i] = f
    return A


def solution(A: Array, b: Array) -> Array:
    """x of L^T D L x = b, given the `factors`."""
    x = b.copy()
    for k in reversed(range(len(x))):
        x[:k] -= A[k, :k] * x[k]
    for k in range(len(x)):
        x[k] = x[k] / A[k, k] - A[k, :k] @ x[:k]
    return x
