"""The main uses, one line each, for environments that hold the core dependencies alone (`make oldest`)."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest

import dualpin as dp
from tests.smoke.lowest import lowest


@pytest.fixture(scope="module")
def panda():
    pytest.importorskip("pinocchio")  # the robots are installed together with it
    return dp.load("panda")


def run(*words):
    done = subprocess.run(
        [sys.executable, "-m", "dualpin", *words], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_bounds_become_constraints():
    needs = ["numpy>=1.26", "pin>=4; platform_system != 'Windows'", "scipy>=1; extra == 'x'"]
    assert lowest(needs, []) == ["numpy==1.26", "pin==4; platform_system != 'Windows'"]
    assert lowest(needs, ["x"])[-1] == "scipy==1"
    with pytest.raises(SystemExit, match="lower bound"):
        lowest(["numpy"], [])


def test_compiled_terms_agree_with_numpy(panda):
    """And they are compiled: without llvmlite, or with one too old, a warning would say that they are not."""
    q, v, a = panda.sample(20, seed=0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dp.gravity(panda, q)
    for f, args in ((dp.rnea, (q, v, a)), (dp.crba, (q,)), (dp.aba, (q, v, a)), (dp.fk, (q,)), (dp.coriolis, (q, v))):
        np.testing.assert_allclose(f(panda, *args), f(panda, *args, engine="numpy"), rtol=0, atol=1e-9)
    assert dp.rnea(panda, q[0], v[0], a[0]).shape == (9,)


def test_forms(panda):
    q = panda.sample(seed=1)[0]
    table = dp.to_dh(panda, base="panda_link0", tip="panda_link8", convention="modified")
    np.testing.assert_allclose(table.fk(q), dp.fk(panda, q, "panda_link8"), atol=1e-12)
    np.testing.assert_allclose(dp.to_screws(panda, tip="panda_hand").fk(q), dp.fk(panda, q, "panda_hand"), atol=1e-12)


def test_algebra_and_tracking(panda):
    assert dp.algebra.polyroots(dp.Dual([6, -5, 1], [1, 2, -1])).real.round(12).tolist() == [2.0, 3.0]
    w, _ = dp.algebra.eig([[2.0, 1.0], [1.0, 3.0]])
    assert w.real.dtype == float
    q = panda.sample(5, seed=2)[0]
    assert dp.ik(panda, dp.fk(panda, q, "panda_hand"), "panda_hand").success.all()


def test_extras():
    """Symbols and SciPy's integrators."""
    sympy, _ = pytest.importorskip("sympy"), pytest.importorskip("scipy")
    x = sympy.Symbol("x")
    assert dp.spatial.Quaternion.about(dp.spatial.UZ, x).rotation.rows[0].x.equals(sympy.cos(x))
    run = dp.integrators.solve(lambda t, y: -y, [1.0], method="DOP853", dt=0.5, t_end=1.0)
    assert abs(run.y[-1, 0] - np.exp(-1)) < 1e-9


@pytest.mark.campaign  # tests/cli does as much in the suite; `make oldest` runs it
@pytest.mark.skipif(os.name == "nt", reason="Pinocchio has no wheels for Windows")
def test_validation_and_the_command_line(tmp_path):
    pytest.importorskip("pinocchio")
    report = json.loads(run("validate", "panda", "--samples", "20", "--json"))
    assert report["passed"]
    assert "panda_joint1" in run("info", "panda")
    assert "panda" in run("list")
    assert run("dh", "panda", "--tip", "panda_hand", "--format", "csv").count("\n") > 7
