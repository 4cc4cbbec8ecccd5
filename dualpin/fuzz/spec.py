"""A robot as plain numbers, which can be stored, changed and built."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from math import hypot
from typing import Any

from ..model.builder import Builder
from ..model.joints import Floating, JointModel, Planar, cylindrical, helical, prismatic, revolute, spherical
from ..model.robot import STANDARD_GRAVITY, Limits, Mimic, Robot
from ..spatial.inertia import Inertia
from ..spatial.pose import Pose
from ..spatial.rotation import IDENTITY, Rotation
from ..spatial.vector import Vector3

Triple = tuple[float, float, float]
GROUND = -1


@dataclass(frozen=True)
class JointSpec:
    """A joint and the body it moves.

    Attributes
    ----------
    type : str
        "revolute", "continuous", "prismatic", "helical", "cylindrical", "spherical", "planar", "floating" or "fixed".
    on : int
        The number of the joint that carries it, or GROUND.
    xyz, turn : 3 floats
        Its place there: position [m], and axis times angle [rad].
    axis : 3 floats
        Need not have length one.
    pitch : float
        Of a helical joint [m/rad].
    mass, com, tensor
        Of the body [kg, m, kg m^2]: xx, xy, xz, yy, yz, zz about the centre of mass.
    armature : float
        Of every coordinate.
    leader : int
        The number of the joint that it follows, or GROUND for none; with multiplier and offset.
    """

    type: str
    on: int = GROUND
    xyz: Triple = (0.0, 0.0, 0.0)
    turn: Triple = (0.0, 0.0, 0.0)
    axis: Triple = (0.0, 0.0, 1.0)
    pitch: float = 0.0
    mass: float = 0.0
    com: Triple = (0.0, 0.0, 0.0)
    tensor: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    armature: float = 0.0
    leader: int = GROUND
    multiplier: float = 1.0
    offset: float = 0.0

    @property
    def model(self) -> JointModel:
        whole = {"floating": Floating, "planar": Planar, "spherical": spherical}
        if self.type in whole:
            return whole[self.type]()
        axis = _unit(self.axis)
        if self.type == "helical":
            return helical(axis, self.pitch)
        if self.type == "continuous":
            return revolute(axis, kind="continuous")
        return {"revolute": revolute, "prismatic": prismatic, "cylindrical": cylindrical}[self.type](axis)

    @property
    def inertia(self) -> Inertia:
        xx, xy, xz, yy, yz, zz = self.tensor
        return Inertia.of(self.mass, self.com, ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))

    @property
    def placement(self) -> Pose:
        angle = hypot(*self.turn)
        rotation = Rotation.about(Vector3(*self.turn) / angle, angle) if angle else IDENTITY
        return Pose(rotation, Vector3(*self.xyz))


def _unit(axis: Sequence[float]) -> Vector3:
    length = hypot(*axis)
    return Vector3(*(x / length for x in axis))


@dataclass(frozen=True)
class Spec:
    """A robot.

    Examples
    --------
    >>> from dualpin.fuzz import JointSpec, Spec
    >>> spec = Spec("one", (JointSpec("revolute", mass=1.0, com=(0.5, 0.0, 0.0)),))
    >>> spec.robot().nv, Spec.from_json(spec.to_json()) == spec
    (1, True)
    """

    name: str
    joints: tuple[JointSpec, ...]
    gravity: Triple = STANDARD_GRAVITY

    def robot(self) -> Robot:
        """Joints are "j000", "j001", ..., links "l000", ...: the order of names is theirs.  "tool" is the last link."""
        b = Builder(self.name, self.gravity)
        b.base("ground")
        for i, j in enumerate(self.joints):
            on = "ground" if j.on == GROUND else f"l{j.on:03}"
            if j.type == "fixed":
                b.fixed(f"j{i:03}", on, j.placement, j.inertia, link=f"l{i:03}")
                continue
            model = j.model
            b.joint(
                f"j{i:03}", model, on, j.placement, j.inertia, link=f"l{i:03}",
                mimic=None if j.leader == GROUND else Mimic(f"j{j.leader:03}", j.multiplier, j.offset),
                armature=[j.armature] * model.nv if j.armature else (),
                limits=Limits((-2.0,) * model.nq, (2.0,) * model.nq) if j.type in ("revolute", "prismatic") else None,
            )  # fmt: skip
        b.frame("tool", f"l{len(self.joints) - 1:03}" if self.joints else "ground")
        return b.robot()

    def without(self, gone: set[int]) -> Spec:
        """Without some joints and their subtrees; mimic joints of a removed leader become independent."""
        for i, j in enumerate(self.joints):
            if j.on in gone:
                gone = gone | {i}
        new = {GROUND: GROUND}
        for i in range(len(self.joints)):
            if i not in gone:
                new[i] = len(new) - 1
        kept = [
            replace(j, on=new[j.on], leader=new.get(j.leader, GROUND))
            for i, j in enumerate(self.joints)
            if i not in gone
        ]
        return replace(self, joints=tuple(kept))

    def with_joint(self, i: int, joint: JointSpec) -> Spec:
        return replace(self, joints=(*self.joints[:i], joint, *self.joints[i + 1 :]))

    def to_json(self) -> str:
        return json.dumps(asdict(self), indent=1)

    @classmethod
    def from_json(cls, text: str) -> Spec:
        data = json.loads(text)
        joints = tuple(JointSpec(**{k: _tupled(v) for k, v in j.items()}) for j in data["joints"])
        return cls(data["name"], joints, _tupled(data["gravity"]))


def _tupled(x: Any) -> Any:
    return tuple(x) if isinstance(x, list) else x
