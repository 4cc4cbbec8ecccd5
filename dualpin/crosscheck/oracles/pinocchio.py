"""Pinocchio as oracle; this module converts its conventions.

Pinocchio's six-vectors are linear first, its free flyer's velocity is [v; w] and quaternion
(x, y, z, w), continuous joints and the angle of planar ones are (cos, sin), `crba` fills one
triangle.  Everything comes back in dualpin's conventions.

Pinocchio is a subject as any other: `Layout` says how it writes, and the algebra of `subjects.algebra`
brings its answers home.  Where joints follow others (mimic) G has a row for each of them, so that what
Pinocchio says of free joints is projected, whether it can build the coupled model or not.  Where it can, its own
coupled model answers what it supports.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ...algorithms.regressor import rotors
from ...errors import nearest
from ...model.robot import Frame, Joint, Robot
from ...terms import TERMS
from .. import subjects
from ..checks import CHECKS
from ..reading import Description
from ..subjects.algebra import Change
from ..subjects.convention import Convention, names_of
from .oracle import Oracle, OracleError
from .pinocchio_model import ANGULAR_FIRST, assembled, build, described, import_pinocchio, read

LINEAR_FIRST = ("vx", "vy", "vz", "wx", "wy", "wz")
# what Pinocchio computes on models with mimic joints (4.1: the others throw, or are not documented to)
NATIVE_WITH_MIMIC = frozenset({"fk", "frame_pose", "jacobian", "rnea", "bias", "gravity", "crba"})


class Layout(subjects.Layout):
    """How a robot's q and v become those of a Pinocchio model, and its answers dualpin's."""

    def __init__(self, robot: Robot, model: Any) -> None:
        names = list(model.names)[1:]
        if names != robot.joint_names:
            raise OracleError(f"{robot.name}: joints differ: dualpin {robot.joint_names}, Pinocchio {names}")
        moving = [(j, p) for j, p in zip(robot, list(model.joints)[1:], strict=True) if _moves(p)]
        q, v = ([n for j, _ in moving for n in written(robot, j)[i]] for i in (0, 1))
        super().__init__(robot, Convention(tuple(q), tuple(v), rows=LINEAR_FIRST), followers=True)
        self.model = model
        self.circles = [k == "angle" and p.nq > p.nv for j, p in moving for k in j.model.coordinates]
        (G,), _ = self.matrices(np.zeros((1, robot.nq)), np.zeros((1, robot.nv)))
        self.constant = Change(G)
        self.rotors = _rotor_columns(robot)
        # each term has data of its own, since some fill only what they need; those of a large robot take
        # longer to make than a batch, and 40 MB
        self.data = lru_cache(maxsize=4)(lambda pin, term: QUESTIONS[term].data(pin, model))

    @property
    def G(self) -> np.ndarray:
        """v of Pinocchio is G v."""
        return self.constant.G

    def change(self, ours: Mapping[str, np.ndarray]) -> Change:
        """The base's velocity is written in its own axes by both: G does not depend on the state."""
        return self.constant

    def of(self, ours: dict[str, np.ndarray], coupled: bool) -> dict[str, np.ndarray]:
        """Sampled quantities as Pinocchio takes them."""
        how = {"q": self.q, "q1": self.q, "v": self.v, "a": self.v}
        if not coupled:  # G is a permutation then, good for forces too
            how["tau"] = self.v
        return {key: how[key](x) if key in how else x for key, x in ours.items()}

    def v(self, ours: np.ndarray) -> np.ndarray:
        """(n, nv) of dualpin to (n, nv) of Pinocchio."""
        return ours @ self.G.T

    def q(self, ours: np.ndarray) -> np.ndarray:
        """(n, nq) of dualpin to (n, nq) of Pinocchio, which writes some angles as (cos, sin)."""
        columns: list[np.ndarray] = []
        for x, circle in zip(np.moveaxis(self.positions(ours), -1, 0), self.circles, strict=True):
            columns += [np.cos(x), np.sin(x)] if circle else [x]
        return np.stack(columns, -1) if columns else np.zeros((*ours.shape[:-1], 0))


def _moves(joint: Any) -> bool:
    """Whether Pinocchio counts it; others it moves with their leaders."""
    return joint.nv > 0 and "Mimic" not in joint.shortname()


