"""Identities of a robot's terms, independent of other libraries.

Each identity is one small function that returns two values that must be equal, and the size of the numbers that
add up in them (see `crosscheck.extent`).  Derivatives by complex steps have only rounding errors.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter

import numpy as np

from ..crosscheck.checks import CHECKS
from ..crosscheck.extent import ORDINARY, Extent
from ..crosscheck.results import AGREES, DIFFERS, NOT_COMPARED, ORACLE, TermResult
from ..crosscheck.sampling import states
from ..crosscheck.tally import scaled_error
from ..crosscheck.tolerance import MassMatrices, depth, rounding, solution
from ..errors import DualpinError, DualpinWarning
from ..forms import to_dh
from ..functions import aba, bias, coriolis, crba, fk, gravity, jacobian, rnea
from ..io.axes import TOLERANCE
from ..io.urdf import loads
from ..model.robot import Robot
from ..spatial.adjoint import inverted
from .complex_step import along

Array = np.ndarray
SAFETY = 4.0
"""Both sides are computed by dualpin, and one is a derivative or a sum of several terms: four roundings, not one."""


class Skipped(Exception):  # noqa: N818 (it is no error)
    """The identity does not apply to this robot."""


@dataclass
class State:
    """A robot at one state."""

    robot: Robot
    q: Array
    v: Array
    a: Array

    @cached_property
    def extent(self) -> Extent:
        poses = fk(self.robot, self.q[None], engine="numpy")
        given = {"v": self.v[None], "a": self.a[None], "f_ext": np.zeros((1, len(self.robot), 6))}
        return Extent(self.robot, poses[..., :3, 3], given)

    def size(self, term: str) -> float:
        return float(CHECKS[term].size(self.extent)[0])

    @property
    def tau(self) -> Array:
        return rnea(self.robot, self.q, self.v, self.a, engine="numpy")

    @property
    def M(self) -> Array:
        return crba(self.robot, self.q, engine="numpy")


Sides = tuple[Array, Array, float]
"""Two sides, and the size of what adds up in them."""


def symmetry(s: State) -> Sides:
    """M = M^T."""
    return s.M, s.M.T, 0.0


def rate_of_inertia(s: State) -> Sides:
    """dM/dt = C + C^T."""
    C = coriolis(s.robot, s.q, s.v, engine="numpy")
    return C + C.T, along(s.robot, "crba", s.q, s.v), s.size("coriolis")


def work(s: State) -> Sides:
    """d/dt (T + V) = v . tau."""
    rate = along(s.robot, "kinetic_energy", s.q, s.v, (s.v, s.a)) + along(s.robot, "potential_energy", s.q, s.v)
    return np.array([rate]), np.array([s.v @ s.tau]), s.size("rnea") * float(s.extent.speed[0])


def splitting(s: State) -> Sides:
    """bias = C v + gravity."""
    parts = coriolis(s.robot, s.q, s.v, engine="numpy") @ s.v + gravity(s.robot, s.q, engine="numpy")
    return bias(s.robot, s.q, s.v, engine="numpy"), parts, s.size("bias")


def motion(s: State) -> Sides:
    """The world's Jacobian times v is dT/dt T^-1."""
    tool = s.robot.frames[-1]
    T, rate = fk(s.robot, s.q, tool, engine="numpy"), along(s.robot, "frame_pose", s.q, s.v, frame=tool)
    moved = rate @ inverted(T)
    twist = np.array([moved[2, 1], moved[0, 2], moved[1, 0], *moved[:3, 3]])
    J = jacobian(s.robot, s.q, tool, "world", engine="numpy")
    return J @ s.v, twist, s.size("frame_velocity")


