"""Pinocchio as oracle: the only place that knows its conventions.

Pinocchio's six-vectors are linear first, its free flyer's velocity is [v; w] and quaternion
(x, y, z, w), continuous joints and the angle of planar ones are (cos, sin), `crba` fills one
triangle.  Everything comes back in dualpin's conventions.

One matrix G does most of it: v_pinocchio = G v.  It permutes, and where joints follow others
(mimic) it projects, so that tau = G^T tau_pin, M = G^T M_pin G, J = J_pin G, whether Pinocchio can
build the coupled model or not.  Where it can, its own coupled model answers what it supports.
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
from ..reading import Description
from .oracle import Oracle, OracleError
from .pinocchio_model import ANGULAR_FIRST, assembled, build, described, import_pinocchio, read

# what Pinocchio computes on models with mimic joints (4.1: the others throw, or are not documented to)
NATIVE_WITH_MIMIC = frozenset({"fk", "frame_pose", "jacobian", "rnea", "bias", "gravity", "crba"})


class Layout:
    """How a robot's q and v become those of a Pinocchio model."""

    def __init__(self, robot: Robot, model: Any) -> None:
        names = list(model.names)[1:]
        if names != robot.joint_names:
            raise OracleError(f"{robot.name}: joints differ: dualpin {robot.joint_names}, Pinocchio {names}")
        self.model, self.G = model, np.zeros((model.nv, robot.nv))
        self._moves: list[Callable[[np.ndarray, np.ndarray], None]] = []
        for i, joint in enumerate(robot, 1):
            self._add(robot, joint, model.joints[i])
        self.runs = _runs(self.G)
        self.rotors = _rotor_columns(robot)
        # each term has data of its own, since some fill only what they need; those of a large robot take
        # longer to make than a batch, and 40 MB
        self.data = lru_cache(maxsize=4)(lambda pin, term: QUESTIONS[term].data(pin, model))

    def _add(self, robot: Robot, joint: Joint, pin_joint: Any) -> None:
        if pin_joint.nv == 0 or "Mimic" in pin_joint.shortname():
            return  # Pinocchio moves it with its leader
        to_q, to_v = slice(pin_joint.idx_q, pin_joint.idx_q + pin_joint.nq), pin_joint.idx_v
        multiplier, offset = map(float, joint.coupling)
        q, v, kinds = joint.q, joint.v, joint.model.coordinates
        if "quaternion" in kinds:  # ours begin with w, Pinocchio's end with it
            first = q.start + kinds.index("quaternion")
            order = [*range(q.start, first), first + 1, first + 2, first + 3, first]
            n = pin_joint.nv
            self.G[to_v : to_v + n, v] = np.eye(n)[ANGULAR_FIRST] if n == 6 else np.eye(n)
            self._moves.append(lambda ours, pins: pins.__setitem__((..., to_q), ours[..., order]))
        elif pin_joint.nv > 1:
            self.G[to_v : to_v + pin_joint.nv, v] = np.eye(pin_joint.nv)
            circles = [k == "angle" and pin_joint.nq > pin_joint.nv for k in kinds]

            def several(ours: np.ndarray, pins: np.ndarray) -> None:
                columns = []
                for x, circle in zip(np.moveaxis(ours[..., q], -1, 0), circles, strict=True):
                    columns += [np.cos(x), np.sin(x)] if circle else [x]
                pins[..., to_q] = np.stack(columns, -1)

            self._moves.append(several)
        else:
            self.G[to_v, v.start] = multiplier

            def axial(ours: np.ndarray, pins: np.ndarray) -> None:
                x = multiplier * ours[..., q] + offset
                pins[..., to_q] = x if pin_joint.nq == 1 else np.concatenate([np.cos(x), np.sin(x)], -1)

            self._moves.append(axial)

    def states(self, ours: dict[str, np.ndarray], coupled: bool) -> dict[str, np.ndarray]:
        """Inputs (n, size) of dualpin to those of Pinocchio."""
        how = {"q": self.q, "q1": self.q, "v": self.v, "a": self.v}
        if not coupled:  # G is a permutation then, good for forces too
            how["tau"] = self.v
        return {key: how[key](x) if key in how else x for key, x in ours.items()}

    def v(self, ours: np.ndarray) -> np.ndarray:
        """(n, nv) of dualpin to (n, nv) of Pinocchio."""
        return ours @ self.G.T

    def columns(self, x: np.ndarray) -> np.ndarray:
        """x G, of the last axis."""
        if not self.runs:
            return x @ self.G
        return x if len(self.runs) == 1 else np.concatenate([x[..., run] for run in self.runs], axis=-1)

    def rows(self, x: np.ndarray) -> np.ndarray:
        """G^T x, of axis 1."""
        if not self.runs:
            return np.moveaxis(np.tensordot(x, self.G, axes=(1, 0)), -1, 1)
        return x if len(self.runs) == 1 else np.concatenate([x[:, run] for run in self.runs], axis=1)

    def q(self, ours: np.ndarray) -> np.ndarray:
        """(n, nq) of dualpin to (n, nq) of Pinocchio."""
        pins = np.zeros((*ours.shape[:-1], self.model.nq))
        for move in self._moves:
            move(ours, pins)
        return pins


