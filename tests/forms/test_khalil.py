"""Trees by Khalil and Kleinfinger's parameters."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp

TOLERANCE = 1e-12  # as for chains
TREE = "khalil-kleinfinger"


@pytest.mark.parametrize("name", ["allegro_left", "panda", "talos", "kinova", "tiago_dual"])
def test_every_tip_of_a_tree_is_where_the_robot_has_it(name: str) -> None:
    robot = dp.load(name)
    table = dp.to_dh(robot, convention=TREE)
    assert table.residual <= TOLERANCE
    assert len(table.tips) >= 2
    assert max(max(abs(r.b), abs(r.d), abs(r.r)) for r in table.rows) < 2.0
    q = robot.sample(3, seed=0)[0]
    for tip in list(table.tips)[:3]:
        assert np.abs(table.fk(q, tip) - dp.fk(robot, q, tip)).max() <= TOLERANCE


def test_one_successor_of_each_frame_has_a_plain_modified_row() -> None:
    table = dp.to_dh(dp.load("allegro_left"), convention=TREE)
    for number in range(len(table) + 1):
        successors = [r for r in table.rows if r.antecedent == number]
        if successors:
            assert (successors[0].gamma, successors[0].b) == (0, 0)
    assert all(r.antecedent < r.number for r in table.rows)
    assert {r.sigma for r in table.rows} == {0, 2}


def test_a_chain_has_the_same_numbers_as_its_modified_table() -> None:
    robot = dp.load("xarm7")
    dh = dp.to_dh(robot, "link_base", "link_eef", "modified")
    rows = [r for r in dp.to_dh(robot, convention=TREE).rows if r.letter == "R"][:7]
    for a, b in zip(rows, dh.rows, strict=True):
        assert (a.name, a.gamma, a.b) == (b.joint, 0, 0)
        assert np.allclose([a.theta, a.r, a.alpha], [b.theta, b.d, b.alpha], rtol=0, atol=TOLERANCE)


def test_coupled_joints_and_a_floating_base() -> None:
    robot = dp.load("panda", mimic=True)
    assert dp.to_dh(robot, convention=TREE).residual <= TOLERANCE
    floating = dp.to_dh(dp.load("allegro_left", floating=True), convention=TREE)
    assert floating.residual <= TOLERANCE
    assert len(floating.tips) == 4


def test_frames_inserted_between_nearly_parallel_axes_are_noted() -> None:
    table = dp.to_dh(dp.load("kinova"), convention=TREE)
    inserted = sum(r.letter == "F" for r in table.rows) - len(table.tips)
    assert table.notes == (f"{inserted} fixed frames between nearly parallel axes",)
    assert not dp.to_dh(dp.load("allegro_left"), convention=TREE).notes


def test_any_scalar_goes_through_a_tree() -> None:
    sympy = pytest.importorskip("sympy")
    robot = dp.load("panda")
    table = dp.to_dh(robot, convention=TREE)
    q = sympy.symbols("q1:10")
    X = table.pose(q, "panda_hand_tcp")
    values = robot.sample(seed=3)[0]
    z = sympy.sympify(X.position.z).subs(dict(zip(q, values, strict=True)))
    assert float(z) == pytest.approx(dp.fk(robot, values, "panda_hand_tcp")[2, 3], abs=TOLERANCE)