def written(robot: Robot, joint: Joint) -> tuple[Sequence[str], Sequence[str]]:
    """The names of a joint's columns, in Pinocchio's order: quaternions x y z w, velocities linear first."""
    q, v = names_of(robot, joint)
    kinds = joint.model.coordinates
    if "quaternion" not in kinds:
        return q, v
    w = kinds.index("quaternion")
    return [*q[:w], *q[w + 1 :], q[w]], [v[i] for i in ANGULAR_FIRST] if len(v) == 6 else v


def _rotor_columns(robot: Robot) -> list[int]:
    """In the order of dualpin's regressor, where Pinocchio's velocities of each joint are; none without rotors."""
    columns: list[int] = []
    for j in robot:
        n = j.model.nv
        columns += [len(columns) + k for k in (ANGULAR_FIRST if n == 6 else range(n))]
    return columns if rotors(robot) else []


class Pinocchio(Oracle):
    """The terms of one robot, computed by Pinocchio.

    Parameters
    ----------
    model
        Pinocchio's model, in which joints that follow another are free.
    complaints : sequence of str
        What was said when it was read.
    coupled
        Its model in which they follow, if it has one.
    refusal : str, optional
        Why it has none.
    """

    name = "Pinocchio"

    def __init__(
        self, robot: Robot, model: Any, complaints: tuple[str, ...] = (), coupled: Any = None, refusal: str = ""
    ) -> None:
        self.pin, self.robot, self.refusal = import_pinocchio(), robot, refusal
        self.free = Layout(robot, model)
        self.coupled = None if coupled is None else Layout(robot, coupled)
        self.description = described(model, complaints)

    @classmethod
    def version(cls) -> str:
        return str(import_pinocchio().__version__)

    @classmethod
    def described(cls, path: str, floating: bool) -> Description:
        return described(*read(path, floating, mimic=False))

    @classmethod
    def of_file(cls, robot: Robot, path: str, floating: bool) -> Pinocchio:
        """As Pinocchio itself reads the URDF file of the robot."""
        model, complaints = read(path, floating, mimic=False)
        coupled, refusal = None, ""
        if robot.coupled:
            try:
                coupled = build(path, floating, mimic=True)
            except OracleError as e:
                refusal = str(e)
        return cls(robot, model, complaints, coupled, refusal)

    @classmethod
    def of_robot(cls, robot: Robot) -> Pinocchio:
        """Put together from the robot's own joints, bodies and gravity."""
        return cls(robot, assembled(robot))

    def source(self, term: str) -> str:
        return "Pinocchio" if not self.robot.coupled or self._native(term) else "Pinocchio, projected"

    def _native(self, term: str) -> bool:
        return self.coupled is not None and term in NATIVE_WITH_MIMIC

    def compute(
        self, term: str, states: dict[str, np.ndarray], variants: Sequence[dict[str, Any]] = ({},)
    ) -> list[np.ndarray]:
        shapes = [TERMS[term].shape(self.robot, **options) for options in variants]
        n = len(states["q"])
        if 0 in shapes[0]:  # a robot without joints: Pinocchio 4.1 crashes on Jacobians without columns
            return [np.zeros((n, *shape)) for shape in shapes]
        if self.robot.coupled and CHECKS[term].solves:
            return [self._solved(term, states)]
        layout = self.coupled if self._native(term) and self.coupled is not None else self.free
        m, question = layout.model, QUESTIONS[term]
        d = layout.data(self.pin, term)
        choices = [self._chosen(m, options) for options in variants]
        answers: list[np.ndarray] = []
        rows = layout.of({k: states[k] for k in CHECKS[term].inputs.values()}, coupled=self.robot.coupled)
        with np.errstate(all="ignore"):  # a singular M gives nan, which the comparison knows
            for k, one in enumerate(zip(*rows.values(), strict=True)):
                found = question.run(self.pin, m, d, dict(zip(rows, one, strict=True)))
                read = question.read
                values = [found] if read is None else [read(self.pin, m, d, *choice) for choice in choices]
                if not answers:
                    answers = [np.empty((n, *np.shape(x))) for x in values]
                for answer, x in zip(answers, values, strict=True):
                    answer[k] = x  # copied: what the binding returns may live in its data
            if m.nv == 1:  # the binding leaves out the axis of a single column
                answers = [
                    a.reshape(n, *shape[:-1], -1) if shape else a for a, shape in zip(answers, shapes, strict=True)
                ]
            found = [layout.read(CHECKS[term].form, question.whole(a, layout), {}) for a in answers]
            return [x.reshape(n, *shape) for x, shape in zip(found, shapes, strict=True)]

    def offers(self, options: Mapping[str, Any]) -> bool:
        frame = options.get("frame")
        return frame is None or any(f.name == frame.name for f in self.free.model.frames)

    def _chosen(self, m: Any, options: dict[str, Any]) -> list[Any]:
        """Options as Pinocchio's: frame's index, reference, classical."""
        references = {
            "world": self.pin.WORLD, "local": self.pin.LOCAL, "local_world_aligned": self.pin.LOCAL_WORLD_ALIGNED
        }  # fmt: skip
        how: dict[str, Callable[[Any], Any]] = {
            "frame": lambda f: self._frame(m, f),
            "reference": references.get,
            "classical": bool,
        }
        return [how[key](value) for key, value in options.items()]

    def _frame(self, m: Any, frame: Frame) -> int:
        """Pinocchio's index of a frame; a link and a joint may share a name, so the kind counts."""
        kinds = {"joint": self.pin.JOINT, "fixed_joint": self.pin.FIXED_JOINT, "link": self.pin.BODY}
        named = [(i, f.type) for i, f in enumerate(m.frames) if f.name == frame.name]
        if not named:
            raise OracleError(
                f"Pinocchio has no frame {frame.name!r}; {nearest(frame.name, [f.name for f in m.frames])}"
            )
        return next((i for i, kind in named if kind == kinds.get(frame.role)), named[0][0])

    def _solved(self, term: str, states: dict[str, np.ndarray]) -> np.ndarray:
        """Forward dynamics of a coupled robot, which Pinocchio does not do: its M and h, and NumPy's solve."""
        (M,) = self.compute("crba", states)
        if term == "minv":
            return _solve(M, np.broadcast_to(np.eye(M.shape[-1]), M.shape))
        if term == "aba_derivatives":
            a = self._solved("aba", states)
            (D,) = self.compute("rnea_derivatives", {**states, "a": a})
            inverse = self._solved("minv", states)
            return np.stack([-inverse @ D[:, 0], -inverse @ D[:, 1], inverse], axis=1)
        (h,) = self.compute("bias", states)
        return _solve(M, (states["tau"] - h)[..., None])[..., 0]


