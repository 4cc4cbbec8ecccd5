"""A robot at zero configuration in the world frame: screws, bodies and links, independent of its frames.

At zero a motion is the screw of its joint, and a body its ten parameters; frames of links and joints no longer
matter (Brockett 1984).  Bodies are nodes, joints are edges: which of the bodies stands on the ground is not part of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...functions import fk
from ...model.robot import Joint, Robot
from ...spatial.adjoint import adjoint
from ...spatial.inertia import Inertia
from ...spatial.pose import Pose


@dataclass(frozen=True)
class Edge:
    """A joint between two bodies, with the screws (nv, 6), [w; v], of its velocities in the world."""

    joint: Joint
    inner: int
    outer: int
    screws: np.ndarray


class Home:
    """The bodies and joints of a robot at zero; body 0 is the ground, body i + 1 what joint i moves."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        q = robot.neutral
        poses = fk(robot, q, engine="numpy") if len(robot) else np.zeros((0, 4, 4))
        self.poses = [np.eye(4), *poses]
        self.edges = [
            Edge(j, 0 if j.parent is None else j.parent.index + 1, j.index + 1, self._screws(j)) for j in robot
        ]

    def _screws(self, j: Joint) -> np.ndarray:
        X = Pose.from_matrix(self.poses[j.index + 1])
        # a follower moves as its leader's coordinate says
        moved = [X @ s for s in j.model.screws]
        return np.array([[*map(float, m.real), *map(float, m.dual)] for m in moved]).reshape(-1, 6)

    @cached_property
    def links(self) -> dict[str, tuple[int, np.ndarray]]:
        """Link -> its body and its pose (4, 4) in the world."""
        found = {}
        for k in self.robot.links:
            node = 0 if k.joint is None else k.joint.index + 1
            found[k.name] = node, self.poses[node] @ k.placement.array
        return found

    @cached_property
    def bodies(self) -> list[np.ndarray]:
        """The ten parameters of each body in the world (10,)."""
        found = [np.zeros(10) for _ in self.poses]
        for k in self.robot.links:
            node, X = self.links[k.name]
            found[node] = found[node] + parameters(k.inertia, X)
        return found

    def at(self, node: int) -> list[Edge]:
        """The joints of a body, those that it is carried by and those that it carries."""
        return [e for e in self.edges if node in (e.inner, e.outer)]

    def below(self, node: int, edge: Edge) -> list[int]:
        """The bodies beyond an edge, seen from a body."""
        seen, waiting = {node}, [edge.outer if node == edge.inner else edge.inner]
        found = []
        while waiting:
            here = waiting.pop()
            seen.add(here)
            found.append(here)
            around = (e.outer if e.inner == here else e.inner for e in self.at(here))
            waiting += [x for x in around if x not in seen]
        return found

    def beyond(self, node: int, edge: Edge) -> np.ndarray:
        """The ten parameters of all bodies beyond an edge, in the world."""
        return np.asarray(sum((self.bodies[k] for k in self.below(node, edge)), np.zeros(10)))


def parameters(inertia: Inertia, X: np.ndarray) -> np.ndarray:
    """The ten parameters of a body in the frame in which its own has the pose X."""
    return (Pose.from_matrix(X) @ inertia).array


def carried(ten: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Ten parameters described in a frame, in the one in which that has the pose X."""
    return parameters(Inertia.from_array(ten), X)


def moved(screws: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Screws (n, 6) of a frame, in the one in which it has the pose X:  w' = R w,  v' = R v + p x R w"""
    return screws @ adjoint(X).T
