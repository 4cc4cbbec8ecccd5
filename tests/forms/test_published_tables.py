"""Tables that the makers print, found again in the URDFs.

Tolerance 1e-6: the digits the tables are printed with.  xArm7's URDF writes 90 degrees as 1.5708, which is 3.7e-6
too much and moves d by up to 1.3e-6; hence 4e-6 there.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

import dualpin as dp

H = pi / 2
# theta, d, a, alpha.  Universal Robots, "DH parameters for calculations of kinematics and dynamics"
UR = {
    "ur3_robot": (0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819),
    "ur5_robot": (0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823),
    "ur10_robot": (0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922),
}


def ur_table(d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> np.ndarray:
    d, a, alpha = (d1, 0, 0, d4, d5, d6), (0, a2, a3, 0, 0, 0), (H, 0, 0, H, -H, 0)
    return np.c_[np.zeros(6), d, a, alpha]


# Franka Emika, control parameters documentation: Craig's convention, the flange is link 8
PANDA = [
    (0, 0.333, 0, 0), (0, 0, 0, -H), (0, 0.316, 0, H), (0, 0, 0.0825, H), (0, 0.384, -0.0825, -H), (0, 0, 0, H),
    (0, 0.107, 0.088, H),
]  # fmt: skip
# UFACTORY, xArm7 kinematic parameters
XARM7 = [
    (0, 0.267, 0, -H), (0, 0, 0, H), (0, 0.293, 0.0525, H), (0, 0, 0.0775, H), (0, 0.3425, 0, H), (0, 0, 0.076, -H),
    (0, 0.097, 0, 0),
]  # fmt: skip
XARM7_MODIFIED = [
    (0, 0.267, 0, 0), (0, 0, 0, -H), (0, 0.293, 0, H), (0, 0, 0.0525, H), (0, 0.3425, 0.0775, H), (0, 0, 0, H),
    (0, 0.097, 0.076, -H),
]  # fmt: skip


def same(dh: dp.forms.DHTable, table: object, tolerance: float) -> None:
    assert all(row.letter == "R" for row in dh.rows)
    assert np.abs(dh.columns - np.array(table)).max() <= tolerance, dh.table()
    # base and tool are the identity
    assert np.abs(np.asarray(dh.base) - np.eye(4)).max() <= tolerance
    assert np.abs(np.asarray(dh.tool) - np.eye(4)).max() <= tolerance


@pytest.mark.parametrize("name", UR)
def test_universal_robots_print_the_standard_table_of_base_to_tool0(name: str) -> None:
    same(dp.to_dh(dp.load(name), "base", "tool0"), ur_table(*UR[name]), 1e-6)


def test_franka_prints_the_modified_table_of_link0_to_link8() -> None:
    same(dp.to_dh(dp.load("panda"), "panda_link0", "panda_link8", "modified"), PANDA, 1e-6)


def test_with_the_hand_only_the_last_row_of_the_panda_changes() -> None:
    with_hand = [*PANDA[:6], (-pi / 4, 0.107 + 0.1034, 0.088, H)]
    same(dp.to_dh(dp.load("panda"), "panda_link0", "panda_hand_tcp", "modified"), with_hand, 1e-6)


@pytest.mark.parametrize(("convention", "table"), [("standard", XARM7), ("modified", XARM7_MODIFIED)])
def test_ufactory_prints_both_tables_of_the_xarm7(convention: str, table: list) -> None:
    same(dp.to_dh(dp.load("xarm7"), "link_base", "link_eef", convention), table, 4e-6)
