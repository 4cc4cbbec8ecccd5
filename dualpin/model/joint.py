"""The interface of joint models: the displacement `motion(q)`, and the screws that the velocities multiply.

The algorithms use only these, so they contain no branch on the type of a joint.  A model also declares what the rest of
the package needs: whether coordinates add, and how the joint is written to a URDF.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import ArgumentError
from ..scalars import ONE, ZERO, Scalar
from ..spatial.pose import Pose
from ..spatial.quaternion import Quaternion
from ..spatial.vector import ZERO_MOTOR, Vector3, motor, power


@dataclass(frozen=True)
class Written:
    """A URDF joint that represents a joint model, or one of its degrees of freedom."""

    type: str
    axis: Vector3 | None = None
    coordinate: int | None = None
    """The coordinate whose limits it has."""
    suffix: str = ""
    """Appended to the name if one joint is written as several."""


class JointModel:
    """The motion that a joint allows.  `kind` is its name; `screws` span its twists in the moving frame."""

    kind: str
    nq: int
    screws: tuple[Vector3, ...] = ()
    neutral: tuple[float, ...]
    coordinates: tuple[str, ...]
    """The type of each coordinate: "angle" [rad], "length" [m] or "quaternion"."""
    coupling: tuple[Scalar, Scalar] = (ONE, ZERO)
    """(multiplier, offset) of a mimic joint, see `following`."""
    additive = True
    """Whether the velocity v leads from q to q + v in one unit of time; otherwise `integrate` computes the result."""
    velocity_names: tuple[str, ...] = ("",)
    """The names of its velocities."""
    layout = ""
    """An explanation of q and v, if the names do not suffice."""

    @property
    def nv(self) -> int:
        return len(self.screws)

    @property
    def quaternions(self) -> tuple[int, ...]:
        """Where unit quaternions (four coordinates each, scalar first) start in its coordinates."""
        return tuple(i for i, what in enumerate(self.coordinates) if what == "quaternion")[::4]

    @property
    def drawn(self) -> tuple[Vector3, ...]:
        """The screws that a drawing shows, in the moving frame."""
        return self.screws

    @property
    def free(self) -> JointModel:
        """The same joint without a leader."""
        return self

    def written(self) -> tuple[Written, ...]:
        """The URDF joints that together move as this one does, in order.

        Raises
        ------
        ArgumentError
            If there are none; the message names the type and an alternative.
        """
        raise ArgumentError(f"is {self.kind}, and URDF has no such joint")

    def following(self, multiplier: Scalar, offset: Scalar) -> JointModel:
        """This joint when its one coordinate is multiplier * x + offset of another joint's x."""
        raise ArgumentError(f"a {self.kind} joint cannot follow another: it has {self.nq} coordinates")

    def motion(self, q: Sequence[Scalar]) -> Pose:
        """Pose of the moving frame in the fixed one."""
        raise NotImplementedError

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        """The same as a unit dual quaternion, continuous in q."""
        raise NotImplementedError

    def integrate(self, q: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """The coordinates reached from q by moving with the constant body twist S v for one unit of time."""
        return [x + d for x, d in zip(q, v, strict=True)]

    def difference(self, q0: Sequence[Scalar], q1: Sequence[Scalar]) -> list[Scalar]:
        """The v that leads from q0 to q1: integrate(q0, difference(q0, q1)) = q1."""
        return [b - a for a, b in zip(q0, q1, strict=True)]

    def twist(self, v: Sequence[Scalar]) -> Vector3:
        """S v, in the moving frame."""
        total = ZERO_MOTOR
        for s, x in zip(self.screws, v, strict=True):
            total = total + s * x
        return total

    def bracket(self, u: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
        """The velocities of the Lie bracket [S u, S v]; zeros if coordinates add.

        The screws of such joints are unit twists along and about coordinate axes, so the power of a
        twist on the unit wrench with the same entries is its component along each.
        """
        if self.additive:
            return [0.0] * self.nv
        twist = self.twist(u).cross(self.twist(v))
        return [power(twist, motor(s.dual, s.real)) for s in self.screws]
