"""Robots built from rows move, and weigh, as the textbooks' matrices say."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from golden import REFERENCE, array, close

import dualpin as dp

EPS_TOLERANCE = 1e-13  # a handful of 4x4 products with entries of metres


def row_matrix(theta: float, d: float, a: float, alpha: float, convention: str) -> np.ndarray:
    """The printed 4x4 matrix of one row."""
    ct, st, ca, sa = cos(theta), sin(theta), cos(alpha), sin(alpha)
    if convention == "standard":
        return np.array([
            [ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1],
        ])  # fmt: skip
    return np.array([
        [ct, -st, 0, a], [st * ca, ct * ca, -sa, -d * sa], [st * sa, ct * sa, ca, d * ca], [0, 0, 0, 1],
    ])  # fmt: skip


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_each_kind_of_joint_adds_its_variable_where_it_belongs(convention: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.uniform(-1.5, 1.5, (5, 4))
    arm = dp.from_dh(rows, ["R", "P", "C", ("H", 0.3), "F"], convention)
    assert arm.nq == 5
    for q in rng.uniform(-2, 2, (10, 5)):
        add = np.zeros((5, 4))
        add[0, 0], add[1, 1], add[2, :2], add[3, :2] = q[0], q[1], q[2:4], (q[4], 0.3 * q[4])
        T = np.linalg.multi_dot([row_matrix(*r, convention) for r in rows + add])
        assert np.abs(dp.fk(arm, q, arm.frame_names[-1]) - T).max() <= EPS_TOLERANCE
        if convention == "standard":
            assert np.abs(dp.fk(arm, q, "frame_2") - np.linalg.multi_dot(
                [row_matrix(*r, convention) for r in (rows + add)[:2]])).max() <= EPS_TOLERANCE  # fmt: skip
        else:
            assert np.abs(dp.fk(arm, q, "link_1") - row_matrix(*(rows + add)[0], convention)).max() <= EPS_TOLERANCE


def test_base_and_tool_are_taken_as_matrices_poses_steps_and_dual_angles() -> None:
    theta, alpha = dp.Dual(0.3, 0.2), dp.Dual(-0.4, 0.1)
    step = dp.forms.DHStep(theta, alpha)
    rows, q = [(0.1, 0.2, 0.3, 0.4)], [0.7]
    T = step.matrix @ row_matrix(0.8, 0.2, 0.3, 0.4, "standard") @ step.matrix
    for end in (step, step.matrix, step.pose, (theta, alpha), dp.forms.DHEnd((step,))):
        arm = dp.from_dh(rows, "R", base=end, tool=end)
        assert np.abs(dp.fk(arm, q, "tool") - T).max() <= EPS_TOLERANCE
    turned = dp.from_dh(rows, "R", base=theta)
    assert np.abs(dp.fk(turned, [0.0], "base_link") - np.eye(4)).max() == 0
    assert np.abs(dp.fk(turned, [0.0], "link_1")[2, 3] - 0.4) <= EPS_TOLERANCE


def test_the_puma_of_the_paper_is_where_its_matrices_say() -> None:
    a2, a3, d2, d3, d4 = map(float, REFERENCE["puma560"]["a2_a3_d2_d3_d4"])
    H = pi / 2
    rows = [(0, 0, 0, -H), (0, d2, a2, 0), (0, d3, a3, H), (0, d4, 0, -H), (0, 0, 0, H), (0, 0, 0, 0)]
    arm = dp.from_dh(rows, "RRRRRR", "standard")
    for case in REFERENCE["puma560"]["cases"]:
        q = array(case["q"])
        close(dp.fk(arm, q, "frame_3"), array(case["T03"]["T"]))
        close(dp.fk(arm, q, "tool"), array(case["T06"]["T"]))
        J = array(case["J6_linear_then_angular_base"])
        close(dp.jacobian(arm, q, "tool", "local_world_aligned"), J[[3, 4, 5, 0, 1, 2]])


def test_the_pa10_of_the_paper_is_where_its_matrices_say() -> None:
    ref = REFERENCE["pa10"]
    rows = [(0, float(d), 0, np.radians(al)) for d, al in zip(ref["d"], ref["alpha_deg"], strict=True)]
    arm = dp.from_dh(rows, "RRRRRRR", "standard")
    for case in ref["cases"]:
        close(dp.fk(arm, array(case["q"]), "tool"), array(case["ee"]["T"]))


def test_the_two_cylindrical_arm_of_the_paper_has_its_dynamics() -> None:
    for entry in REFERENCE["robot_2C"]:
        p = entry["parameters"]
        rows = [(0, 0, float(p["l1"]), float(p["alpha1"])), (0, 0, float(p["l2"]), float(p["alpha2"]))]
        inertias = [
            {"mass": float(m), "com": array(c), "inertia": array(J)}
            for m, c, J in zip(p["mass"], p["com_in_DH_frame"], p["inertia_about_com_in_DH_frame"], strict=True)
        ]
        arm = dp.from_dh(rows, "CC", "standard", inertias=inertias)
        for case in entry["cases"]:
            q, v, a = (array(case[k]) for k in "qva")
            close(dp.fk(arm, q, arm.frame_names[-1]), array(case["T02"]["T"]))
            close(dp.crba(arm, q), array(case["M"]))
            close(dp.coriolis(arm, q, v), array(case["C_christoffel"]))
            close(dp.gravity(arm, q), array(case["g"]))
            close(dp.rnea(arm, q, v, a), array(case["tau"]))


def test_the_planar_arms_of_the_paper_have_its_link_terms() -> None:
    for case in REFERENCE["planar"]:
        n = len(case["a"])
        rows = [(0, 0, float(a), 0) for a in case["a"]]
        inertias = [
            {"mass": float(m), "com": (float(l) - float(a), 0, 0), "inertia": np.diag([0, 0, float(J)])}
            for a, l, m, J in zip(case["a"], case["l"], case["m"], case["Iz"], strict=True)
        ]
        arm = dp.from_dh(rows, "R" * n, "standard", inertias=inertias, gravity=(0, -float(case["g"]), 0))
        q, v, a = (array(case[k]) for k in ("q", "dq", "ddq"))
        close(dp.rnea(arm, q, v, a), array(case["tau"]))
        for term, want in zip(dp.link_terms(arm, q, v), case["per_link"], strict=True):
            k = len(want["g"])
            close(term.M[:k, :k], array(want["M"]))
            close(term.C[:k, :k], array(want["C"]))
            close(term.g[:k], array(want["g"]))
            assert not term.M[k:].any() and not term.C[k:].any() and not term.g[k:].any()


def test_inertias_are_about_the_centre_of_mass_in_the_frame_of_each_convention() -> None:
    """The same body given in a standard distal frame and in the modified frame of the same link."""
    J = np.array([[0.03, 0.001, 0.002], [0.001, 0.04, -0.003], [0.002, -0.003, 0.05]])
    body = {"mass": 2.0, "com": (0.1, -0.2, 0.3), "inertia": J}
    theta, d, a, alpha = 0.0, 0.1, 0.4, 0.7
    X = dp.forms.DHStep(dp.Dual(0.0, 0.0), dp.Dual(alpha, a)).matrix
    R, p = X[:3, :3], X[:3, 3]
    moved = {"mass": 2.0, "com": R @ body["com"] + p, "inertia": R @ J @ R.T}
    standard = dp.from_dh([(theta, d, a, alpha)], "R", "standard", inertias=[body])
    modified = dp.from_dh([(theta, d, 0, 0)], "R", "modified", tool=X, inertias=[moved])
    q, v, acc = np.array([0.3]), np.array([1.1]), np.array([-0.4])
    assert np.allclose(dp.rnea(standard, q, v, acc), dp.rnea(modified, q, v, acc), rtol=0, atol=1e-13)
    assert np.allclose(dp.com(standard, q), dp.com(modified, q), rtol=0, atol=1e-14)
    assert np.allclose(dp.fk(standard, q, "tool"), dp.fk(modified, q, "tool"), rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", ["pa10", "puma560", "two_cylindrical", "planar_2r", "planar_3r_payload"])
def test_the_urdfs_of_the_papers_robots_are_what_their_scripts_write(name: str) -> None:
    import runpy
    from pathlib import Path

    folder = Path(__file__).parents[2] / "urdf" / name
    text = runpy.run_path(str(folder / "generate.py"))["robot"]().to_urdf()
    assert text == (folder / f"{name}.urdf").read_text(encoding="utf-8")
    assert (folder / "PROVENANCE.md").is_file()


def test_the_urdfs_of_the_papers_robots_pass_validation() -> None:
    pytest.importorskip("pinocchio")
    from pathlib import Path

    for path in sorted((Path(__file__).parents[2] / "urdf").glob("p*/*.urdf")):
        assert dp.validate(str(path), samples=20, seed=0, engine="numpy").passed, path.stem


def test_base_and_tool_of_a_table_are_matrices():
    table = dp.to_dh(dp.load("panda"), tip="panda_hand")
    assert table.tool[:3, 3].shape == (3,)
    assert table.tool[2, 3] == np.asarray(table.tool)[2, 3]
    assert (table.base @ table.tool).shape == (4, 4)