def _runs(G: np.ndarray) -> list[slice]:
    """Which rows of G hold the ones of its columns, as runs of neighbours; none where G does more than permute."""
    square = 0 < G.shape[0] == G.shape[1]
    if not (square and ((G == 0) | (G == 1)).all() and (G.sum(axis=0) == 1).all() and (G.sum(axis=1) == 1).all()):
        return []
    order = G.argmax(axis=0)
    return [slice(run[0], run[-1] + 1) for run in np.split(order, np.flatnonzero(np.diff(order) != 1) + 1)]


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
        if self.robot.coupled and QUESTIONS[term].solves:
            return [self._solved(term, states)]
        layout = self.coupled if self._native(term) and self.coupled is not None else self.free
        m, question = layout.model, QUESTIONS[term]
        d = layout.data(self.pin, term)
        choices = [self._chosen(m, options) for options in variants]
        answers: list[np.ndarray] = []
        rows = layout.states(states, coupled=self.robot.coupled)
        with np.errstate(all="ignore"):  # a singular M gives nan, which the comparison knows
            for k, one in enumerate(zip(*rows.values(), strict=True)):
                found = question.run(self.pin, m, d, dict(zip(rows, one, strict=True)))
                read = question.read
                values = [found] if read is None else [read(self.pin, m, d, *choice) for choice in choices]
                if not answers:
                    answers = [np.empty((n, *np.shape(x))) for x in values]
                for answer, x in zip(answers, values, strict=True):
                    answer[k] = x  # copied: what the binding returns may live in its data
            return [question.convert(a, layout).reshape(n, *s) for a, s in zip(answers, shapes, strict=True)]

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
# run computes a sample, read picks what a variant asks for, convert turns all samples into dualpin's
# conventions at once.


def _plain(x: np.ndarray, to: Layout) -> np.ndarray:
    return x


def _six(x: np.ndarray, to: Layout) -> np.ndarray:
    return x[:, ANGULAR_FIRST]


def _columns(x: np.ndarray, to: Layout) -> np.ndarray:
    return to.columns(x)


def _six_columns(x: np.ndarray, to: Layout) -> np.ndarray:
    return to.columns(_six(x, to))


def _forces(x: np.ndarray, to: Layout) -> np.ndarray:
    return to.rows(x)


def _matrix(x: np.ndarray, to: Layout) -> np.ndarray:
    return to.rows(to.columns(x))


def _symmetric(x: np.ndarray, to: Layout) -> np.ndarray:
    """Of which the upper triangle is filled."""
    lower = np.tri(x.shape[-1], k=-1, dtype=bool)
    return _matrix(np.where(lower, np.swapaxes(x, -1, -2), x), to)


def _regressor(x: np.ndarray, to: Layout) -> np.ndarray:
    """Of the bodies, and of rotors where there are any; Pinocchio's own has none, they are diag(a)."""
    Y, bodies = to.rows(x), 10 * (to.model.njoints - 1)
    return np.concatenate([Y[..., :bodies], Y[..., bodies:][..., to.rotors]], axis=-1)


def _regressed(pin: Any, m: Any, d: Any, s: dict[str, np.ndarray]) -> np.ndarray:
    Y = pin.computeJointTorqueRegressor(m, d, s["q"], s["v"], s["a"])
    return np.hstack([np.reshape(Y, (m.nv, -1)), np.diag(s["a"])])


