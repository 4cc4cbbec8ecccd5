"""Robot to Denavit-Hartenberg table, exactly."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

from ..arguments import choice, real
from ..dual import Dual
from ..errors import ArgumentError, DualpinWarning
from ..model.robot import Frame, Robot
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import UZ, ZERO_VECTOR, motor
from .align import CLEAN, NEAR, NONE, PARALLEL, Rules, ahead, numeric, remaining, step
from .chain import Axis, Chain, chain
from .khalil import KhalilTable, khalil_table
from .table import CONVENTIONS, DHEnd, DHRow, DHStep, DHTable

TREE = "khalil-kleinfinger"


def to_dh(
    robot: Robot,
    base: str | Frame | None = None,
    tip: str | Frame | None = None,
    convention: str = "standard",
    *,
    snap: float | tuple[float, float] | None = None,
    near_parallel: float = NEAR,
) -> Any:
    """Denavit-Hartenberg parameters of a serial chain, exactly as the robot has it.

        T(q) = base * prod_i Z(theta_i + eps d_i + q_i) X(alpha_i + eps a_i) * tool        (standard)
        T(q) = base * prod_i X(alpha_{i-1} + eps a_{i-1}) Z(theta_i + eps d_i + q_i) * tool (modified)

    Joint directions are kept, so a joint's coordinate enters with the sign it has in the robot.

    Parameters
    ----------
    robot : Robot
    base, tip : str or Frame, optional
        Links (or frames) between which the chain runs, by default from the root to the only leaf.
        The tip need not be below the base: joints are passed in either direction.
    convention : "standard", "modified" or "khalil-kleinfinger"
        The last gives a `KhalilTable` of the whole tree, and takes no base and tip.
    snap : float or (float, float), optional
        Asked for only: angles within `snap` of a multiple of 90 degrees (and lengths within the
        second number of 0) are rounded off.  The deviation it costs is measured and warned of.
    near_parallel : float
        Sine of the angle between consecutive axes below which a fixed row is inserted (Hayati's
        extra rotation written as a row).  With 0 none is, and d may become very large.

    Returns
    -------
    DHTable
        With ``.rows`` (each ``.theta .d .a .alpha`` in rad and m), ``.base``, ``.tool``, ``.fk(q)``,
        ``.residual``, ``.table()`` and exports.

    Raises
    ------
    FrameNotFoundError
        For unknown links, with the nearest names.
    ArgumentError
        If the robot branches and no tip is given, a floating joint is in the chain, or an argument
        is not valid.

    Notes
    -----
    The parameters are dual spherical coordinates of each axis in the frame of the one before.
    Where they are free: parallel axes get d = 0 (the last pair: the offset goes into d_n),
    coincident ones keep the direction of x, prismatic axes pass through the previous origin, and of
    the two directions of x the one with the smaller abs(theta) is taken, on a tie the one with a > 0.

    References
    ----------
    Denavit & Hartenberg (1955); Craig (1986); Hayati & Mirmirani (1985); Khalil & Kleinfinger (1986).

    Examples
    --------
    >>> import dualpin as dp
    >>> dh = dp.to_dh(dp.load("ur5"), base="base", tip="tool0")
    >>> [round(row.d, 6) for row in dh.rows]
    [0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823]
    >>> dh.residual < 1e-14
    True
    """
    choice("to_dh: convention", convention, (*CONVENTIONS, TREE))
    rules = _rules(snap, near_parallel)
    if convention == TREE:
        if base is not None or tip is not None:
            raise ArgumentError(f"to_dh: {TREE} describes the whole tree; base and tip are not taken")
        return _tree(robot, rules, snap is not None)
    links = chain(robot, base, tip, "to_dh")
    table = _paired(links, *_alternating(links, rules, convention), convention)
    return _offering(table, near_parallel) if snap is None else _announced(table, snap)


def _rules(snap: float | tuple[float, float] | None, near: float) -> Rules:
    angle, length = snap if isinstance(snap, tuple) else (snap, None)
    for what, x, most in (("snap", angle, 0.1), ("snap", length, 1.0), ("near_parallel", near, 0.5)):
        if x is not None:
            real(f"to_dh: {what}", x, least=0.0, most=most)
    return Rules(near, max(PARALLEL, angle or 0.0), max(CLEAN, angle or 0.0), max(CLEAN, length or 0.0))


def _tree(robot: Robot, rules: Rules, snapped: bool) -> KhalilTable:
    if snapped:
        raise ArgumentError(f"to_dh: snap is for chains; {TREE} is exact only")
    return khalil_table(robot, rules)


def _alternating(links: Chain, rules: Rules, convention: str) -> tuple[list[tuple[Dual, Axis | None]], list[Dual]]:
    """Z_0 X_0 Z_1 X_1 ... Z_{n+1}: the z screws with their axes (None: fixed), and the x screws."""
    here, axis = IDENTITY_POSE, None
    z: list[tuple[Dual, Axis | None]] = []
    x: list[Dual] = []
    for following in (*links.axes, None):
        if following is None:
            rest = here.inverse @ links.home
            steps = step(rest @ motor(UZ, ZERO_VECTOR), rules, rest)
        else:
            steps = step(ahead(following, here), rules)
        for theta, alpha in steps:
            here = numeric(here @ Pose.dh(theta, alpha))
            z.append((theta, axis))
            x.append(alpha)
            axis = None
        if convention == "modified" and len(z) == len(steps) > 1:  # the base, not the first row, takes it all
            z.append((NONE, None))
            x.append(NONE)
        axis = following
    z.append((remaining(here.inverse @ links.home, rules), None))
    return z, x


def row(theta: Dual, alpha: Dual, axis: Axis | None, convention: str) -> DHRow:
    """A row about an axis, or a fixed one."""
    if axis is None:
        return DHRow(theta, alpha, convention, letter="F")
    return DHRow(theta, alpha, convention, axis.letter, axis.joint.name, axis.q, axis.factors, axis.pitch)


def _paired(links: Chain, z: list[tuple[Dual, Axis | None]], x: list[Dual], convention: str) -> DHTable:
    """The alternating product cut into steps: standard (Z_i, X_i), modified (X_{i-1}, Z_i)."""
    screws = [*x, NONE] if convention == "standard" else [NONE, *x]
    rows = [row(theta, alpha, axis, convention) for (theta, axis), alpha in zip(z, screws, strict=True)]
    moving = [i for i, r in enumerate(rows) if r.letter != "F"]
    first, last = (moving[0], moving[-1] + 1) if moving else (0, 0)
    base, inner, tool = rows[:first], rows[first:last], rows[last:]  # without joints, all is tool
    fixed = sum(r.letter == "F" for r in inner)
    notes: tuple[str, ...] = (
        (f"{fixed} fixed row{'s' if fixed > 1 else ''} between nearly parallel axes",) if fixed else ()
    )
    if len(tool) > 1 and moving:
        notes += (f"the tool's axis and that of the last joint are nearly parallel: the tool has {len(tool)} steps",)
    name, nq = links.robot.name, links.robot.nq
    return DHTable(tuple(inner), end(base, convention), end(tool, convention), convention, name, nq, links, notes)


def end(rows: list[DHRow], convention: str) -> DHEnd:
    """Rows without a joint, as a base or a tool."""
    return DHEnd(tuple(DHStep(r.theta_hat, r.alpha_hat, convention) for r in rows))


OFFERED = (1e-5, 1e-4, 1e-3, 2e-3)
"""Roundings that are offered [rad]: of 1.5708 (4e-6), of 3.142 (4e-4), of 1.57 (8e-4) and 3.14 (1.6e-3)."""


def _offering(table: DHTable, near_parallel: float) -> DHTable:
    """A table with fixed rows, with a note if rounding its angles would remove some of them."""
    extra = _extra(table)
    if not extra or table.chain is None:
        return table
    for snap in OFFERED:
        rules = _rules(snap, near_parallel)
        other = _paired(table.chain, *_alternating(table.chain, rules, table.convention), table.convention)
        if _extra(other) < extra:
            fewer = "it" if extra == 1 else "them" if not _extra(other) else f"{extra - _extra(other)} of them"
            note = (
                f"snap={snap:g} would remove {fewer}: angles that are nearly multiples of 90 degrees, as rounded ones "
                f"are, become those; the tip would move by up to {other.residual:.2g} (m and matrix entries)"
            )
            return replace(table, notes=(*table.notes, note))
    return table


def _extra(table: DHTable) -> int:
    """Steps that stand for no joint, beyond the one of the tool."""
    return sum(r.letter == "F" for r in table.rows) + max(len(table.tool.steps) - 1, 0)


def _announced(table: DHTable, snap: float | tuple[float, float]) -> DHTable:
    note = f"snap={snap}: the table deviates from the robot by up to {table.residual:.3g} (m and matrix entries)"
    warnings.warn(f"{table.name}: {note}", DualpinWarning, stacklevel=3)
    return replace(table, notes=(*table.notes, note))
