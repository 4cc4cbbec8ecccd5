"""Terms by their definitions, in 50 digits: they are what the algorithms compute, and know nothing of them."""

import ast
from pathlib import Path

import mpmath
import numpy as np
import pytest

import dualpin as dp
from dualpin.call import evaluate
from dualpin.crosscheck import checks, definitions, rigid
from dualpin.crosscheck.arbiter import arbitrate, nearer
from dualpin.crosscheck.checks import CHECKS
from dualpin.crosscheck.definitions import WORKING_DIGITS, Definitions, UndecidedError
from dualpin.crosscheck.sampling import states
from tests.odd_robots import every_joint

ROBOTS = {
    "panda": lambda: dp.load("panda", mimic=True),
    "ur5 floating": lambda: dp.load("ur5", floating=True),
    "odd": every_joint,
}


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("term", CHECKS)
def test_every_term_is_what_its_definition_says(name, term):
    robot, check = ROBOTS[name](), CHECKS[term]
    given = states(robot, 1, 1)
    options = check.variants(robot, 0)[-1]
    state = {key: given[name][0] for key, name in check.inputs.items()}
    ours = evaluate(robot, term, state, engine="numpy", **options)
    entries = {int(np.abs(ours).argmax()), int(np.random.default_rng(0).integers(max(ours.size, 1)))}
    for entry in entries:
        index = tuple(int(i) for i in np.unravel_index(entry, ours.shape)) if ours.shape else ()
        sampled = {name: given[name][0] for name in check.inputs.values()}
        scale = max(1.0, float(np.abs(ours).max()))
        found = arbitrate(robot, check, sampled, index, ours[index], ours[index] + scale, scale, 60, **options)
        # forward dynamics of these robots loses a digit or two to the condition of M
        assert found["dualpin"] < (1e-13 if check.solves else 2e-15)
        assert found["oracle"] == pytest.approx(1.0)


def test_definitions_use_no_algorithm():
    trees = [ast.parse(Path(room.__file__).read_text()) for room in (definitions, checks, rigid)]
    modules = {n.module for tree in trees for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    assert not any("algorithms" in (m or "") or m in ("terms", "functions") for m in modules)


def test_the_step_leaves_more_than_50_digits():
    """The kinetic energy of a free body is kept, and the digits of its rate say how exact differences are."""
    robot = dp.load("ur5", floating=True)
    given = states(robot, 1, 0)
    with mpmath.workdps(WORKING_DIGITS):
        d = Definitions(robot, {key: given[key][0] for key in ("q", "v")}, 60)
        M = d.mass_matrix()
        e = d.unit(7)
        by_rates = d.torques(d.zeros(), e, gravity=False)
        assert max(abs(x - y) for x, y in zip(M[:, 7], by_rates, strict=True)) < mpmath.mpf("1e-55")


def test_a_singular_mass_matrix_and_too_little_time_leave_it_undecided():
    b = dp.Builder("light")
    b.joint("a", dp.model.revolute())
    state = {"q": np.zeros(1), "v": np.zeros(1), "tau": np.ones(1)}
    with pytest.raises(UndecidedError, match="M is singular"):
        arbitrate(b.robot(), CHECKS["aba"], state, (0,), 1.0, 1.0, 1.0)
    with pytest.raises(UndecidedError, match="time"):
        arbitrate(dp.load("ur5"), CHECKS["crba"], {"q": np.zeros(6)}, (0, 0), 1.0, 1.0, 1.0, seconds=-1.0)


@pytest.mark.parametrize(("ours", "theirs", "who"), [
    (1e-16, 1e-9, "dualpin"), (1e-9, 1e-16, "oracle"), (1e-9, 1e-8, "neither"), (5e-14, 8e-14, "dualpin"),
    (8e-14, 5e-14, "oracle"), (float("inf"), float("inf"), "neither"), (1e-16, float("inf"), "dualpin"),
])  # fmt: skip
def test_the_nearer_one_is_within_the_tolerance(ours, theirs, who):
    assert nearer({"dualpin": ours, "oracle": theirs}, 1e-13) == who


def test_a_robot_is_lifted_once_for_all_its_arbitrations(monkeypatch):
    from dualpin.model import lift

    robot = dp.load("ur5")
    lifted, turned = [], []
    right, newton = lift.lifted, lift.orthonormal
    monkeypatch.setattr(lift, "lifted", lambda *a: (lifted.append(1), right(*a))[1])
    monkeypatch.setattr(lift, "orthonormal", lambda R: (turned.append(1), newton(R))[1])
    q = robot.sample(seed=0)[0]
    M = dp.crba(robot, q)
    for i in range(3):
        found = arbitrate(robot, CHECKS["crba"], {"q": q}, (i, i), M[i, i], M[i, i], 1.0)
        assert found["dualpin"] < 1e-14
    poses = [x.placement for x in (*robot, *robot.frames, *robot.links)]
    assert len(lifted) == 1 and len(turned) == len({str(X.rotation) for X in poses})
