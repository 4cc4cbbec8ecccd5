"""Effects of faults on terms: the largest change over a few states.

Torques are linear in the ten parameters of a body, so the regressor gives their change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...call import evaluate
from ...model.robot import Robot
from ...spatial.inertia import Inertia
from ...spatial.pose import Pose
from ...spatial.vector import Twist
from .description import Body, placed
from .findings import Effect

STATES = 8
NOTHING = 1e-12  # relative to a term's largest value: counts as no change


class Effects:
    """The terms of one robot at a few states, computed at first use."""

    def __init__(self, robot: Robot, floating: Callable[[], Robot | None] = lambda: None) -> None:
        self.robot, self._floating = robot, floating

    @cached_property
    def floating(self) -> Effects | None:
        """Those of the same robot on a floating base."""
        robot = self._floating()
        return None if robot is None else Effects(robot)

    @cached_property
    def states(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.robot.sample(STATES, seed=0)

    def _columns(self, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        inputs = {"q": self.states[0], "v": v, "a": a}
        Y = evaluate(self.robot, "joint_torque_regressor", inputs, engine="numpy")
        return np.asarray(Y[..., : 10 * len(self.robot)])  # rotors come after the bodies

    @cached_property
    def at_rest(self) -> np.ndarray:
        """(states, nv, 10 bodies) of the gravity torques."""
        zero = np.zeros_like(self.states[1])
        return self._columns(zero, zero)

    @cached_property
    def moving(self) -> np.ndarray:
        """The same of the torques in motion."""
        return self._columns(*self.states[1:])

    @cached_property
    def parameters(self) -> np.ndarray:
        return np.array([float(x) for j in self.robot for x in j.inertia.parameters])

    def of_body(self, body: Body, mass: float, com: np.ndarray, tensor: np.ndarray) -> Effect:
        """The change of the torques if the body had these parameters instead."""
        j = body.carrier
        if j is None and self.floating is not None:
            base = replace(body, carrier=self.floating.robot.joints[0])
            found = self.floating.of_body(base, mass, com, tensor)
            return replace(
                found, says=found.says.replace("torque", "wrench", 1).replace("joint 'root_joint'", "a floating base")
            )
        if j is None:
            return Effect("", 0.0, "", "the link stands on the ground, so no torque changes until its base floats")
        if not self.robot.nv:
            return Effect("", 0.0, "", "no joint moves, so no term changes")
        X = placed(body.placement)
        new, old = ((X @ Inertia.of(*x)).array for x in ((mass, com, tensor), (body.mass, body.com, body.tensor)))
        change = new - old
        block = slice(10 * j.index, 10 * j.index + 10)
        for term, Y, words in (("gravity", self.at_rest, "gravity torque"), ("rnea", self.moving, "torque in motion")):
            delta = np.abs(Y[..., block] @ change)
            of = np.abs(Y @ self.parameters)
            k = int(np.unravel_index(int(delta.argmax()), delta.shape)[1]) if delta.size else 0
            amount, largest = float(delta[:, k].max()), float(of[:, k].max())
            if amount > NOTHING * max(1.0, float(of.max())) or term == "rnea":
                return self._torque(term, words, k, amount, largest)
        raise AssertionError("one of the two returned")

    def _torque(self, term: str, words: str, k: int, amount: float, largest: float) -> Effect:
        j = next(j for j in self.robot if j.v.start <= k < j.v.stop)
        if not amount:
            return Effect(term, 0.0, "N m", "no torque of a joint changes while the base stands still")
        names = j.model.velocity_names
        unit = "N" if _slides(j.model.screws[k - j.v.start]) else "N m"
        of = f" {names[k - j.v.start]}" if len(names) > 1 else ""
        says = (
            f"the {words} of joint {j.name!r}{of} changes by up to {amount:.3g} {unit}, of at most {largest:.3g} {unit}"
        )
        return Effect(term, amount, unit, says)

    def reach_below(self, name: str) -> tuple[float, str]:
        """The largest possible distance of a frame beyond a joint from it [m], and that frame's name."""
        j = self.robot.joint(name)
        below: dict[int, float] = {j.index: 0.0}
        for k in self.robot:
            if k.parent is not None and k.parent.index in below:
                slide = max((abs(x) for x in (*k.limits.lower, *k.limits.upper) if np.isfinite(x)), default=0.0)
                slide = slide if any(_slides(s) for s in k.model.screws) else 0.0
                below[k.index] = below[k.parent.index] + _length(k.placement) + slide
        best = (0.0, j.name)
        for f in self.robot.frames:
            if f.joint is not None and f.joint.index in below:
                best = max(best, (below[f.joint.index] + _length(f.placement), f.name))
        return best


def _length(X: Pose) -> float:
    return float(np.linalg.norm(X.position.array))


def _slides(screw: Twist) -> bool:
    """Whether a motion is a pure translation."""
    return not any(float(c) for c in screw.real)
