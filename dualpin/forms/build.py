"""Robots from Denavit-Hartenberg tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ..arguments import choice, entries, is_symbol, numbers
from ..dual import Dual
from ..errors import ArgumentError, ShapeError, nearest
from ..model.builder import Builder
from ..model.joints import JointModel, cylindrical, helical, prismatic, revolute
from ..model.robot import STANDARD_GRAVITY, Limits, Mimic, Robot
from ..scalars import exact
from ..spatial.arrays import from_matrix
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import UX, UZ
from .chain import KINDS
from .table import CONVENTIONS, DHEnd, DHRow, DHStep, DHTable

NONE = Dual(0.0, 0.0)


def from_dh(
    rows: Any,
    joints: Any = None,
    convention: str | None = None,
    base: Any = None,
    tool: Any = None,
    inertias: Sequence[Mapping[str, Any] | None] | None = None,
    gravity: Sequence[float] = STANDARD_GRAVITY,
    *,
    limits: Sequence[tuple[float, float] | None] | None = None,
    name: str = "chain",
) -> Robot:
    """A robot from its Denavit-Hartenberg rows.

        standard:  row_i = Rz(theta + q) Tz(d) Tx(a) Rx(alpha);    modified:  Rx(alpha) Tx(a) Rz(theta + q) Tz(d)

    Parameters
    ----------
    rows : array_like, shape (n, 4), or sequence of DHRow, or DHTable
        theta, d, a, alpha in rad and m; here and below numbers, or SymPy's symbols and formulas.
        Modified rows carry the a and alpha before the joint (Craig).
        Rows of a table that share a coordinate become joints that follow the first of them (mimic).
    joints : str or sequence
        One for each row: "R" (q adds to theta), "P" (to d), "C" (angle to theta, slide to d, in
        this order), ("H", pitch) (q to theta, pitch * q to d; pitch in m/rad), "F" (fixed row).
        "RRPC" is short for ["R", "R", "P", "C"].  By default all "R", or those of a DHTable.
    convention : "standard" or "modified"
        Standard by default, or that of a DHTable.
    base, tool : (4, 4) array_like, Pose, DHEnd, DHStep, Dual or (Dual, Dual), optional
        Pose of frame 0 in the base link, and of the tool in frame n.  Dual angles are
        theta + eps d about z, and alpha + eps a about x, in the order of the convention.
    inertias : sequence of dict(mass=, com=(3,), inertia=(3, 3)) or None, optional
        For each row, in kg, m, kg m^2: centre of mass, and inertia about it, in the DH frame of the
        link, at its distal end (standard) or its own (modified).
    gravity : (3,) in the base frame [m/s^2]
    limits : sequence of (lower, upper) or None, optional
        For each row, of its first coordinate.
    name : str
        Of the robot.

    Returns
    -------
    Robot
        Joints "joint_1", ..., links "base_link", "link_1", ... (standard rows also get frames
        "frame_1", ... at the distal ends) and last of all frames the tip, "tool".

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Denavit & Hartenberg (1955); Craig (1986).

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> arm = dp.from_dh([(0, 0, 0.5, 0), (0, 0, 0.4, 0)], joints="RR", convention="standard")
    >>> dp.fk(arm, [0.0, np.pi / 2], frame="tool")[:3, 3].round(12).tolist()
    [0.5, 0.4, 0.0]
    """
    couplings: list[Mimic | None] = []
    notes: list[str] = []
    if isinstance(rows, DHTable):
        if joints is None:
            couplings, notes = _couplings(rows)
        joints = rows.joints if joints is None else joints
        convention = convention or rows.convention
        base, tool = rows.base if base is None else base, rows.tool if tool is None else tool
        rows = rows.rows
    convention = choice("from_dh: convention", "standard" if convention is None else convention, CONVENTIONS)
    values = _values(rows)
    kinds = _kinds(joints, len(values))
    table_rows, at = [], 0
    for (theta, d, a, alpha), (kind, pitch) in zip(values, kinds, strict=True):
        nq = {"F": 0, "C": 2}.get(kind, 1)
        q = tuple(range(at, at + nq))
        table_rows.append(DHRow(Dual(theta, d), Dual(alpha, a), convention, kind, None, q, (1.0,) * nq, pitch))
        at += nq
    first = DHTable(tuple(table_rows), DHEnd(), DHEnd(), convention, name)
    return assembled(
        first, _end("base", base, convention), _end("tool", tool, convention),
        _bodies(inertias, len(values)), _bounds(limits, kinds), gravity, couplings, notes,
    )  # fmt: skip


def _couplings(table: DHTable) -> tuple[list[Mimic | None], list[str]]:
    """What rows of one coordinate become: joints that follow the first of them; and what is lost."""
    leaders: dict[int, tuple[str, float]] = {}
    found: list[Mimic | None] = []
    notes = []
    for i, row in enumerate(table.rows, 1):
        name = f"joint_{i}"
        if len(row.q) != 1:
            found.append(None)
            continue
        (q,), (factor,) = row.q, row.factors
        leader, ratio = leaders.setdefault(q, (name, factor))
        if leader == name:
            found.append(None)
            if factor != 1.0:
                notes.append(
                    f"{name} ({row.joint}) followed a joint that is not in the table, with multiplier {factor:g}; "
                    "it is free here"
                )
        else:
            found.append(Mimic(leader, factor / ratio))
    return found, notes


def _values(rows: Any) -> list[list[float]]:
    if isinstance(rows, (list, tuple)) and rows and all(isinstance(r, DHStep) for r in rows):
        return [[r.theta, r.d, r.a, r.alpha] for r in rows]
    x = entries(
        "from_dh: rows", rows if not isinstance(rows, Iterable) or isinstance(rows, (str, np.ndarray)) else list(rows)
    )
    if x.ndim != 2 or x.shape[1] != 4:
        raise ShapeError(f"from_dh: rows of shape (n, 4) expected, theta, d, a, alpha each; got {x.shape}")
    wrong = np.argwhere(~_finite(x))
    if len(wrong):
        i, j = wrong[0]
        raise ArgumentError(
            f"from_dh: {('theta', 'd', 'a', 'alpha')[j]} of row {i + 1} is {x[i, j]}; a finite number expected"
        )
    return x.tolist()


def _kinds(joints: Any, n: int) -> list[tuple[str, Any]]:
    if not isinstance(joints, Iterable | None):
        raise ArgumentError(f"from_dh: joints: letters of R P C H F expected, one a row, got {joints!r}")
    entries = ["R"] * n if joints is None else list(joints)
    if len(entries) != n:
        raise ArgumentError(
            f"from_dh: {n} rows but {len(entries)} joints ({joints!r}); one letter of R P C H F a row expected"
        )
    kinds = []
    for i, entry in enumerate(entries):
        letter, pitch = entry if isinstance(entry, (tuple, list)) and len(entry) == 2 else (entry, None)
        letter = letter.upper() if isinstance(letter, str) else ""
        if letter not in KINDS:
            known = ", ".join(f"{k} ({v})" for k, v in KINDS.items())
            raise ArgumentError(f"from_dh: joint {i + 1} is {entry!r}; one of {known} expected")
        if letter == "H" and not (is_symbol(pitch) or (isinstance(pitch, (int, float)) and np.isfinite(pitch))):
            raise ArgumentError(
                f"from_dh: joint {i + 1} is helical and needs its pitch in m/rad: ('H', pitch); got {entry!r}"
            )
        if letter != "H" and pitch is not None:
            raise ArgumentError(f"from_dh: joint {i + 1} is {entry!r}; only a helical joint has a pitch")
        kinds.append((letter, pitch if is_symbol(pitch) else float(pitch or 0.0)))
    return kinds


def _end(what: str, value: Any, convention: str) -> Pose:
    if value is None:
        return IDENTITY_POSE
    if isinstance(value, Pose):
        return value
    if isinstance(value, Dual):
        value = DHStep(value, NONE, convention)
    if isinstance(value, tuple) and len(value) == 2 and all(isinstance(v, Dual) for v in value):
        value = DHStep(*value, convention)
    return value.pose if isinstance(value, (DHEnd, DHStep)) else homogeneous(f"from_dh: {what}", value)


def homogeneous(what: str, value: Any) -> Pose:
    """The pose of a homogeneous matrix, checked to be one."""
    T = entries(what, value)
    if T.shape != (4, 4):
        raise ShapeError(f"{what} of shape (4, 4) expected, a homogeneous matrix; got {T.shape}")
    if not _finite(T).all():
        raise ArgumentError(f"{what}: finite numbers expected, got {T[~_finite(T)][0]}")
    if T.dtype == object:
        return Pose.from_rows(T.tolist()).snapped
    try:
        from_matrix(T)
    except ArgumentError as e:
        raise ArgumentError(str(e).replace("from_matrix", what)) from None
    return Pose.from_matrix(T)


KEYS = ("mass", "com", "inertia")


def _bodies(inertias: Any, n: int) -> list[Inertia | None]:
    if inertias is None:
        return [None] * n
    if len(inertias) != n:
        raise ArgumentError(
            f"from_dh: {n} rows but {len(inertias)} inertias; one for each row expected (None: no mass)"
        )
    return [None if given is None else _body(f"from_dh: inertias[{i}]", given) for i, given in enumerate(inertias)]


def _body(what: str, given: Any) -> Inertia:
    """The inertia about the DH frame, from mass, centre and inertia about the centre."""
    if not isinstance(given, Mapping):
        raise ArgumentError(f"{what}: dict(mass=, com=, inertia=) expected, got {type(given).__name__}")
    for key in given:
        if key not in KEYS:
            raise ArgumentError(f"{what} has the key {key!r}; {nearest(key, KEYS, 'keys')}")
    if "mass" not in given:
        raise ArgumentError(f"{what} has no mass")
    mass, com, J = (
        entries(f"{what}: {key}", given.get(key, np.zeros(shape)))
        for key, shape in zip(KEYS, ((), (3,), (3, 3)), strict=True)
    )
    for key, x, shape in zip(KEYS, (mass, com, J), ((), (3,), (3, 3)), strict=True):
        if x.shape != shape:
            raise ShapeError(f"{what}: {key} of shape {shape} expected, got {x.shape}")
        if not _finite(x).all():
            raise ArgumentError(
                f"{what}: {key}: finite numbers expected, got {x[~_finite(x)].flat[0] if x.ndim else x}"
            )
    m = mass.item()
    if m.is_negative if is_symbol(m) else mass < 0:
        raise ArgumentError(f"{what}: mass is {m if is_symbol(m) else format(m, 'g')} kg; zero or more expected")
    off = J - J.T
    if J.dtype == object:
        if any(x != 0 for x in off.flat):
            raise ArgumentError(f"{what}: inertia is not symmetric: J - J^T is {off.tolist()}")
        return Inertia.of(mass.item(), com.tolist(), J.tolist())
    # entries printed to six digits may differ in the last
    if np.abs(off).max() > 1e-6 * max(np.abs(J).max(), 1e-300):
        raise ArgumentError(
            f"{what}: inertia is not symmetric, J[i, j] and J[j, i] differ by up to {np.abs(off).max():.3g}"
        )
    return Inertia.of(mass.item(), com.tolist(), ((J + J.T) / 2).tolist())


def _finite(x: np.ndarray) -> np.ndarray:
    """Which entries are finite numbers, or symbols."""
    if x.dtype != object:
        return np.isfinite(x)
    return np.array([is_symbol(e) or bool(np.isfinite(e)) for e in x.flat]).reshape(x.shape)


def _bounds(limits: Any, kinds: list[tuple[str, Any]]) -> list[Limits]:
    if limits is None:
        return [Limits()] * len(kinds)
    if len(limits) != len(kinds):
        raise ArgumentError(
            f"from_dh: {len(kinds)} rows but {len(limits)} limits; one for each row expected (None: free)"
        )
    bounds = []
    for i, (pair, (kind, _)) in enumerate(zip(limits, kinds, strict=True)):
        if pair is None or kind == "F":
            bounds.append(Limits())
            continue
        x = numbers(f"from_dh: limits[{i}]", pair)
        if x.shape != (2,) or not x[0] <= x[1]:
            raise ArgumentError(f"from_dh: limits[{i}] is {pair!r}; (lower, upper) expected")
        more = (np.inf,) if kind == "C" else ()
        bounds.append(Limits((float(x[0]), *(-m for m in more)), (float(x[1]), *more)))
    return bounds


def model(kind: str, pitch: float = 0.0) -> JointModel:
    """The joint about z that a letter stands for."""
    if kind == "H":
        return helical(pitch=exact(pitch))
    return {"R": revolute, "P": prismatic, "C": cylindrical}[kind]()


def assembled(
    table: DHTable,
    base: Pose | None = None,
    tool: Pose | None = None,
    bodies: Sequence[Inertia | None] | None = None,
    limits: Sequence[Limits] | None = None,
    gravity: Sequence[float] = STANDARD_GRAVITY,
    couplings: Sequence[Mimic | None] = (),
    notes: Sequence[str] = (),
) -> Robot:
    """The robot of a table, every row on the DH frame of the one before.

    Joint i moves link i at Z_i; a standard row then fixes its distal DH frame, "frame_i", at X_i.
    """
    n, standard = len(table.rows), table.convention == "standard"
    bodies, limits = bodies or [None] * n, limits or [Limits()] * n
    couplings = couplings or [None] * n
    b = Builder(table.name, gravity)
    b.notes += notes
    b.base("base_link")
    on, start = "base_link", table.base.pose if base is None else base
    for i, (row, body, bound, mimic) in enumerate(zip(table.rows, bodies, limits, couplings, strict=True), 1):
        Z, X = Pose.about(UZ, row.theta_hat), Pose.about(UX, row.alpha_hat)
        place, far = ((start @ Z).snapped, X.snapped) if standard else ((start @ X @ Z).snapped, IDENTITY_POSE)
        inertia = None if body is None else far @ body
        if row.letter == "F":
            b.fixed(f"fixed_{i}", on, place, inertia, link=f"link_{i}")
        else:
            kind = model(row.letter, row.pitch)
            b.joint(f"joint_{i}", kind, on, place, inertia, link=f"link_{i}", limits=bound, mimic=mimic)
        on, start = f"link_{i}", IDENTITY_POSE
        if standard:
            b.fixed(f"frame_{i}_joint", on, far, link=f"frame_{i}")
            on = f"frame_{i}"
    b.fixed("tool_joint", on, (start @ (table.tool.pose if tool is None else tool)).snapped, link="tool")
    return b.robot()


__all__ = ["assembled", "from_dh", "homogeneous", "model"]