def forward(s: State) -> Sides:
    """aba(rnea(a)) = a, within the condition of M."""
    mass = MassMatrices(s.M[None])
    if mass.hopeless[0]:
        raise Skipped("M is singular to working precision")
    forces = np.abs(s.tau) + np.abs(bias(s.robot, s.q, s.v, engine="numpy"))
    bound = solution(s.robot, mass, forces[None], s.a[None], s.extent)
    if bound.empty[0]:
        raise Skipped("M is singular within its rounding")
    scale = float(max(1.0, np.abs(s.a).max(initial=0.0)))
    return aba(s.robot, s.q, s.v, s.tau, engine="numpy"), s.a, float(bound.value[0] / rounding(s.robot)) * scale


def table(s: State) -> Sides:
    """The DH table of the chain to the tool has the same forward kinematics."""
    try:
        dh = to_dh(s.robot, tip="tool")
    except DualpinError as e:
        raise Skipped(str(e).partition(";")[0]) from None
    lengths = np.abs(dh.columns[:, 1:3]).max(initial=0.0)
    size = (1.0 + lengths) * len(dh.rows) + float(s.extent.reach[0])
    return dh.fk(s.q, engine="numpy"), fk(s.robot, s.q, "tool", engine="numpy"), size / ORDINARY


def written(s: State) -> Sides:
    """The written URDF, read again, has the same inverse dynamics without gravity and rotors."""
    plain = s.robot.with_gravity((0.0, 0.0, 0.0))
    if any(float(x) for j in plain for x in j.armature):
        raise Skipped("a URDF has no rotors")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DualpinWarning)
            again = loads(plain.to_urdf(), plain.floating, plain.coupled).with_gravity((0.0, 0.0, 0.0))
    except DualpinError as e:
        raise Skipped(str(e).partition(";")[0]) from None
    if again.nq != plain.nq:
        raise Skipped("URDF splits a joint of it")
    ours, theirs = (rnea(r, s.q, s.v, s.a, engine="numpy") for r in (plain, again))
    return theirs, ours, s.size("rnea") * (1 + ORDINARY * _turned(plain, again) / rounding(plain))


def _turned(a: Robot, b: Robot) -> float:
    """How far screws are apart that the reader takes for coordinate axes, being within 1e-12 of them (`io.axes`)."""
    screws = [
        sorted(((k, *map(float, (*s.real, *s.dual))) for j in r for k, s in j.dofs), key=itemgetter(0)) for r in (a, b)
    ]
    apart = [abs(x - y) for before, after in zip(*screws, strict=True) for x, y in zip(before, after, strict=True)]
    return max((x for x in apart if x < 2 * TOLERANCE), default=0.0)


IDENTITIES: dict[str, Callable[[State], Sides]] = {
    f.__name__: f for f in (symmetry, rate_of_inertia, work, splitting, motion, forward, table, written)
}


def identities(robot: Robot, seed: int, names: Iterable[str] = IDENTITIES) -> dict[str, TermResult]:
    """Each identity, or some, at one random state."""
    given = states(robot, 1, seed)
    s = State(robot, given["q"][0], given["v"][0], given["a"][0])
    return {name: _checked(s, name, IDENTITIES[name]) for name in names}


def _checked(s: State, name: str, identity: Callable[[State], Sides]) -> TermResult:
    law = (identity.__doc__ or name).strip().rstrip(".")
    try:
        with np.errstate(all="ignore"):
            x, y, size = identity(s)
    except Skipped as e:
        return TermResult(status=NOT_COMPARED, reason=str(e), oracle=law)
    error = float(scaled_error(x.reshape(1, -1), y.reshape(1, -1))[0][0])
    reference = float(max(1.0, np.abs(y).max(initial=0.0)))
    bound = 0.0 if name == "symmetry" else SAFETY * rounding(s.robot) * max(1.0, size / reference)
    found = TermResult(
        error, bound, oracle=law, compared=1, status=AGREES,
        tolerance_reason=f"{SAFETY:g} x the rounding of {depth(s.robot)} bodies x what adds up / the largest entry",
    )  # fmt: skip
    if not error <= bound:
        found.settle(DIFFERS, ORACLE, f"{law} is off by {error:.1e}, {bound:.1e} expected")
    return found
