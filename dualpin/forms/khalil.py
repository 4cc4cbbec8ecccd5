"""Whole trees: the parameters of Khalil and Kleinfinger, as dual angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..algorithms.kinematics import frame_pose
from ..delegates import home
from ..dual import Dual
from ..errors import FrameNotFoundError, nearest
from ..functions import fk
from ..model.builder import Builder
from ..model.joints import Floating
from ..model.robot import Frame, Robot, expect_numbers
from ..renamed import Renamed
from ..scalars import Scalar
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import UX, UZ, ZERO_VECTOR, motor
from .align import NONE, Rules, Step, ahead, numeric, remaining, step
from .build import model
from .chain import Axis, axes_of, chain, homes, leaves, root, whole_q
from .text import write


@dataclass(frozen=True)
class KhalilRow:
    """One frame of the tree:  antecedent -> Z(gamma + eps b) X(alpha + eps d) Z(theta + eps r) -> frame.

    Attributes
    ----------
    number, antecedent : int
        Of this frame and of the one it is described in; 0 is the base.
    letter : str
        "R" (sigma 0: theta varies), "P" (sigma 1: r varies), "F" (sigma 2: fixed), "C" and "H".
    name : str
        The joint's, or the link's of a terminal frame.
    q, factors, pitch
        As in `DHRow`.
    """

    number: int
    antecedent: int
    letter: str
    name: str
    gamma_hat: Dual
    alpha_hat: Dual
    theta_hat: Dual
    q: tuple[int, ...] = ()
    factors: tuple[float, ...] = ()
    pitch: float = 0.0
    kind = Renamed("letter")

    @property
    def sigma(self) -> int | None:
        """Khalil's sigma: 0 revolute, 1 prismatic, 2 fixed; None for kinds that the notation does not have."""
        return {"R": 0, "P": 1, "F": 2}.get(self.letter)

    @property
    def gamma(self) -> float:
        return float(self.gamma_hat.real)

    @property
    def b(self) -> float:
        return float(self.gamma_hat.dual)

    @property
    def alpha(self) -> float:
        return float(self.alpha_hat.real)

    @property
    def d(self) -> float:
        return float(self.alpha_hat.dual)

    @property
    def theta(self) -> float:
        return float(self.theta_hat.real)

    @property
    def r(self) -> float:
        return float(self.theta_hat.dual)

    @property
    def pose(self) -> Pose:
        """The displacement at q = 0."""
        return Pose.about(UZ, self.gamma_hat) @ Pose.about(UX, self.alpha_hat) @ Pose.about(UZ, self.theta_hat)