def _derivatives(x: np.ndarray, to: Layout) -> np.ndarray:
    """By q, by v, and a symmetric matrix of which one triangle is filled."""
    return np.stack([_matrix(x[:, 0], to), _matrix(x[:, 1], to), _symmetric(x[:, 2], to)], axis=1)


def _velocities(x: np.ndarray, to: Layout) -> np.ndarray:
    return x @ np.linalg.pinv(to.G).T


@dataclass(frozen=True)
class Question:
    """How Pinocchio computes a term: run(pin, model, data, state), then read(pin, model, data, *options)."""

    run: Callable[..., Any]
    convert: Callable[[np.ndarray, Layout], np.ndarray] = _plain
    read: Callable[..., Any] | None = None
    solves: bool = False
    data: Callable[[Any, Any], Any] = lambda pin, m: m.createData()


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


QUESTIONS = {
    "fk": Question(
        lambda pin, m, d, s: pin.forwardKinematics(m, d, s["q"]),
        read=lambda pin, m, d: np.concatenate([X.homogeneous for X in d.oMi][1:]),
    ),
    "frame_pose": Question(
        lambda pin, m, d, s: pin.framesForwardKinematics(m, d, s["q"]),
        read=lambda pin, m, d, frame: d.oMf[frame].homogeneous,
    ),
    "jacobian": Question(_jacobians, _six_columns, lambda pin, m, d, f, r: pin.getFrameJacobian(m, d, f, r)),
    "jacobian_dot": Question(
        _jacobians, _six_columns, lambda pin, m, d, f, r: pin.getFrameJacobianTimeVariation(m, d, f, r)
    ),
    "frame_velocity": Question(_motion, _six, lambda pin, m, d, f, r: pin.getFrameVelocity(m, d, f, r).vector),
    "frame_acceleration": Question(_motion, _six, _acceleration),
    "rnea": Question(lambda pin, m, d, s: pin.rnea(m, d, s["q"], s["v"], s["a"]), _forces),
    "rnea_f_ext": Question(
        _pushed, _forces, data=lambda pin, m: (m.createData(), [pin.Force.Zero() for _ in range(m.njoints)])
    ),
    "joint_wrenches": Question(
        lambda pin, m, d, s: pin.rnea(m, d, s["q"], s["v"], s["a"]),
        lambda x, to: x[..., ANGULAR_FIRST],
        read=lambda pin, m, d: np.array([f.vector for f in d.f][1:]),
    ),
    "bias": Question(lambda pin, m, d, s: pin.nonLinearEffects(m, d, s["q"], s["v"]), _forces),
    "gravity": Question(lambda pin, m, d, s: pin.computeGeneralizedGravity(m, d, s["q"]), _forces),
    "crba": Question(lambda pin, m, d, s: pin.crba(m, d, s["q"]), _symmetric),
    "coriolis": Question(lambda pin, m, d, s: pin.computeCoriolisMatrix(m, d, s["q"], s["v"]), _matrix),
    "aba": Question(lambda pin, m, d, s: pin.aba(m, d, s["q"], s["v"], s["tau"]), _forces, solves=True),
    "minv": Question(lambda pin, m, d, s: pin.computeMinverse(m, d, s["q"]), _symmetric, solves=True),
    "kinetic_energy": Question(lambda pin, m, d, s: pin.computeKineticEnergy(m, d, s["q"], s["v"])),
    "potential_energy": Question(lambda pin, m, d, s: pin.computePotentialEnergy(m, d, s["q"])),
    "com": Question(lambda pin, m, d, s: pin.centerOfMass(m, d, s["q"])),
    "com_jacobian": Question(lambda pin, m, d, s: pin.jacobianCenterOfMass(m, d, s["q"]), _columns),
    "centroidal_momentum_matrix": Question(lambda pin, m, d, s: pin.computeCentroidalMap(m, d, s["q"]), _six_columns),
    "joint_torque_regressor": Question(_regressed, _regressor),
    "rnea_derivatives": Question(
        lambda pin, m, d, s: pin.computeRNEADerivatives(m, d, s["q"], s["v"], s["a"])[:3], _derivatives
    ),
    "aba_derivatives": Question(
        lambda pin, m, d, s: pin.computeABADerivatives(m, d, s["q"], s["v"], s["tau"])[:3], _derivatives, solves=True
    ),
    "difference": Question(lambda pin, m, d, s: pin.difference(m, s["q"], s["q1"]), _velocities),
}
Pinocchio.terms = QUESTIONS.keys()
