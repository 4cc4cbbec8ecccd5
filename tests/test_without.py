"""What works without Pinocchio and without a compiler, and what is said to be missing."""

from __future__ import annotations

import subprocess
import sys

import pytest

BLOCK = """
import sys, warnings, importlib.abc
class Blocked(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {names!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Blocked())
warnings.simplefilter("ignore")
import numpy as np, dualpin as dp
"""
WORKS = """
robot = dp.load("urdf/puma560/puma560.urdf", floating=True)
q, v, a = robot.sample(4, seed=0)
tau = dp.rnea(robot, q, v, a)
assert np.abs(tau - dp.rnea(robot, q, v, a, engine="numpy")).max() < 1e-12 * np.abs(tau).max()
assert np.array_equal(robot.kernel("rnea")(q, v, a), tau)
assert np.array_equal(dp.rnea(robot, q, v, a, out=np.empty_like(tau)), tau)
arm = dp.load("urdf/puma560/puma560.urdf")
table = dp.to_dh(arm)
assert table.residual < 1e-12
back = dp.from_dh(table.rows, joints="R" * 6, convention=table.convention)
x = dp.fk(arm, arm.neutral)
assert x.shape == (6, 4, 4) and back.nq == 6
run = dp.ik(arm, dp.fk(arm, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], arm.frame_names[-1]), arm.frame_names[-1], seed=0)
assert run.success
assert "<robot" in arm.to_urdf()
print("works")
"""


def done(names: tuple[str, ...], code: str) -> str:
    """What a fresh process prints in which these packages cannot be imported."""
    text = BLOCK.format(names=names) + code
    ran = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.parametrize("names", [("pinocchio", "eigenpy", "coal"), ("llvmlite",), ("rich", "typer")])
def test_the_core_works_without(names):
    assert done(names, WORKS).endswith("works\n")


def test_without_pinocchio_validation_says_what_to_install():
    code = """
try:
    dp.validate("urdf/puma560/puma560.urdf", samples=2)
except dp.DualpinError as e:
    print(e)
"""
    said = done(("pinocchio",), code)
    assert "needs Pinocchio" in said and "pip install pin" in said


def test_without_a_compiler_it_is_said_once_and_asked_for_it_is_refused():
    code = """
robot = dp.load("urdf/puma560/puma560.urdf")
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    for _ in range(3):
        dp.rnea(robot, *robot.sample(seed=0))
        dp.crba(robot, robot.neutral)
print([str(w.message) for w in said if "compiler" in str(w.message)])
try:
    dp.crba(robot, robot.neutral, engine="compiled")
except dp.DualpinError as e:
    print(type(e).__name__, e)
"""
    warned, refused = done(("llvmlite",), code).splitlines()
    assert warned.count("no compiler on this machine") == 1 and "slower" in warned
    assert refused.startswith("CompilerError") and "llvmlite" in refused and "pip install llvmlite" in refused


def test_files_that_need_an_extra_say_which():
    code = """
for names, make in (("xacro", lambda: dp.load(path)), ("mujoco", lambda: dp.loads("<mujoco/>"))):
    try:
        make()
    except dp.DualpinError as e:
        assert f"pip install 'dualpin[{names}]'" in str(e), e
    else:
        raise AssertionError(names)
assert dp.check("urdf/puma560/puma560.urdf").links and dp.load("urdf/pa10/pa10.urdf").to_mjcf()
print("works")
"""
    before = (
        "import tempfile, os\npath = os.path.join(tempfile.mkdtemp(), 'a.xacro'); open(path, 'w').write('<robot/>')\n"
    )
    assert done(("xacro", "xacrodoc", "mujoco"), before + code).endswith("works\n")
