"""Measuring beside other libraries: equal or not measured, absent by name, stopped where it hangs."""

from __future__ import annotations

import json

import numpy as np
import pytest

import dualpin as dp
from dualpin import peers
from dualpin.peers import measuring, process

ADAPTER = """
import time
import numpy as np
REQUIRES = ("nothing==0",)
MODULE = "numpy"

def made(folder):
    model = np.load(folder / "model.npz")
    names = model["names"].tolist()[::-1]
    M = np.load(folder / "states.npz")["q"].shape[1]
    {body}
"""


def adapter(tmp_path, monkeypatch, body):
    (tmp_path / "other.py").write_text(ADAPTER.replace("{body}", body.replace("\n", "\n    ")))
    monkeypatch.setattr(process, "FOLDER", tmp_path)
    monkeypatch.setattr(process, "NAMES", ("other",))
    monkeypatch.setenv("DUALPIN_SUBJECTS_DIR", str(tmp_path / "none"))


def run(term="gravity", **more):
    return peers.run(["ur5"], ["other"], ["rnea"], batch=64, repetitions=1, **more)


def test_the_wheel_is_measured_and_checked():
    pytest.importorskip("pinocchio")
    rows = peers.run(["ur5"], ["pinocchio"], ["rnea", "minv"], batch=64, repetitions=2)
    one, many = (next(r for r in rows if r["batch"] == n and r["term"] == "rnea") for n in (1, 64))
    for r in (one, many):
        assert r["ratio"] == pytest.approx(r["peer_us"] / r["us"], rel=0.01) and r["ratio"] > 0
        assert r["spread"][0] <= r["us"] <= r["spread"][1]
        assert r["peer_spread"][0] <= r["peer_us"] <= r["peer_spread"][1]
    assert (one["how"], many["how"]) == ("Python call", "its loop in C++, one thread")
    assert [r["skipped"] for r in rows if r["term"] == "minv"] == ["not offered"] * 2


def test_columns_are_found_by_the_joints_names(tmp_path, monkeypatch):
    """A peer with its joints in the opposite order, whose answer is right."""
    robot = dp.load("ur5")
    right = measuring.Ours(robot, 64).right("rnea", False)
    np.save(tmp_path / "right.npy", right[:, ::-1])
    adapter(
        tmp_path, monkeypatch,
        f"right = np.load({str(tmp_path / 'right.npy')!r}); n = [0]\n"
        "q0 = np.load(folder / 'states.npz')['q'][:, ::-1]\n"
        "def f(q, v, a): return right[np.abs(q0 - q).sum(1).argmin()]\n"
        "return {'version': 1, 'joints': names, 'single': {'rnea': f}}",
    )  # fmt: skip
    assert all("ratio" in r for r in run())


def test_what_differs_is_not_timed(tmp_path, monkeypatch):
    adapter(
        tmp_path, monkeypatch,
        "return {'version': 1, 'joints': names, 'single': {'rnea': lambda q, v, a: 0 * q}}",
    )  # fmt: skip
    rows = run()
    assert all("differs by" in r["skipped"] and "ratio" not in r for r in rows) and len(rows) == 2


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("raise ValueError('no such robot')", "no such robot"),
        ("import os; os._exit(3)", "ended"),
        ("return {'version': 1, 'joints': ['x'], 'single': {}}", "were expected"),
    ],
)
def test_a_peer_that_does_not_start_is_left_out_by_name(tmp_path, monkeypatch, body, said):
    adapter(tmp_path, monkeypatch, body)
    (row,) = run()
    assert row["peer"] == "other" and said in row["skipped"]


def test_a_peer_that_dies_at_work_is_left_out(tmp_path, monkeypatch):
    adapter(
        tmp_path, monkeypatch,
        "import os\nreturn {'version': 1, 'joints': names, 'single': {'rnea': lambda q, v, a: os._exit(4)}}",
    )  # fmt: skip
    assert all("ended" in r["skipped"] for r in run())


def test_a_peer_that_hangs_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr(process, "ANSWERING", 0.5)
    adapter(
        tmp_path, monkeypatch,
        "return {'version': 1, 'joints': names, 'single': {'rnea': lambda q, v, a: time.sleep(60)}}",
    )  # fmt: skip
    assert "no answer within 0.5 s" in run()[0]["skipped"]


def test_a_robot_without_fixed_links_moves_alike(tmp_path):
    robot = dp.load("talos")
    states = dict(zip(("q", "v", "a"), robot.sample(4, seed=0), strict=True))
    process.write_robot(robot, tmp_path, states)
    text = (tmp_path / "merged.urdf").read_text()
    assert "fixed" not in text and text.count("<link") == len(robot) + 1
    same = dp.load(tmp_path / "merged.urdf")
    assert same.joint_names == robot.joint_names
    assert np.allclose(dp.rnea(same, *states.values()), dp.rnea(robot, *states.values()), rtol=0, atol=1e-11)


def test_dynibos_order_of_joints(tmp_path):
    from dualpin.peers.adapters.dynibo import breadth_first

    dp.load("talos").to_urdf(tmp_path / "robot.urdf")
    names = breadth_first(tmp_path / "robot.urdf")
    assert sorted(names) == sorted(dp.load("talos").joint_names)
    assert names[:4] == ["leg_left_1_joint", "leg_right_1_joint", "torso_1_joint", "leg_left_2_joint"]


def test_what_is_not_installed_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setenv("DUALPIN_SUBJECTS_DIR", str(tmp_path))
    (row,) = peers.run(["ur5"], ["drake"], ["rnea"], batch=64)
    assert "not installed" in row["skipped"] and "drake==" in row["skipped"]


def test_names_and_robots_that_do_not_fit():
    with pytest.raises(dp.ArgumentError, match="did you mean 'mujoco'"):
        peers.run(["ur5"], ["mujco"])
    with pytest.raises(dp.ArgumentError, match="term 'fkk'"):
        peers.run(["ur5"], ["mujoco"], ["fkk"])
    with pytest.raises(dp.ArgumentError, match="turning and sliding"):
        peers.run([dp.load("panda", mimic=True)], ["mujoco"])


def test_the_command(tmp_path, monkeypatch):
    from typer.testing import CliRunner

    from dualpin.cli.main import program

    pytest.importorskip("pinocchio")
    done = CliRunner().invoke(
        program(), ["bench", "ur5", "--against", "pinocchio", "--terms", "rnea", "--batch", "64", "--json"]
    )
    assert done.exit_code == 0, done.output
    assert {r["batch"] for r in json.loads(done.stdout)} == {1, 64}