def _solve(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solutions of a batch of systems; nan where one is singular."""
    x = np.full(b.shape, np.nan)
    for k in range(len(M)):
        with contextlib.suppress(np.linalg.LinAlgError):
            x[k] = np.linalg.solve(M[k], b[k])
    return x


# --- the questions -------------------------------------------------------------------------------
#
# run computes a sample, read picks what a variant asks for, whole fills what Pinocchio leaves open; the form of
# the term's check says how the layout rewrites all samples in dualpin's conventions at once.


def _mirrored(x: np.ndarray, to: Layout) -> np.ndarray:
    """A symmetric matrix of which the upper triangle is filled."""
    return np.where(np.tri(x.shape[-1], k=-1, dtype=bool), np.swapaxes(x, -1, -2), x)


def _last_mirrored(x: np.ndarray, to: Layout) -> np.ndarray:
    """Derivatives by q, by v, and a symmetric matrix."""
    return np.concatenate([x[:, :2], _mirrored(x[:, 2:], to)], axis=1)


def _with_rotors(Y: np.ndarray, to: Layout) -> np.ndarray:
    """The columns of the bodies, and of rotors where there are any; Pinocchio's own has none, they are diag(a)."""
    bodies = 10 * (to.model.njoints - 1)
    return np.concatenate([Y[..., :bodies], Y[..., bodies:][..., to.rotors]], axis=-1)


def _regressed(pin: Any, m: Any, d: Any, s: dict[str, np.ndarray]) -> np.ndarray:
    Y = pin.computeJointTorqueRegressor(m, d, s["q"], s["v"], s["a"])
    return np.hstack([np.reshape(Y, (m.nv, -1)), np.diag(s["a"])])


@dataclass(frozen=True)
class Question:
    """How Pinocchio computes a term: run(pin, model, data, state), then read(pin, model, data, *options)."""

    run: Callable[..., Any]
    read: Callable[..., Any] | None = None
    data: Callable[[Any, Any], Any] = lambda pin, m: m.createData()
    whole: Callable[[np.ndarray, Layout], np.ndarray] = lambda x, to: x


def _motion(pin: Any, m: Any, d: Any, s: dict[str, np.ndarray]) -> None:
    pin.forwardKinematics(m, d, s["q"], s["v"], *([s["a"]] if "a" in s else []))
    pin.updateFramePlacements(m, d)


def _jacobians(pin: Any, m: Any, d: Any, s: dict[str, np.ndarray]) -> None:
    if "v" in s:
        pin.computeJointJacobiansTimeVariation(m, d, s["q"], s["v"])
    else:
        pin.computeJointJacobians(m, d, s["q"])
    pin.updateFramePlacements(m, d)


def _acceleration(pin: Any, m: Any, d: Any, frame: int, reference: Any, classical: bool) -> np.ndarray:
    get = pin.getFrameClassicalAcceleration if classical else pin.getFrameAcceleration
    return get(m, d, frame, reference).vector


def _pushed(pin: Any, m: Any, d: Any, s: dict[str, np.ndarray]) -> np.ndarray:
    data, forces = d
    for force, wrench in zip(forces[1:], s["f_ext"][:, ANGULAR_FIRST], strict=True):  # to [f; n]
        force.vector = wrench
    return pin.rnea(m, data, s["q"], s["v"], s["a"], pin.StdVec_Force(forces))


def _by(function: str) -> Callable[..., Any]:
    """Run a function of Pinocchio's on the term's inputs, in their order."""
    return lambda pin, m, d, s: getattr(pin, function)(m, d, *s.values())


def _first_three(run: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *given: run(*given)[:3]


QUESTIONS = {
    "fk": Question(_by("forwardKinematics"), lambda pin, m, d: np.concatenate([X.homogeneous for X in d.oMi][1:])),
    "frame_pose": Question(_by("framesForwardKinematics"), lambda pin, m, d, frame: d.oMf[frame].homogeneous),
    "jacobian": Question(_jacobians, lambda pin, m, d, f, r: pin.getFrameJacobian(m, d, f, r)),
    "jacobian_dot": Question(_jacobians, lambda pin, m, d, f, r: pin.getFrameJacobianTimeVariation(m, d, f, r)),
    "frame_velocity": Question(_motion, lambda pin, m, d, f, r: pin.getFrameVelocity(m, d, f, r).vector),
    "frame_acceleration": Question(_motion, _acceleration),
    "rnea": Question(_by("rnea")),
    "rnea_f_ext": Question(_pushed, data=lambda pin, m: (m.createData(), [pin.Force.Zero() for _ in range(m.njoints)])),
    "joint_wrenches": Question(_by("rnea"), lambda pin, m, d: np.array([f.vector for f in d.f][1:])),
    "bias": Question(_by("nonLinearEffects")),
    "gravity": Question(_by("computeGeneralizedGravity")),
    "crba": Question(_by("crba"), whole=_mirrored),
    "coriolis": Question(_by("computeCoriolisMatrix")),
    "aba": Question(_by("aba")),
    "minv": Question(_by("computeMinverse"), whole=_mirrored),
    "kinetic_energy": Question(_by("computeKineticEnergy")),
    "potential_energy": Question(_by("computePotentialEnergy")),
    "com": Question(_by("centerOfMass")),
    "com_jacobian": Question(_by("jacobianCenterOfMass")),
    "centroidal_momentum_matrix": Question(_by("computeCentroidalMap")),
    "joint_torque_regressor": Question(_regressed, whole=_with_rotors),
    "rnea_derivatives": Question(_first_three(_by("computeRNEADerivatives")), whole=_last_mirrored),
    "aba_derivatives": Question(_first_three(_by("computeABADerivatives")), whole=_last_mirrored),
    "difference": Question(lambda pin, m, d, s: pin.difference(m, s["q"], s["q1"])),
}
Pinocchio.terms = QUESTIONS.keys()
