"""Tables and screws of chains against Pinocchio.

Tolerance 1e-12 on matrix entries and metres: products of up to 40 rotations, each within an eps,
times metres, leave 1e-14; axes just above the near-parallel threshold 0.02 lose another factor 50.
The everyday robots are those with prismatic joints, near-parallel axes, mimic joints and long chains.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import dualpin as dp
from dualpin.forms.chain import chain, leaves

pytest.importorskip("pinocchio")


def _campaign() -> ModuleType:
    """The script of the full campaign: the same comparison on all robots."""
    path = Path(__file__).parents[2] / "validation" / "dh" / "campaign.py"
    spec = importlib.util.spec_from_file_location("dh_campaign", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


campaign = _campaign()

TOLERANCE = 1e-12
EVERYDAY = ["panda", "ur5_robot", "xarm7", "kinova", "talos_left_arm", "tiago", "z1", "pr2"]


def examined(name: str, mimic: bool = False, samples: int = 10) -> list[dict]:
    path = dp.io.find(name)
    robot = dp.load(path, mimic=mimic)
    oracle = campaign.Pinocchio.of_file(robot, str(path), floating=False)
    found = (campaign.examine(robot, oracle, leaf, samples, seed=5) for leaf in leaves(robot))
    return [c for c in found if c is not None]


@pytest.mark.parametrize("name", EVERYDAY)
def test_every_chain_agrees_with_pinocchio_in_every_form(name: str) -> None:
    chains = examined(name)
    assert chains
    for c in chains:
        for form in campaign.FORMS:
            assert c[f"{form}_error"] <= TOLERANCE, c
        assert max(c["standard_d"], c["modified_d"]) < 2.0, c


def test_chains_with_coupled_joints_agree_with_pinocchio() -> None:
    for c in examined("panda", mimic=True) + examined("icub", mimic=True)[:4]:
        assert max(c[f"{form}_error"] for form in campaign.FORMS) <= TOLERANCE, c


def test_a_chain_may_run_upwards_and_down_again() -> None:
    robot = dp.load("panda")
    q = robot.sample(6, seed=2)[0]
    T = np.linalg.inv(dp.fk(robot, q, "panda_leftfinger")) @ dp.fk(robot, q, "panda_rightfinger")
    for convention in ("standard", "modified"):
        dh = dp.to_dh(robot, "panda_leftfinger", "panda_rightfinger", convention)
        assert [r.letter for r in dh.rows] == ["P", "P"]
        assert np.abs(dh.fk(q) - T).max() <= TOLERANCE
    poe = dp.to_screws(robot, "panda_link1", base="panda_hand")
    T = np.linalg.inv(dp.fk(robot, q, "panda_hand")) @ dp.fk(robot, q, "panda_link1")
    assert np.abs(poe.fk(q) - T).max() <= TOLERANCE


def test_a_floating_base_is_left_out_when_the_chain_starts_at_the_root_link() -> None:
    robot = dp.load("talos_left_arm", floating=True)
    tip = leaves(robot)[-1].name
    dh = dp.to_dh(robot, tip=tip)
    q = robot.sample(4, seed=0)[0]
    fixed = dp.load("talos_left_arm")
    assert np.abs(dh.fk(q) - dp.fk(fixed, q[:, 7:], tip)).max() <= TOLERANCE


def test_batches_of_any_shape_and_other_scalars_use_the_same_table() -> None:
    import mpmath

    robot = dp.load("ur5")
    dh = dp.to_dh(robot, tip="tool0")
    q = robot.sample(6, seed=1)[0]
    T = dh.fk(q)
    assert np.array_equal(dh.fk(q.reshape(3, 2, 6)), T.reshape(3, 2, 4, 4))
    X = dh.pose([mpmath.mpf(x) for x in q[0].tolist()])
    assert np.abs(np.array([[float(x) for x in row] for row in X.rows]) - T[0]).max() <= TOLERANCE


def test_residual_is_measured_against_the_robot() -> None:
    robot = dp.load("panda")
    dh = dp.to_dh(robot, tip="panda_hand")
    assert 0 < dh.residual <= TOLERANCE
    q = chain(robot, None, "panda_hand").sample(16)
    assert dh.residual == np.abs(dh.fk(q, engine="numpy") - dp.fk(robot, q, "panda_hand", engine="numpy")).max()


@pytest.mark.campaign
def test_all_chains_of_all_robots_convert_exactly_and_in_30_seconds() -> None:
    result = campaign.run(samples=20, seed=1)["summary"]
    assert result["chains"] >= 530
    assert result["passed"], result
    assert sum(result["seconds_to_convert"].values()) < 30
