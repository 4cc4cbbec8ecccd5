"""Mistakes in screw axes and home poses of a code that multiplies exponentials are named."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.diagnosis.reading import describe
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here
from tests.crosscheck.test_diagnosis import PROBE

TERMS = ("fk", "jacobian", "com")


def bracket(S):
    w, v = S[:3], S[3:]
    return np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0, 0, 0, 0.0]])


def adjoint(T):
    R, p = T[:3, :3], T[:3, 3]
    K = bracket(np.r_[p, 0, 0, 0])[:3, :3]
    return np.block([[R, np.zeros((3, 3))], [K @ R, R]])


class Exponentials:
    """Lynch and Park's space form, with a point, a direction or a home pose that is wrong."""

    def __init__(self, ask, point=None, direction=None, home=None):
        d = describe(ask.text, ask.robot)
        self.M, self.parent, self.S, self.body = {d.root: np.eye(4)}, {}, {}, {d.root: d.base}
        right = {d.root: np.eye(4)}
        columns = {j.name: j.v.start for j in ask.robot}
        for p in d.parts:
            T = right[p.link] = right[p.parent] @ p.pose
            self.M[p.link] = home(T, p) if home else T
            self.parent[p.link], self.body[p.link] = p.parent, p.body
            if p.moves:
                w = direction(T, p) if direction else T[:3, :3] @ p.unit_axis
                o = point(T, p) if point else T[:3, 3]
                S = np.r_[np.zeros(3), w] if p.slides else np.r_[w, np.cross(o, w)]
                self.S[p.link] = columns[p.joint], S

    def _chain(self, link):
        links = []
        while link in self.parent:
            links.insert(0, link)
            link = self.parent[link]
        return [self.S[k] for k in links if k in self.S]

    def fk(self, q, frame):
        T = np.eye(4)
        for k, S in self._chain(frame):
            T = T @ expm(bracket(S) * q[k])
        return T @ self.M[frame]

    def jacobian(self, q, frame):
        J, T, p = np.zeros((6, len(q))), np.eye(4), self.fk(q, frame)[:3, 3]
        for k, S in self._chain(frame):
            column = adjoint(T) @ S
            J[:, k] = np.r_[column[:3], column[3:] + np.cross(column[:3], p)]
            T = T @ expm(bracket(S) * q[k])
        return J

    def com(self, q):
        moved = [(b, k) for k, b in self.body.items() if b is not None and self._chain(k)]
        return sum(b.mass * (self.fk(q, k) @ np.r_[b.com, 1])[:3] for b, k in moved) / sum(b.mass for b, _ in moved)


def keys_of(**wrong):
    ask = asking(PROBE, 4, 0, TERMS)
    return {f.key for f in diagnose(Case(ask_here(Exponentials(ask, **wrong), ask, lambda what: None))).findings}


def test_nothing_is_said_of_the_right_code():
    assert keys_of() == set()


@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        ({"point": lambda T, p: p.position}, "screw_point"),
        ({"point": lambda T, p: -T[:3, 3]}, "screw_point"),
        ({"direction": lambda T, p: p.rotation @ p.unit_axis}, "screw_axis"),
        ({"home": lambda T, p: np.block([[np.eye(3), T[:3, 3:]], [np.zeros((1, 3)), np.eye(1)]])}, "home_pose"),
    ],
)
def test_a_wrong_screw_or_home_pose_is_named(wrong, key):
    assert keys_of(**wrong) == {key}
