"""Terms made of other terms: wrong where these are, and with a mistake of their own besides."""

from __future__ import annotations

import numpy as np

import dualpin as dp
from dualpin.crosscheck.diagnosis import Case, diagnose
from dualpin.crosscheck.subjects import asking
from dualpin.crosscheck.subjects.running import ask_here

ROBOT = "double_pendulum"


def judged(subject: dict) -> dict[str, list[str]]:
    """What is named, soon: the cause of a part is unknown, and would be looked for long."""
    ask = asking(ROBOT, 4, 0, tuple(subject))
    return {f.key: f.terms for f in diagnose(Case(ask_here(subject, ask, lambda what: None)), budget=0.3).findings}


def test_a_coriolis_matrix_of_a_wrong_mass_matrix_by_differences():
    robot, step = dp.load(ROBOT), 1e-3

    def crba(q):
        return np.triu(dp.crba(robot, q))

    def coriolis(q, v):
        ahead, far = ([(crba(q + h * e) - crba(q - h * e)) / (2 * h) for e in np.eye(2)] for h in (step, 2 * step))
        D = np.stack([(4 * a - b) / 3 for a, b in zip(ahead, far, strict=True)], axis=-1)
        return (D @ v + np.einsum("ijk,j->ik", D, v) - np.einsum("jki,k->ij", D, v)) / 2

    assert judged({"crba": crba, "coriolis": coriolis}) == {"upper": ["crba"], "follows": ["coriolis"]}


def test_a_mistake_in_what_is_made_of_parts_that_are_wrong_themselves():
    """The cause of the bias is unknown; the mass matrix is not inverted but its diagonal."""
    robot = dp.load(ROBOT)

    def bias(q, v):
        return dp.bias(robot, q, v) + np.sin(3 * q[0] * v)

    def aba(q, v, tau):
        return (tau - bias(q, v)) / np.diag(dp.crba(robot, q))

    found = judged({"bias": bias, "crba": lambda q: dp.crba(robot, q), "aba": aba})
    assert found.pop("diagonal_inverse") == ["aba"] and set(found) <= {"partly"}


def test_accelerations_of_a_wrong_inverse():
    robot = dp.load(ROBOT)

    def minv(q):
        return np.linalg.inv(dp.crba(robot, q)) * np.array([[1, np.cos(q[0])], [np.cos(q[0]), 1]])

    def aba(q, v, tau):
        return minv(q) @ (tau - dp.bias(robot, q, v))

    found = judged({"minv": minv, "aba": aba, "bias": lambda q, v: dp.bias(robot, q, v)})
    assert found.pop("follows") == ["aba"] and set(found) <= {"partly"}


def test_accelerations_under_a_wrench_that_differ_as_those_without():
    """The cause of these is unknown; the code adds the wrench to the same recursion."""
    robot = dp.load(ROBOT)
    wrong = lambda q: np.sin(3 * q)  # noqa: E731

    def aba(q, v, tau):
        return dp.aba(robot, q, v, tau) + wrong(q)

    def aba_f_ext(q, v, tau, f_ext, frame):
        J = dp.jacobian(robot, q, frame, reference="local_world_aligned")
        return dp.aba(robot, q, v, tau + J.T @ f_ext) + wrong(q)

    found = judged({"aba": aba, "aba_f_ext": aba_f_ext})
    assert found.pop("follows") == ["aba_f_ext"] and set(found) <= {"partly"}
