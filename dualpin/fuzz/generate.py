"""Random robots, each identified by a seed and a number.

Sizes are drawn over decades: masses over nine, lengths over five, within a robot or from robot to robot; so are
numbers of joints, since what is wrong shows in small robots, of which more can be examined.
Axes are often nearly parallel, or off a coordinate axis by what a rounded 1.5708 is off; bodies may be
slender, or far from their joint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..spatial.inertia import steiner
from .spec import GROUND, JointSpec, Spec

KINDS = {
    "revolute": 8.0, "continuous": 3.0, "prismatic": 3.0, "helical": 1.0, "cylindrical": 1.0, "spherical": 1.5,
    "planar": 1.0,
}  # fmt: skip
"""Weights of the joint types; floating ones are bases."""
LARGE = 200
"""One robot in so many is large."""
JOINTS, MANY = (1, 20), (21, 200)
"""How many joints ordinary and large robots have: half of either less than the middle, on a scale of decades."""
SINGLE = ("revolute", "continuous", "prismatic", "helical")
"""Types that may be mimic joints and leaders."""


def is_large(number: int) -> bool:
    """Whether a robot of this number is one of the large ones."""
    return number % LARGE == LARGE - 1


def random_spec(seed: int, number: int) -> Spec:
    """Robot `number` of a seed.

    Parameters
    ----------
    seed, number : int

    Returns
    -------
    Spec

    Examples
    --------
    >>> from dualpin.fuzz import random_spec
    >>> a = random_spec(7, 3)
    >>> a == random_spec(7, 3), a == random_spec(7, 4)
    (True, False)
    """
    rng = np.random.default_rng([seed, number])
    least, most = MANY if is_large(number) else JOINTS
    count = int(least * ((most + 1) / least) ** rng.random())
    draw = _Sizes(rng)
    shape = rng.choice(["chain", "tree", "star"], p=[0.5, 0.35, 0.15])
    floating = rng.random() < 0.25
    leaders: list[int] = []
    on: list[int] = []
    joints: list[JointSpec] = []
    for i in range(count):
        on.append(_parent(rng, str(shape), on, i))
        kind = "floating" if floating and i == 0 else str(rng.choice(list(KINDS), p=_weights()))
        follows = kind in SINGLE and bool(leaders) and rng.random() < 0.08
        leader = int(rng.choice(leaders)) if follows else GROUND
        if kind in SINGLE and not follows:
            leaders.append(i)
        before = joints[on[i]].axis if on[i] != GROUND else None
        mass, com, tensor = draw.body()
        joint = JointSpec(
            kind, on[i], draw.position(), draw.turn(), draw.axis(before), draw.pitch(), mass, com, tensor,
            draw.armature(mass), leader, *_coupling(rng, follows),
        )  # fmt: skip
        joints.append(joint)
    gravity = (0.0, 0.0, -9.81) if rng.random() < 0.7 else _triple(rng.uniform(-10, 10, 3))
    return _weighing(Spec(f"random_{seed}_{number}", tuple(joints), gravity), rng)


def _weights() -> list[float]:
    total = sum(KINDS.values())
    return [w / total for w in KINDS.values()]


def _parent(rng: np.random.Generator, shape: str, on: list[int], i: int) -> int:
    """On the last joint or one that carries it: depth first, as Pinocchio numbers its joints."""
    if i == 0:
        return GROUND
    if shape == "star" and rng.random() < 0.6:
        return 0
    above = [i - 1]
    while on[above[-1]] != GROUND:
        above.append(on[above[-1]])
    return int(rng.choice(above)) if shape == "tree" and rng.random() < 0.4 else i - 1


def _coupling(rng: np.random.Generator, follows: bool) -> tuple[float, float]:
    return (float(rng.uniform(-2, 2)), float(rng.uniform(-1, 1))) if follows else (1.0, 0.0)


def _triple(x: np.ndarray) -> tuple[float, float, float]:
    a, b, c = x.tolist()
    return a, b, c


class _Sizes:
    """The random numbers of one robot."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        wild = rng.random() < 0.3  # sizes differ within the robot, else from robot to robot
        self.length = self._decades(-3, 2, wild)
        self.mass = self._decades(-6, 3, wild)
        self.massless = float(rng.choice([0.0, 0.15]))
        self.rotors = rng.random() < 0.3

    def _decades(self, low: float, high: float, wild: bool) -> Callable[[], float]:
        rng = self.rng
        if wild:
            return lambda: float(10 ** rng.uniform(low, high))
        scale = 10 ** rng.uniform(low, high)
        return lambda: float(scale * rng.uniform(0.3, 3))

    def unit(self) -> np.ndarray:
        x = self.rng.standard_normal(3)
        return x / np.linalg.norm(x)

    def position(self) -> tuple[float, float, float]:
        kind = self.rng.integers(4)
        along = np.eye(3)[self.rng.integers(3)] if kind == 0 else self.unit()
        return _triple(along * self.length() if kind != 1 else np.zeros(3))

    def turn(self) -> tuple[float, float, float]:
        """None, a quarter turn (exact or as 1.5708), or any."""
        kind, along = self.rng.integers(4), np.eye(3)[self.rng.integers(3)]
        angles = {0: 0.0, 1: np.pi / 2, 2: 1.5708}
        return _triple(along * angles[int(kind)] if kind < 3 else self.unit() * self.rng.uniform(-np.pi, np.pi))

    def axis(self, before: tuple[float, float, float] | None) -> tuple[float, float, float]:
        """A coordinate axis, nearly the axis before, nearly a coordinate axis, or any."""
        kind = self.rng.integers(5)
        plain = np.eye(3)[self.rng.integers(3)] * self.rng.choice([1, -1])
        off = self.unit() * 10 ** self.rng.uniform(-12, -2)
        if kind == 1 and before is not None:
            plain = np.array(before)
        return _triple(plain if kind < 2 else plain + off if kind < 4 else self.unit())

    def pitch(self) -> float:
        return float(self.rng.uniform(-0.3, 0.3))

    def body(self) -> tuple[float, tuple[float, float, float], tuple[float, ...]]:
        """The inertia of six point masses, so that it is physically possible; sometimes flat, slender or far away."""
        rng = self.rng
        if rng.random() < self.massless:
            return 0.0, (0.0, 0.0, 0.0), (0.0,) * 6
        m, size = self.mass(), self.length()
        share, place = rng.dirichlet(np.ones(6)), rng.uniform(-1, 1, (6, 3)) * size
        thin = rng.integers(6)
        place[:, : max(0, int(thin) - 3)] *= 1e-3  # of six in two: flat, slender
        com = share @ place
        place -= com
        if rng.random() < 0.1:
            com = com + self.unit() * size * 10 ** rng.uniform(0, 2)
        J = sum(steiner(m * s, p) for s, p in zip(share, place, strict=True))
        return m, _triple(com), tuple(np.asarray(J)[np.triu_indices(3)].tolist())

    def armature(self, mass: float) -> float:
        return float(mass * 10 ** self.rng.uniform(-3, 0)) if self.rotors and self.rng.random() < 0.5 else 0.0


def _weighing(spec: Spec, rng: np.random.Generator) -> Spec:
    """Give every leaf a mass, so that M is regular."""
    draw = _Sizes(rng)
    draw.massless = 0.0
    carrying = {j.on for j in spec.joints}
    for i, j in enumerate(spec.joints):
        if i not in carrying and not j.mass:
            mass, com, tensor = draw.body()
            spec = spec.with_joint(i, replace(j, mass=mass, com=com, tensor=tensor))
    return spec
