"""The dynamic parameters of a robot, and its torques as a linear function of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...algorithms import regressor
from ...arguments import flag, numbers
from ...errors import ArgumentError, ShapeError, nearest
from ...functions import joint_torque_regressor
from ...model.robot import BASE, Joint, Robot

INERTIAL = ("m", "hx", "hy", "hz", "Jxx", "Jxy", "Jyy", "Jxz", "Jyz", "Jzz")
"""Of each body: mass, first moment, and inertia about the joint frame's origin, in the regressor's order."""
FRICTION = ("viscous", "coulomb", "offset")
"""Models of a joint's friction: torque per velocity, of constant size against the motion, and constant."""


@dataclass(frozen=True, eq=False)
class Parameters:
    """All parameters p of a robot's dynamics, tau = Y(q, v, a) p, by name.

    Attributes
    ----------
    robot : Robot
    rotors : bool
        Whether every driven joint has a rotor column; else those that the robot's armature gives.
    friction : tuple of str
        Which of `FRICTION` every driven joint has.
    """

    robot: Robot
    rotors: bool = False
    friction: tuple[str, ...] = ()

    @classmethod
    def of(cls, what: str, robot: Robot, rotors: object = False, friction: object = False) -> Parameters:
        """With arguments as a user gives them: `friction` is True (viscous and coulomb), False, or names."""
        if not isinstance(robot, Robot):
            raise ArgumentError(f"{what}: a Robot expected, got {type(robot).__name__}; dualpin.load reads one")
        if robot.numbers != "double":
            raise ArgumentError(f"{what}: {robot.name} is made of {robot.numbers} numbers, doubles expected")
        if isinstance(friction, (str, tuple, list)):
            chosen = (friction,) if isinstance(friction, str) else tuple(friction)
        else:
            chosen = FRICTION[:2] if flag(f"{what}: friction", friction) else ()
        for name in chosen:
            if name not in FRICTION:
                raise ArgumentError(f"{what}: friction {name!r} is not known; {nearest(str(name), FRICTION, 'models')}")
        return cls(robot, flag(f"{what}: rotors", rotors), tuple(x for x in FRICTION if x in chosen))

    @property
    def inertial(self) -> int:
        """The number of inertial parameters, which come first: ten for each body."""
        return 10 * len(self.robot)

    @cached_property
    def of_joints(self) -> list[tuple[str, Joint, int]]:
        """(model, joint, which of its velocities) of the other ones; a free base has no motor and no friction."""
        driven = [(b, n) for b in self.robot if b.name != BASE for n in range(b.model.nv)]
        rotors = driven if self.rotors else regressor.rotors(self.robot)
        return [("rotor", b, n) for b, n in rotors] + [(model, b, n) for model in self.friction for b, n in driven]

    @cached_property
    def names(self) -> list[str]:
        """Names, such as "m[elbow_joint]" (all that moves with that joint) and "rotor[elbow_joint]" (its motor)."""
        of_bodies = [f"{symbol}[{b.name}]" for b in self.robot for symbol in INERTIAL]
        return of_bodies + [f"{model}[{_label(b, n)}]" for model, b, n in self.of_joints]

    def __len__(self) -> int:
        return self.inertial + len(self.of_joints)

    @cached_property
    def nominal(self) -> np.ndarray:
        """As the description states them, (len,); viscous and dry friction are its damping and friction."""
        bodies = [float(x) for b in self.robot for x in b.inertia.parameters]
        return np.array(bodies + [_stated(model, b, n) for model, b, n in self.of_joints])

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, engine: str = "auto") -> np.ndarray:
        """Y of shape (..., nv, len), with tau = Y p.

            rotor              multiplier^2 a_k
            viscous            multiplier^2 v_k
            coulomb            |multiplier| sign(v_k)
            offset             multiplier

        in row k, with the multiplier 1 except for mimic joints.
        """
        bodies = joint_torque_regressor(self.robot, q, v, a, engine=engine)[..., : self.inertial]
        v, a = (np.broadcast_to(numbers(name, x), bodies.shape[:-1]) for name, x in (("v", v), ("a", a)))
        Y = np.zeros((*bodies.shape[:-1], len(self)))
        Y[..., : self.inertial] = bodies
        for i, (model, b, n) in enumerate(self.of_joints, self.inertial):
            k, m = b.v.start + n, float(b.coupling[0])
            Y[..., k, i] = {
                "rotor": m * m * a[..., k],
                "viscous": m * m * v[..., k],
                "coulomb": abs(m) * np.sign(v[..., k]),
                "offset": m,
            }[model]
        return Y

    def vector(self, what: str, values: ArrayLike | None) -> np.ndarray:
        """One number for each name; those of the joints may be left out, and stay as the description states them."""
        if values is None:
            return self.nominal
        p = numbers(what, values)
        if p.shape[-1:] == (self.inertial,):
            stated = self.nominal[self.inertial :]
            p = np.concatenate([p, np.broadcast_to(stated, (*p.shape[:-1], len(stated)))], axis=-1)
        if p.shape[-1:] != (len(self),):
            raise ShapeError(f"{what}: (..., {len(self)}) expected, one for each of .parameters.names; got {p.shape}")
        return p


def _stated(model: str, b: Joint, n: int) -> float:
    """What the description says of a joint's rotor and friction."""
    if model == "rotor":
        return float(b.armature[n]) if b.armature else 0.0
    return {"viscous": float(b.damping), "coulomb": float(b.friction)}.get(model, 0.0)


def _label(b: Joint, n: int) -> str:
    return f"{b.name}.{b.model.velocity_names[n]}" if b.model.nv > 1 else b.name
