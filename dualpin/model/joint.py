"""What every joint model is asked: its displacement, `motion(q)`, and the screws its velocities multiply.

The algorithms know nothing else of a joint, so there is no branch on its kind anywhere.  What the rest of the
package asks (do coordinates add? how is it written?) a model declares too.
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
    """A URDF joint that stands for a joint model, or for one freedom of it."""

    type: str
    axis: Vector3 | None = None
    coordinate: int | None = None
    """The coordinate whose limits it takes."""
    suffix: str = ""
    """Appended to its name, where one joint becomes several."""


class JointModel:
    """What a joint lets its body do.  `kind` names it, `screws` span its twists in the moving frame."""

    kind: str
    nq: int
    screws: tuple[Vector3, ...] = ()
    neutral: tuple[float, ...]
    coordinates: tuple[str, ...]
    """What each coordinate is: "angle" [rad], "length" [m] or "quaternion"."""
    coupling: tuple[Scalar, Scalar] = (ONE, ZERO)
    """(multiplier, offset) of a joint that follows another, see `following`."""
    additive = True
    """Whether q + v is where the velocity v leads in one unit of time; else `integrate` says where."""
    velocity_names: tuple[str, ...] = ("",)
    """What to call its velocities, one each."""
    layout = ""
    """How its coordinates and velocities read, where that is not plain from their names."""

    @property
    def nv(self) -> int:
        return len(self.screws)

    @property
    def quaternions(self) -> tuple[int, ...]:
        """Where unit quaternions (four coordinates each, scalar first) start in its coordinates."""
        return tuple(i for i, what in enumerate(self.coordinates) if what == "quaternion")[::4]

    @property
    def drawn(self) -> tuple[Vector3, ...]:
        """The screws worth a line in a drawing, in the moving frame."""
        return self.screws

    @property
    def free(self) -> JointModel:
        """The joint as it is without following another."""
        return self

    def written(self) -> tuple[Written, ...]:
        """The URDF joints, one after the other, that move as this one does.

        Raises
        ------
        ArgumentError
            If there are none: what it is, and what can be done instead.
        """
        raise ArgumentError(f"is {self.kind}, and URDF has no such joint")

    def following(self, multiplier: Scalar, offset: Scalar) -> JointModel:
        """This joint when its one coordinate is multiplier * x + offset of another joint's x."""
        raise ArgumentError(f"a {self.kind} joint cannot follow another: it has {self.nq} coordinates")

    def motion(self, q: Sequence[Scalar]) -> Pose:
        """Pose of the moving frame in the fixed one."""
        raise NotImplementedError  # every joint model has its own

    def quaternion(self, q: Sequence[Scalar]) -> Quaternion:
        """The same as a unit dual quaternion, continuous in q."""
        raise NotImplementedError  # every joint model has its own

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
        """The velocities of [S u, S v], by how much two motions fail to commute; zeros where coordinates add.

        The screws of such joints are unit twists along and about coordinate axes, so the power of a
        twist on the unit wrench with the same entries is its component along each.
        """
        if self.additive:
            return [0.0] * self.nv
        twist = self.twist(u).cross(self.twist(v))
        return [power(twist, motor(s.dual, s.real)) for s in self.screws]
