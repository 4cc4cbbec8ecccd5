"""Robots from home poses and screws."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import choice, numbers
from ..dual import Dual
from ..errors import ArgumentError, ShapeError
from ..model.builder import Builder
from ..model.joints import Axial, JointModel
from ..model.robot import STANDARD_GRAVITY, Robot
from ..scalars import exact
from ..spatial.inertia import Inertia
from ..spatial.pose import Pose
from ..spatial.vector import AXES, Matrix3, Vector3
from .build import homogeneous
from .screws import carried

UNIT = 1e-6  # how far a screw's length may be from 1: six printed digits
PITCH = 1e-12  # metres per radian: rounding in w . v of a line some metres away


def from_screws(
    home: ArrayLike,
    screws: ArrayLike,
    frame: str = "space",
    Mlist: ArrayLike | None = None,
    Glist: ArrayLike | None = None,
    gravity: Sequence[float] = STANDARD_GRAVITY,
    *,
    name: str = "chain",
    unit: bool = True,
) -> Robot:
    """A robot from its product of exponentials.

    Parameters
    ----------
    home : array_like, shape (4, 4)
        M, pose of the tip at q = 0.
    screws : array_like, shape (n, 6)
        One [w; v] a row: revolute (w unit, w . v = 0), prismatic (w zero, v unit), or helical (w
        unit, pitch w . v in m/rad).  A pitch within the precision of printed numbers (six decimals,
        say) is zero; ``robot.notes`` says so.
    frame : "space" or "body"
        The frame of the screws.
    Mlist : array_like, shape (n + 1, 4, 4) or (n, 4, 4), optional
        Poses of the link frames {i} in {i-1} at home, {0} the base; the tip's is not used.
    Glist : array_like, shape (n, 6, 6), optional
        Spatial inertias of the links in the frames {i}, angular first, as Modern Robotics has them.
    gravity : (3,) in the base frame [m/s^2]
    name : str
        Of the robot.
    unit : bool
        Refuse screws that are not of unit length; otherwise they multiply their coordinates.

    Returns
    -------
    Robot
        Joints "joint_1", ..., links "base_link", "link_1", ..., and last of all frames "tool".

    Raises
    ------
    ShapeError, ArgumentError

    References
    ----------
    Lynch & Park (2017), 4.1, 8.3.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> poe = dp.to_screws(dp.load("ur5"), tip="tool0")
    >>> arm = dp.from_screws(poe.home, poe.screws)
    >>> bool(np.allclose(dp.fk(arm, np.ones(6), "tool"), poe.fk(np.ones(6))))
    True
    """
    choice("from_screws: frame", frame, ("space", "body"))
    tip = homogeneous("from_screws: home", home)
    S = _columns(numbers("from_screws: screws", screws))
    if not np.isfinite(S).all():
        raise ArgumentError(
            f"from_screws: screw {int(np.argwhere(~np.isfinite(S))[0, 1]) + 1} has numbers that are not finite"
        )
    blur = _blur(S)
    if frame == "body":
        S = carried(tip, S)
    bodies = _bodies(Mlist, Glist, S.shape[1])
    b = Builder(name, gravity)
    b.base("base_link")
    on, at = "base_link", np.zeros(3)
    rounded = []
    for i, (w, v, least) in enumerate(zip(S[:3].T, S[3:].T, blur, strict=True), 1):
        model, point = _joint(w, v, i, unit, float(least))
        if PITCH < abs(w @ v) <= least and np.linalg.norm(w) > UNIT:
            rounded.append(f"joint_{i} ({w @ v:.2g} m/rad)")
        # every moving frame stands on its axis, parallel to the base at home
        point = at if point is None else point
        here = Pose(position=_vector(point))
        body = None if bodies is None else here.inverse @ bodies[i - 1]
        b.joint(f"joint_{i}", model, on, Pose(position=_vector(point - at)), body, link=f"link_{i}")
        on, at = f"link_{i}", point
    if rounded:
        b.notes.append(
            "pitches within the precision of the screws' own decimals count as zero, the joints are revolute: "
            + ", ".join(rounded)
        )
    b.fixed("tool_joint", on, Pose(position=_vector(-at)) @ tip, link="tool")
    return b.robot()


def _columns(screws: np.ndarray) -> np.ndarray:
    """Screws given as rows, as columns (6, n).

    Columns were what was taken up to version 0.1.  They still are where the array cannot be rows: by its shape or,
    if it is 6 x 6, because its columns are unit screws and its rows are not.
    """
    if screws.ndim != 2 or 6 not in screws.shape:
        raise ShapeError(f"from_screws: screws of shape (n, 6) expected, rows [w; v]; got {screws.shape}")
    if screws.shape[1] != 6 or (screws.shape[0] == 6 and _unit(screws.T) and not _unit(screws)):
        message = "from_screws: screws are rows [w; v] now, shape (n, 6); for columns as of .Slist give Slist.T"
        warnings.warn(message, DeprecationWarning, stacklevel=3)
        return screws
    return screws.T


def _unit(rows: np.ndarray) -> bool:
    """Whether every row is a screw of unit length."""
    turn, slide = np.linalg.norm(rows[:, :3], axis=1), np.linalg.norm(rows[:, 3:], axis=1)
    return bool((np.abs(np.where(turn > UNIT, turn, slide) - 1) <= UNIT).all())


def _vector(x: np.ndarray) -> Vector3:
    return Vector3(*map(exact, x.tolist()))


def _blur(S: np.ndarray) -> np.ndarray:
    """How exactly the pitch w . v of each screw is known, shape (n,), in m/rad.

    Numbers of 4 to 12 decimals were printed, and are known to half of the last; others to rounding.
    An error of delta in every number changes w . v by up to delta (|w|_1 + |v|_1).
    """
    size = np.abs(S).max(initial=1.0)
    decimals = next((k for k in range(13) if np.abs(S - S.round(k)).max(initial=0.0) <= 1e-15 * size), 13)
    delta = 0.5 * 10.0**-decimals if 4 <= decimals <= 12 else 0.0
    return np.maximum(PITCH, delta * np.abs(S).sum(axis=0))


def _joint(w: np.ndarray, v: np.ndarray, i: int, unit: bool, least: float) -> tuple[JointModel, np.ndarray | None]:
    """The joint of a screw [w; v], and the point of its axis next to the origin (None: anywhere)."""
    turn, slide = float(np.linalg.norm(w)), float(np.linalg.norm(v))
    size = turn if turn > UNIT else slide
    if size < UNIT or (unit and abs(size - 1) > UNIT):
        raise ArgumentError(
            f"from_screws: screw {i} has |w| = {turn:.9g} and |v| = {slide:.9g}; |w| = 1, or w = 0 and "
            "|v| = 1, expected"
        )
    if turn <= UNIT:
        return Axial(
            _direction(v / slide), Dual(exact(0), _near(slide)), kind="prismatic", coordinates=("length",)
        ), None
    axis, pitch = w / turn, float(w @ v) / turn**2
    if abs(pitch) <= least / turn**2:
        pitch = 0.0
    kind = "helical" if pitch else "revolute"
    units = Dual(_near(turn), exact(_near(turn) * pitch))
    return Axial(_direction(axis), units, kind=kind, coordinates=("angle",)), np.cross(axis, v) / turn


def _near(size: float) -> Any:
    """A length of 1 up to rounding, exactly; the axis is normalised anyway."""
    return exact(1) if abs(size - 1) <= 1e-15 else size


def _direction(u: np.ndarray) -> Vector3:
    for e, axis in zip(np.eye(3), AXES, strict=True):
        for sign in (1, -1):
            if np.abs(u - sign * e).max() <= 1e-15:
                return axis if sign == 1 else -axis
    return Vector3(*u.tolist())


def _bodies(Mlist: ArrayLike | None, Glist: ArrayLike | None, n: int) -> list[Inertia] | None:
    """Inertias about the base frame at home."""
    if Mlist is None and Glist is None:
        return None
    if Mlist is None or Glist is None:
        raise ArgumentError("from_screws: Mlist and Glist go together, the link frames and the inertias in them")
    M, G = numbers("from_screws: Mlist", Mlist), numbers("from_screws: Glist", Glist)
    if G.shape != (n, 6, 6):
        raise ShapeError(f"from_screws: Glist of shape ({n}, 6, 6) expected, got {G.shape}")
    if M.shape not in ((n, 4, 4), (n + 1, 4, 4)):
        raise ShapeError(f"from_screws: Mlist of shape ({n + 1}, 4, 4) expected, got {M.shape}")
    out, T = [], np.eye(4)
    for i in range(n):
        T = T @ M[i]
        out.append(homogeneous(f"from_screws: Mlist[{i}]", T) @ _inertia(G[i], i))
    return out


def _inertia(G: np.ndarray, i: int) -> Inertia:
    """[J, m[c]; -m[c], m 1] as mass, first moment and inertia about the frame's origin."""
    m, h = G[3, 3], np.array([G[2, 4], G[0, 5], G[1, 3]])
    skew = np.array([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
    J = (G[:3, :3] + G[:3, :3].T) / 2
    if np.abs(G - np.block([[J, skew], [-skew, m * np.eye(3)]])).max() > 1e-9 * max(1.0, np.abs(G).max()):
        raise ArgumentError(
            f"from_screws: Glist[{i}] is not a spatial inertia [J, m[c]; -m[c], m 1] (angular first); "
            "m 1 expected in the lower right block"
        )
    return Inertia(exact(float(m)), _vector(h), Matrix3(*map(_vector, J)))