@dataclass(frozen=True, eq=False)
class KhalilTable:
    """A tree of joints by the parameters gamma, b, alpha, d, theta, r of each frame.

    One successor of every frame has gamma = b = 0 (its row is a modified DH row); the others take
    the two further parameters, so that six numbers describe any branching.  Each leaf closes with a
    fixed terminal frame.

    Attributes
    ----------
    rows : tuple of KhalilRow
    base : Dual
        theta + eps r from the base link to frame 0.

    References
    ----------
    Khalil & Kleinfinger (1986), A new geometric notation for open and closed-loop robots.

    Examples
    --------
    >>> import dualpin as dp
    >>> hand = dp.to_dh(dp.load("allegro_left"), convention="khalil-kleinfinger")
    >>> len(hand.tips), hand.residual < 1e-14
    (4, True)
    """

    rows: tuple[KhalilRow, ...]
    base: Dual
    source: Robot
    tips: dict[str, int]
    """Leaf link -> number of its terminal frame."""
    notes: tuple[str, ...] = ()
    """What was inserted."""

    def __repr__(self) -> str:
        return f"<KhalilTable {self.source.name!r}: {len(self.rows)} frames, {len(self.tips)} tips>"

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def robot(self) -> Robot:
        """The table as a separate robot without masses; a frame "number" for each row."""
        b = Builder(self.source.name)
        b.base("0")
        for row in self.rows:
            on, place = str(row.antecedent), row.pose.snapped
            if row.antecedent == 0:
                place = (Pose.about(UZ, self.base) @ row.pose).snapped
            if row.letter == "F":
                b.fixed(f"fixed_{row.number}", on, place, link=str(row.number))
            else:
                b.joint(f"joint_{row.number}", model(row.letter, row.pitch), on, place, link=str(row.number))
        return b.robot()

    def _own(self, q: Sequence[Any]) -> list[Any]:
        return [q[i] * f for row in self.rows for i, f in zip(row.q, row.factors, strict=True)]

    def _tip(self, tip: str | None) -> Frame:
        if tip is None and len(self.tips) == 1:
            (tip,) = self.tips
        if tip not in self.tips:
            raise FrameNotFoundError(
                f"{tip!r} is not a tip of {self.source.name}; {nearest(str(tip), self.tips, 'tips')}"
            )
        return self.robot.frame(str(self.tips[tip]))

    def pose(self, q: Sequence[Scalar], tip: str | None = None) -> Pose:
        """Pose of a leaf link in the base link over any scalar."""
        return frame_pose(self.robot, self._own(q), self._tip(tip))

    def fk(self, q: ArrayLike, tip: str | None = None, *, engine: str = "auto") -> np.ndarray:
        """Pose of a leaf link in the base link, shape (..., 4, 4); q (..., nq) of the whole robot."""
        x = np.moveaxis(whole_q(self.source, q, f"{self.source.name}: fk: q"), -1, 0)
        own = np.stack(self._own(list(x)), axis=-1) if self.robot.nq else np.zeros((*x.shape[1:], 0))
        return fk(self.robot, own, self._tip(tip), engine=engine)

    @cached_property
    def residual(self) -> float:
        """Largest entry of |T_table - T_robot| over all tips and 16 random q."""
        worst = 0.0
        for tip in self.tips:
            links = chain(self.source, None, tip)
            q = links.sample(16)
            worst = max(worst, float(np.abs(self.fk(q, tip, engine="numpy") - links.fk(q, engine="numpy")).max()))
        return worst

    def table(self, degrees: bool = False, digits: int | None = None) -> str:
        """The rows as an aligned table."""
        return self.export("table", degrees=degrees, digits=digits)

    def export(self, format: str = "table", *, degrees: bool = False, digits: int | None = None) -> str:
        """The table as text: "table", "csv", "json", "yaml", "markdown" or "latex"."""
        return home("KhalilTable.export")(self, format, degrees, digits)

    def to_csv(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("csv")` to a file."""
        write(path, self.export("csv", **options))

    def to_latex(self, path: str | PathLike[str], **options: Any) -> None:
        """Write `export("latex")` to a file."""
        write(path, self.export("latex", **options))


class _Tree:
    """Frames as they are numbered.

    A frame's z axis is known when its joint is met, its x axis only when its first successor is:
    its theta and r are not known before that.
    """

    def __init__(self, robot: Robot, rules: Rules) -> None:
        self.robot, self.rules = robot, rules
        self.rows: list[KhalilRow] = []
        self.base = NONE
        self.poses: list[Pose] = [IDENTITY_POSE]
        self.open = {0}
        self.tips: dict[str, int] = {}

    def _close(self, number: int, theta: Dual) -> None:
        self.open.discard(number)
        self.poses[number] = numeric(self.poses[number] @ Pose.about(UZ, theta))
        if number == 0:
            self.base = theta
            return
        self.rows[number - 1] = replace(self.rows[number - 1], theta_hat=theta)

    def add(self, antecedent: int, steps: list[Step], name: str, axis: Axis | None) -> int:
        """The frames of these steps, the last about `axis`; its number."""
        for i, (theta, alpha) in enumerate(steps):
            gamma = theta
            if antecedent in self.open:
                self._close(antecedent, theta)
                gamma = NONE
            number = len(self.rows) + 1
            last = i == len(steps) - 1
            of = axis if last else None
            self.rows.append(
                KhalilRow(number, antecedent, of.letter, name, gamma, alpha, NONE, of.q, of.factors, of.pitch)
                if of
                else KhalilRow(number, antecedent, "F", name, gamma, alpha, NONE)
            )
            self.poses.append(numeric(self.poses[antecedent] @ Pose.about(UZ, gamma) @ Pose.about(UX, alpha)))
            self.open.add(number)
            antecedent = number
        return antecedent


def khalil_table(robot: Robot, rules: Rules) -> KhalilTable:
    """Frames for every joint of the tree, parents first, and one for every leaf link."""
    expect_numbers("to_dh", robot)
    start = root(robot)
    still = {start.joint} if start.joint and isinstance(start.joint.model, Floating) else set()
    joints = [j for j in robot if j not in still]
    world = homes(robot, list(robot))
    origin = (world[start.joint] @ start.placement).inverse
    tree, frames = _Tree(robot, rules), {start.joint: 0, None: 0}
    for joint in joints:
        number = frames[joint.parent]
        for axis in axes_of(joint, origin @ world[joint], "to_dh"):
            number = tree.add(number, step(ahead(axis, tree.poses[number]), rules), joint.name, axis)
        frames[joint] = number
    for leaf in leaves(robot):
        if leaf.joint is None or leaf.joint in still:
            continue  # fixed to the base: nothing moves it
        number, home = frames[leaf.joint], origin @ world[leaf.joint] @ leaf.placement
        rest = tree.poses[number].inverse @ home
        last = tree.add(number, step(rest @ motor(UZ, ZERO_VECTOR), rules, rest), leaf.name, None)
        tree._close(last, remaining(tree.poses[last].inverse @ home, rules))
        tree.tips[leaf.name] = last
    fixed = sum(r.letter == "F" for r in tree.rows) - len(tree.tips)
    notes = (f"{fixed} fixed frame{'s' if fixed > 1 else ''} between nearly parallel axes",) if fixed else ()
    return KhalilTable(tuple(tree.rows), tree.base, robot, tree.tips, notes)
