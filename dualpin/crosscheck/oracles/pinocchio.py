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
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import DualpinError, nearest
from ...model.robot import Frame, Joint, Robot
from ...terms import TERMS

ANGULAR_FIRST = [3, 4, 5, 0, 1, 2]
# what Pinocchio computes on models with mimic joints (4.1: the others throw, or are not documented to)
NATIVE_WITH_MIMIC = frozenset({"fk", "frame_pose", "jacobian", "rnea", "bias", "gravity", "crba"})


class OracleError(DualpinError):
    """The oracle is missing, or refuses the robot."""


def import_pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError as e:
        raise OracleError(f"validation needs Pinocchio (pip install pin): {e}") from None
    return pinocchio


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """urdfdom writes its complaints to the process's stderr; they come back as exceptions anyway."""
    sys.stderr.flush()
    saved, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(null)


def build(path: str, floating: bool, mimic: bool) -> Any:
    """Pinocchio's own model of a URDF file, or an `OracleError` with its reason."""
    pin = import_pinocchio()
    root = (pin.JointModelFreeFlyer(),) if floating else ()
    with _silent():
        try:
            return pin.buildModelFromUrdf(path, *root, mimic=mimic)
        except Exception as e:  # whatever the binding throws is its refusal
            raise OracleError(f"Pinocchio refuses {Path(path).name}: {str(e).strip().splitlines()[0]}") from None


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

    def _add(self, robot: Robot, joint: Joint, pin_joint: Any) -> None:
        if pin_joint.nv == 0 or "Mimic" in pin_joint.shortname():
            return  # Pinocchio moves it with its leader
        kind = pin_joint.shortname().removeprefix("JointModel")
        to_q, to_v = slice(pin_joint.idx_q, pin_joint.idx_q + pin_joint.nq), pin_joint.idx_v
        leader, multiplier, offset = leading(robot, joint)
        q, v = joint.q, joint.v.start
        if kind == "FreeFlyer":
            order = [q.start + k for k in (0, 1, 2, 4, 5, 6, 3)]
            self.G[to_v : to_v + 6, v : v + 6] = np.eye(6)[ANGULAR_FIRST]
            self._moves.append(lambda ours, pins: pins.__setitem__((..., to_q), ours[..., order]))
        elif kind == "Planar":
            self.G[to_v : to_v + 3, v : v + 3] = np.eye(3)

            def planar(ours: np.ndarray, pins: np.ndarray) -> None:
                x, y, angle = np.moveaxis(ours[..., q], -1, 0)
                pins[..., to_q] = np.stack([x, y, np.cos(angle), np.sin(angle)], -1)

            self._moves.append(planar)
        else:
            self.G[to_v, leader.v.start] = multiplier

            def axial(ours: np.ndarray, pins: np.ndarray) -> None:
                x = multiplier * ours[..., leader.q] + offset
                pins[..., to_q] = x if pin_joint.nq == 1 else np.concatenate([np.cos(x), np.sin(x)], -1)

            self._moves.append(axial)

    def q(self, ours: np.ndarray) -> np.ndarray:
        """(n, nq) of dualpin to (n, nq) of Pinocchio."""
        pins = np.zeros((*ours.shape[:-1], self.model.nq))
        for move in self._moves:
            move(ours, pins)
        return pins


def leading(robot: Robot, joint: Joint) -> tuple[Joint, float, float]:
    """The joint that leads in the end, with the multiplier and offset of all that follow."""
    multiplier, offset = 1.0, 0.0
    while joint.mimic is not None:
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        joint = robot.joint(joint.mimic.joint)
    return joint, multiplier, offset


