"""Products of exponentials: the home pose of the tip, and one screw for each freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algorithms.kinematics import frame_pose
from ..delegates import home
from ..errors import ArgumentError
from ..functions import fk, jacobian
from ..model.joints import Planar
from ..model.robot import Frame, Joint, Robot
from ..scalars import Scalar
from ..spatial.inertia import Inertia
from ..spatial.pose import Pose
from ..spatial.vector import Vector3, motor
from .chain import Chain, chain, homes, whole_q
from .text import write

FRAMES = ("space", "body")


def carried(X: Pose, screws: np.ndarray) -> np.ndarray:
    """Screws [w; v] of the frame X, as columns, in the frame that X is described in, (6, n)."""
    moved = (X @ motor(Vector3(*s[:3]), Vector3(*s[3:])) for s in screws.T.tolist())
    return np.array([[*map(float, m.real), *map(float, m.dual)] for m in moved]).reshape(-1, 6).T


def at_centre(body: Inertia) -> tuple[np.ndarray, np.ndarray]:
    """Centre of mass, and the inertia matrix about it."""
    c, about = body.central
    return np.array([float(x) for x in c]), about.array


@dataclass(frozen=True, eq=False)
class Screws:
    """A serial chain as a product of exponentials.

        T(q) = exp(S_1 q_1) ... exp(S_n q_n) M      (space)
        T(q) = M exp(B_1 q_1) ... exp(B_n q_n)      (body)

    Attributes
    ----------
    home : ndarray, shape (4, 4)
        M, pose of the tip in the base at q = 0.
    frame : "space" or "body"
        Which of the two `screws` holds.
    Slist : ndarray, shape (6, n)
        Space screws as columns, under the name and in the shape that the Modern Robotics package takes; `Blist`
        has the body screws.
    joint_names : tuple of str
        For each screw the joint it belongs to; a cylindrical joint has two screws, a planar three.
    columns : tuple of int
        For each screw the coordinate of the whole robot it goes with.

    References
    ----------
    Brockett (1984); Lynch & Park (2017), 4.1 and 5.1.
    """

    home: np.ndarray
    Slist: np.ndarray
    frame: str
    joint_names: tuple[str, ...]
    columns: tuple[int, ...]
    chain: Chain

    def __repr__(self) -> str:
        return f"<Screws of {self.chain.robot.name!r}: {len(self)}, {self.frame}, tip {self.chain.tip.name!r}>"

    def _repr_html_(self) -> str:
        return str(home("Screws._repr_html_")(self))

    def plot(self, axes: Any = None) -> Any:
        """Draw the axes of the screws at home; returns the axes.  Needs ``pip install 'dualpin[figures]'``."""
        return home("Screws.plot")(self, axes)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def screws(self) -> np.ndarray:
        """Screws [w; v] in the chosen frame, one a row, shape (n, 6)."""
        return (self.Slist if self.frame == "space" else self.Blist).T

    @property
    def M(self) -> np.ndarray:
        """The home pose, under the name the Modern Robotics package takes, shape (4, 4)."""
        return self.home

    @cached_property
    def Blist(self) -> np.ndarray:
        """Body screws B = Ad(M^-1) S as columns, shape (6, n)."""
        return carried(self.chain.home.inverse, self.Slist)

    @cached_property
    def _bodies(self) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Home poses of centre-of-mass frames, and inertias there, one for each screw."""
        if not self.chain.downward:
            raise ArgumentError(
                f"Mlist, Glist: the chain from {self.chain.base.name!r} to {self.chain.tip.name!r} passes joints from "
                "child to parent; inertias are those of a robot that stands on its base link"
            )
        poses, inertias = [], []
        base = np.linalg.inv((_home_of(self.chain, self.chain.base.joint) @ self.chain.base.placement).array)
        axes = self.chain.axes
        for i, axis in enumerate(axes):
            X = base @ _home_of(self.chain, axis.joint).array
            last = i + 1 == len(axes) or axes[i + 1].joint is not axis.joint
            count = len(axis.units)
            G = np.zeros((6, 6))
            body = axis.joint.inertia
            m = float(body.mass)
            X_com = X
            if last:
                c, G[:3, :3] = at_centre(body)
                G[3:, 3:] = m * np.eye(3)
                X_com = X @ Pose(position=Vector3(*c.tolist())).array
            # of the screws of one joint, the last moves the body
            poses += [X] * (count - 1) + [X_com]
            inertias += [np.zeros((6, 6))] * (count - 1) + [G]
        return poses, inertias

    @property
    def Mlist(self) -> np.ndarray:
        """Poses M_{i-1,i} of the centre-of-mass frames {i} at home; the last is the tip's, shape (n + 1, 4, 4).

        {i} has the axes of the joint's moving frame.
        """
        before, out = np.eye(4), []
        for X in [*self._bodies[0], self.home]:
            out.append(np.linalg.inv(before) @ X)
            before = X
        return np.array(out)

    @property
    def Glist(self) -> np.ndarray:
        """Spatial inertias diag(J_c, m 1) in the frames {i} of `Mlist`, shape (n, 6, 6).

        Of the bodies on the chain; what other branches carry is not in it.  Screws of one joint
        share its body: the last has it.
        """
        return np.array(self._bodies[1]).reshape(-1, 6, 6)

    # motion

    @cached_property
    def robot(self) -> Robot:
        """The product of exponentials as a separate robot, one joint for each screw."""
        return home("Screws.robot")(self.home, self.Slist.T, name=self.chain.robot.name, unit=False)

    def pose(self, q: Sequence[Scalar]) -> Pose:
        """T(q) over any scalar; q of the whole robot."""
        return frame_pose(self.robot, [q[i] for i in self.columns], self.robot.frames[-1])

    def fk(self, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
        """Pose of the tip in the base, shape (..., 4, 4); q (..., nq) of the whole robot.

        Examples
        --------
        >>> import numpy as np, dualpin as dp
        >>> poe = dp.to_screws(dp.load("ur5"), tip="tool0")
        >>> bool(np.allclose(poe.fk(np.zeros(6)), poe.home))
        True
        """
        x = whole_q(self.chain.robot, q, "Screws.fk: q")
        return fk(self.robot, x[..., list(self.columns)], self.robot.frames[-1], engine=engine)

    def jacobian(self, q: ArrayLike, *, engine: str = "auto") -> np.ndarray:
        """Twist of the tip relative to the base for unit velocities, rows [w; v], shape (..., 6, nv).

        About the base frame's origin in its axes ("space"), or the tip's in its own ("body").
        Columns are of the whole robot's velocities; those off the chain are zero.

        Raises
        ------
        ArgumentError
            If a planar joint is on the chain, whose velocities are those of the body and not of
            its coordinates.
        """
        for joint in (axis.joint for axis in self.chain.axes):
            if isinstance(joint.model, Planar):
                raise ArgumentError(
                    f"Screws.jacobian: the velocities of the planar joint {joint.name!r} are not the rates of its "
                    "coordinates; dualpin.jacobian has its columns"
                )
        x = whole_q(self.chain.robot, q, "Screws.jacobian: q")
        reference = "world" if self.frame == "space" else "local"
        own = jacobian(self.robot, x[..., list(self.columns)], self.robot.frames[-1], reference, engine=engine)
        J = np.zeros((*own.shape[:-1], self.chain.robot.nv))
        for k, v in enumerate(self._velocities):
            J[..., v] += own[..., k]
        return J

    @cached_property
    def _velocities(self) -> list[int]:
        """For each screw the velocity of the whole robot it goes with."""
        offset = {i: a.joint.v.start + i - a.joint.q.start for a in self.chain.axes for i in a.q}
        return [offset[i] for i in self.columns]

    @cached_property
    def residual(self) -> float:
        """Largest entry of |T_screws - T_robot| over 16 random q."""
        q = self.chain.sample(16)
        return float(np.abs(self.fk(q, engine="numpy") - self.chain.fk(q, engine="numpy")).max())

    # text

    def table(self, digits: int | None = None) -> str:
        """Home pose and screws as aligned text."""
        return self.export("table", digits=digits)

    def export(self, format: str = "table", *, degrees: bool = False, digits: int | None = None) -> str:
        """As text: "table", "csv", "json", "yaml", "markdown", "latex", "python" or "matlab".

        Code holds M, Slist, Blist, Mlist, Glist as the Modern Robotics packages take them.  With
        `degrees`, screws are per degree: w and v of a revolute joint times pi / 180.
        """
        return home("Screws.export")(self, format, degrees, digits)

    def to_csv(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("csv")` to a file."""
        write(path, self.export("csv", **options))

    def to_json(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("json")` to a file."""
        write(path, self.export("json", **options))


def _home_of(links: Chain, joint: Joint | None) -> Pose:
    return homes(links.robot, [] if joint is None else list(joint.chain)[::-1])[joint]


def screws_of(robot: Robot, tip: str | Frame | None, frame: str, base: str | Frame | None) -> Screws:
    """The product of exponentials of a chain; see `to_screws`."""
    links = chain(robot, base, tip, "to_screws")
    S: list[list[float]] = []
    names: list[str] = []
    columns: list[int] = []
    for axis in links.axes:
        for unit, column in zip(axis.units, axis.q, strict=True):
            screw = axis.line * unit
            S.append([*map(float, screw.real), *map(float, screw.dual)])
            names.append(axis.joint.name)
            columns.append(column)
    Slist = np.array(S).reshape(-1, 6).T
    return Screws(links.home.array, Slist, frame, tuple(names), tuple(columns), links)
