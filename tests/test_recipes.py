"""The recipes "a term" and "an oracle" of CONTRIBUTING.md, followed; "a joint" is followed in model/test_joints.py."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.algorithms.jacobian import jacobian
from dualpin.call import evaluate
from dualpin.call.public import ask, public
from dualpin.crosscheck.arbiter import defined
from dualpin.crosscheck.check import compared
from dualpin.crosscheck.checks import CHECKS
from dualpin.crosscheck.exact import truth
from dualpin.crosscheck.oracles import ORACLES, Oracle
from dualpin.crosscheck.reading import describe
from dualpin.dual import sqrt
from dualpin.scalars import ONE, ZERO
from dualpin.terms import FRAME, TERMS, Q, Term, twist_entries
from tests.crosscheck.student import Student

# --- a term: its algorithm over any scalar, and one line of data ---------------------------------


def frame_jacobian_null_space(robot, q, frame):
    """N = 1 - sum u u^T over an orthonormal basis u of the rows of J (Gram-Schmidt), so that J N = 0."""
    rows = list(zip(*map(twist_entries, jacobian(robot, q, frame, "local")), strict=True))
    basis = []
    for row in rows:
        u = list(row)
        for w in basis:
            along = sum((a * b for a, b in zip(w, u, strict=True)), ZERO)
            u = [a - along * b for a, b in zip(u, w, strict=True)]
        length = sqrt(sum((a * a for a in u), ZERO))
        basis.append([a / length for a in u])
    n = range(robot.nv)
    return [[(ONE if i == k else ZERO) - sum((u[i] * u[k] for u in basis), ZERO) for k in n] for i in n]


NULL_SPACE = Term("frame_jacobian_null_space", (Q,), frame_jacobian_null_space, lambda r, **_: (r.nv, r.nv), (FRAME,))


def test_a_new_term_needs_its_algorithm_and_one_line(monkeypatch, seed):
    """It is compiled, batched, checked, evaluated with 50 digits, written as C: nobody else knows its name."""
    monkeypatch.setitem(TERMS, NULL_SPACE.name, NULL_SPACE)
    robot = dp.load("panda")
    q = robot.sample(20, seed=seed)[0]
    frame = "panda_link8"
    N = evaluate(robot, NULL_SPACE.name, {"q": q}, frame=frame)
    J = dp.jacobian(robot, q, frame)
    assert N.shape == (20, 9, 9)
    assert np.abs(J @ N).max() < 1e-11 and np.abs(N @ N - N).max() < 1e-11  # cond(J) of these samples is below 1e3
    assert np.allclose(np.trace(N, axis1=1, axis2=2), 9 - 6)
    _, _, V = np.linalg.svd(J)
    assert np.abs(N - np.swapaxes(V[:, 6:], 1, 2) @ V[:, 6:]).max() < 1e-11  # what NumPy's decomposition says
    kernel = robot.kernel(NULL_SPACE.name, frame=frame)
    assert np.array_equal(kernel(q), N) and np.abs(kernel(q[0]) - N[0]).max() < 1e-12
    assert np.abs(evaluate(robot, NULL_SPACE.name, {"q": q}, frame=frame, engine="numpy") - N).max() < 1e-12
    exactly = truth(robot, NULL_SPACE.name, {"q": q[0]}, frame=robot.frame(frame))
    assert max(abs(float(x - y)) for x, y in zip(exactly.ravel(), N[0].ravel(), strict=True)) < 1e-12
    assert "void null_space(" in dp.export_c(robot, NULL_SPACE.name, name="null_space", frame=frame).source
    with pytest.raises(dp.ArgumentError, match=r"frame_jacobian_null_space: option 'fram' is not known.*'frame'"):
        robot.kernel(NULL_SPACE.name, fram=frame)
    with pytest.raises(dp.ShapeError, match="frame_jacobian_null_space: q"):
        kernel(q[:, 1:])


# --- shown: its public function ------------------------------------------------------------------


@public
def null_space(robot, q, frame, *, out=None, dtype="float64", engine="auto"):
    return ask((NULL_SPACE, frame), q)


def test_a_public_term_needs_its_function():
    robot = dp.load("panda")
    q = robot.sample(5, seed=1)[0]
    N = null_space(robot, q, "panda_link8")
    assert np.array_equal(null_space(robot, q=q, frame="panda_link8", out=np.empty_like(N)), N)
    assert np.allclose(null_space(robot, q.tolist(), "panda_link8", engine="numpy"), N, atol=1e-12)
    with pytest.raises(dp.FrameNotFoundError, match="did you mean 'panda_link8'"):
        null_space(robot, q, "panda_lnk8")


# --- compared: its definition, and what the oracle says of it ------------------------------------


@compared(adds=lambda x: x.reach**2, enters=frozenset(), form="matrix")
def null_space_defined(d, frame):
    """1 - J^T (J J^T)^-1 J, the projector by its normal equations; J of a floating base has full rank."""
    J = d.jacobian(d.zeros(), frame, "world")
    inverse = np.array((d.mp.matrix((J @ J.T).tolist()) ** -1).tolist(), object)
    return np.array([d.unit(k) for k in range(d.robot.nv)]) - J.T @ inverse @ J


def null_space_of_pinocchio(pin, m, d, frame):
    J = pin.getFrameJacobian(m, d, frame, pin.LOCAL)
    return np.eye(m.nv) - np.linalg.pinv(J) @ J


def test_a_compared_term_needs_its_definition_and_the_oracles_question(monkeypatch):
    pytest.importorskip("pinocchio")
    from dualpin.crosscheck.oracles.pinocchio import QUESTIONS, Question

    name = NULL_SPACE.name
    monkeypatch.setitem(TERMS, name, NULL_SPACE)
    monkeypatch.setitem(CHECKS, name, replace(null_space_defined, term=name))
    validate = lambda n: dp.validate("ur5", samples=n, floating=True, terms=[name], engine="numpy", arbitrate=True)  # noqa: E731
    without = validate(2).terms[name]
    assert without.status == "not compared" and without.reason == "Pinocchio does not answer it"
    jacobians = lambda pin, m, d, s: (pin.computeJointJacobians(m, d, s["q"]), pin.updateFramePlacements(m, d))  # noqa: E731
    monkeypatch.setitem(QUESTIONS, name, Question(jacobians, null_space_of_pinocchio))
    found = validate(20).terms[name]
    assert found.status == "agrees" and found.max_scaled_error < 1e-12
    robot = dp.load("ur5", floating=True)
    q = robot.sample(seed=3)[0]
    exact = defined(robot, name, {"q": q}, (12, 12), frame=robot.frame("tool0"))
    assert np.abs(exact - null_space(robot, q, "tool0")).max() < 1e-13
    wrong = lambda pin, m, d, frame: null_space_of_pinocchio(pin, m, d, frame) * (1 + 1e-9)  # noqa: E731
    monkeypatch.setitem(QUESTIONS, name, Question(jacobians, wrong))
    verdict = validate(2).terms[name]
    assert verdict.status == "differs" and verdict.nearer == "dualpin"


# --- an oracle: one class, and its line in the table ---------------------------------------------


class StudentOracle(Oracle):
    """Independent code of the tests: world-frame Newton-Euler, the file by ElementTree."""

    name, terms = "Student", frozenset({"fk", "crba", "rnea", "gravity", "bias"})
    wrong: tuple[str, ...] = ()

    def __init__(self, robot, text):
        self.robot, self.student, self.description = robot, Student(text, wrong=self.wrong), describe(robot)
        moving = {k.joint: k.name for k in reversed(robot.links)}
        self.links = [moving[j] for j in robot]
        theirs = self.student.writes["v"]
        self.order = [theirs.index(name) for name in robot.joint_names]

    @classmethod
    def version(cls):
        return Student.version

    @classmethod
    def of_file(cls, robot, path, floating):
        return cls(robot, Path(path).read_text())

    def compute(self, term, states, variants=({},)):
        return [
            np.array([self._one(term, dict(zip(states, x, strict=True))) for x in zip(*states.values(), strict=True)])
        ]

    def _one(self, term, state):
        there = np.argsort(self.order)
        given = [state[key][there] for key in TERMS[term].inputs]
        if term == "fk":
            return np.array([self.student.fk(given[0], link) for link in self.links])
        found = getattr(self.student, term)(*given)
        return found[self.order] if found.ndim == 1 else found[np.ix_(self.order, self.order)]


def test_a_new_oracle_needs_its_class_and_one_line(monkeypatch):
    pytest.importorskip("pinocchio")
    monkeypatch.setitem(ORACLES, "student", StudentOracle)
    report = dp.validate("ur5", samples=10, oracle="student", terms=["fk", "rnea", "crba", "bias", "com"])
    assert report.passed and report.versions["student"] == "1"
    assert {name: t.status for name, t in report.terms.items()} == {
        "fk": "agrees", "rnea": "agrees", "crba": "agrees", "bias": "agrees", "com": "not compared"
    }  # fmt: skip
    assert report.terms["com"].reason == "Student does not answer it" and report.terms["rnea"].oracle == "Student"
    monkeypatch.setattr(StudentOracle, "wrong", ("no_gyroscopic",))
    report = dp.validate("ur5", samples=10, oracle="student", terms=["fk", "rnea"])
    assert report.terms["fk"].status == "agrees" and report.terms["rnea"].verdict == "differs, dualpin nearer"
    changed = dp.load("ur5").attach(dp.mechanisms.body(1.0, [0, 0, 0.1], np.eye(3)))
    with pytest.raises(dp.DualpinError, match="Student reads files only"):
        dp.validate(changed, samples=2, oracle="student")
    with pytest.raises(dp.ArgumentError, match=r"oracle 'studnt' is not known; did you mean 'student'"):
        dp.validate("ur5", samples=2, oracle="studnt")