class Pinocchio:
    """The terms of one robot, computed by Pinocchio from the same URDF file.

    Attributes
    ----------
    refusal : str or None
        Why Pinocchio does not build the robot with mimic, if it was asked and does not.
    """

    def __init__(self, robot: Robot, path: str, floating: bool, mimic: bool) -> None:
        self.pin, self.robot = import_pinocchio(), robot
        self.free = Layout(robot, build(path, floating, mimic=False))
        self.coupled: Layout | None = None
        self.refusal: str | None = None
        if mimic and robot.coupled:
            try:
                self.coupled = Layout(robot, build(path, floating, mimic=True))
            except OracleError as e:
                self.refusal = str(e)

    @property
    def version(self) -> str:
        return str(self.pin.__version__)

    def source(self, term: str) -> str:
        """ "Pinocchio", or "Pinocchio, projected" where it cannot do the coupled model."""
        return "Pinocchio" if not self.robot.coupled or self._native(term) else "Pinocchio, projected"

    def _native(self, term: str) -> bool:
        return self.coupled is not None and term in NATIVE_WITH_MIMIC

    def compute(self, term: str, states: dict[str, np.ndarray], **options: Any) -> np.ndarray:
        """A term on states (n, size), in dualpin's conventions, shape (n, ...)."""
        shape = TERMS[term].shape(self.robot, **options)
        if 0 in shape:  # a robot without joints: Pinocchio 4.1 crashes on Jacobians without columns
            return np.zeros((len(states["q"]), *shape))
        layout = self.coupled if self._native(term) and self.coupled is not None else self.free
        one = getattr(self, "_" + term)
        data, G = layout.model.createData(), layout.G
        pins = dict(states)
        for key in ("q", "q1"):
            if key in states:
                pins[key] = layout.q(states[key])
        for key in ("v", "a"):
            if key in states:
                pins[key] = states[key] @ G.T
        if "tau" in states and not self.robot.coupled:  # G is a permutation then
            pins["tau"] = states["tau"] @ G.T
        rows = zip(*pins.values(), strict=True)
        with np.errstate(all="ignore"):  # a singular M gives nan, which the comparison knows
            results = [one(layout.model, data, G, dict(zip(pins, row, strict=True)), **options) for row in rows]
        return np.array(results)

    # --- one sample of each term ---------------------------------------------------------------------

    def _fk(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        self.pin.forwardKinematics(m, d, s["q"])
        return np.array([d.oMi[i].homogeneous for i in range(1, m.njoints)]).reshape(-1, 4, 4)

    def _frame_pose(self, m: Any, d: Any, G: np.ndarray, s: Any, frame: Frame) -> np.ndarray:
        self.pin.framesForwardKinematics(m, d, s["q"])
        return d.oMf[self._frame(m, frame)].homogeneous.copy()

    def _frame(self, m: Any, frame: Frame) -> int:
        """Pinocchio's index of a frame; a link and a joint may share a name, so the kind counts."""
        kinds = {"joint": self.pin.JOINT, "fixed_joint": self.pin.FIXED_JOINT, "link": self.pin.BODY}
        named = [(i, f.type) for i, f in enumerate(m.frames) if f.name == frame.name]
        if not named:
            raise OracleError(
                f"Pinocchio has no frame {frame.name!r}; {nearest(frame.name, [f.name for f in m.frames])}"
            )
        return next((i for i, kind in named if kind == kinds.get(frame.kind)), named[0][0])

    def _reference(self, reference: str) -> Any:
        return {
            "world": self.pin.WORLD,
            "local": self.pin.LOCAL,
            "local_world_aligned": self.pin.LOCAL_WORLD_ALIGNED,
        }[reference]

    def _jacobian(self, m: Any, d: Any, G: np.ndarray, s: Any, frame: Frame, reference: str) -> np.ndarray:
        self.pin.computeJointJacobians(m, d, s["q"])
        self.pin.updateFramePlacements(m, d)
        return self.pin.getFrameJacobian(m, d, self._frame(m, frame), self._reference(reference))[ANGULAR_FIRST] @ G

    def _jacobian_dot(self, m: Any, d: Any, G: np.ndarray, s: Any, frame: Frame, reference: str) -> np.ndarray:
        self.pin.computeJointJacobiansTimeVariation(m, d, s["q"], s["v"])
        self.pin.updateFramePlacements(m, d)
        dJ = self.pin.getFrameJacobianTimeVariation(m, d, self._frame(m, frame), self._reference(reference))
        return dJ[ANGULAR_FIRST] @ G

    def _frame_velocity(self, m: Any, d: Any, G: np.ndarray, s: Any, frame: Frame, reference: str) -> np.ndarray:
        self.pin.forwardKinematics(m, d, s["q"], s["v"])
        self.pin.updateFramePlacements(m, d)
        return self.pin.getFrameVelocity(m, d, self._frame(m, frame), self._reference(reference)).vector[ANGULAR_FIRST]

    def _frame_acceleration(
        self, m: Any, d: Any, G: np.ndarray, s: Any, frame: Frame, reference: str, classical: bool
    ) -> np.ndarray:
        self.pin.forwardKinematics(m, d, s["q"], s["v"], s["a"])
        self.pin.updateFramePlacements(m, d)
        get = self.pin.getFrameClassicalAcceleration if classical else self.pin.getFrameAcceleration
        return get(m, d, self._frame(m, frame), self._reference(reference)).vector[ANGULAR_FIRST]

    def _rnea(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.rnea(m, d, s["q"], s["v"], s["a"])

    def _wrenches(self, f_ext: np.ndarray) -> Any:
        forces = self.pin.StdVec_Force()
        forces.append(self.pin.Force.Zero())
        for f in f_ext.reshape(-1, 6):
            forces.append(self.pin.Force(f[3:], f[:3]))
        return forces

    def _rnea_f_ext(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.rnea(m, d, s["q"], s["v"], s["a"], self._wrenches(s["f_ext"]))

    def _bias(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.nonLinearEffects(m, d, s["q"], s["v"])

    def _gravity(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.computeGeneralizedGravity(m, d, s["q"])

    def _crba(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        upper = np.triu(self.pin.crba(m, d, s["q"]))
        return G.T @ (upper + np.triu(upper, 1).T) @ G

    def _coriolis(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.computeCoriolisMatrix(m, d, s["q"], s["v"]) @ G

    def _aba(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        if self.robot.coupled:
            h = G.T @ self.pin.nonLinearEffects(m, d, s["q"], s["v"])
            return _solve(self._crba(m, d, G, s), s["tau"] - h)
        return G.T @ self.pin.aba(m, d, s["q"], s["v"], s["tau"])

    def _minv(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        if self.robot.coupled:
            return _solve(self._crba(m, d, G, s), np.eye(G.shape[1]))
        upper = np.triu(self.pin.computeMinverse(m, d, s["q"]))
        return G.T @ (upper + np.triu(upper, 1).T) @ G

    def _kinetic_energy(self, m: Any, d: Any, G: np.ndarray, s: Any) -> float:
        return self.pin.computeKineticEnergy(m, d, s["q"], s["v"])

    def _potential_energy(self, m: Any, d: Any, G: np.ndarray, s: Any) -> float:
        return self.pin.computePotentialEnergy(m, d, s["q"])

    def _com(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return self.pin.centerOfMass(m, d, s["q"]).copy()

    def _com_jacobian(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return self.pin.jacobianCenterOfMass(m, d, s["q"]) @ G

    def _centroidal_momentum_matrix(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return self.pin.computeCentroidalMap(m, d, s["q"])[ANGULAR_FIRST] @ G

    def _joint_torque_regressor(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return G.T @ self.pin.computeJointTorqueRegressor(m, d, s["q"], s["v"], s["a"])

    def _difference(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        return np.linalg.pinv(G) @ self.pin.difference(m, s["q"], s["q1"])

    def _rnea_derivatives(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        dq, dv, da = self.pin.computeRNEADerivatives(m, d, s["q"], s["v"], s["a"])
        full = np.triu(da) + np.triu(da, 1).T
        return np.array([G.T @ x @ G for x in (dq, dv, full)])

    def _aba_derivatives(self, m: Any, d: Any, G: np.ndarray, s: Any) -> np.ndarray:
        dq, dv, dtau = self.pin.computeABADerivatives(m, d, s["q"], s["v"], s["tau"])[:3]
        full = np.triu(dtau) + np.triu(dtau, 1).T
        return np.array([G.T @ x @ G for x in (dq, dv, full)])


def _solve(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(M, b)
    except np.linalg.LinAlgError:
        return np.full_like(b, np.nan)
