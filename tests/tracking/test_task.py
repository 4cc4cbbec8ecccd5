"""What is asked of a frame: poses, positions, directions; limits, units and counts of joints."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dualpin as dp
from dualpin.model import Builder, prismatic, revolute
from dualpin.model.robot import Limits, Mimic, Robot
from dualpin.spatial import UX, UY, Pose, Vector3
from dualpin.tracking import away_from_limits, reach
from dualpin.tracking.study import remarks, run
from dualpin.tracking.task import TASKS

from .arms import pa10


def at(x, y, z):
    return Pose(position=Vector3(float(x), float(y), float(z)))


@cache
def scara(unit: float = 1.0) -> Robot:
    """Three turns and a slide about vertical axes, lengths in `unit` (1000: millimetres)."""
    b = Builder("scara")
    turns, slide = Limits((-2.6,), (2.6,)), Limits((-0.2 * unit,), (0.0,))
    b.joint("shoulder", revolute(), limits=turns)
    b.joint("elbow", revolute(), "shoulder", placement=at(0.35 * unit, 0, 0), limits=turns)
    b.joint("quill", prismatic(), "elbow", placement=at(0.25 * unit, 0, 0), limits=slide)
    b.joint("turn", revolute(), "quill", limits=turns)
    b.frame("tool", "turn", placement=at(0.02 * unit, 0, -0.05 * unit))
    return b.robot()


@cache
def continuous_arm() -> Robot:
    """A PA-10 whose joints turn without end."""
    return pa10()


@cache
def four_axes() -> Robot:
    """Four turns about axes of three directions."""
    b = Builder("four_axes")
    b.joint("pan", revolute())
    b.joint("lift", revolute(UY), "pan", placement=at(0, 0, 0.3))
    b.joint("elbow", revolute(UY), "lift", placement=at(0.4, 0, 0))
    b.joint("roll", revolute(UX), "elbow", placement=at(0.3, 0, 0))
    b.frame("tool", "roll", placement=at(0.1, 0, 0.05))
    return b.robot()


@cache
def gripper() -> Robot:
    """A turn, a finger that slides, and a second one that follows with its own, narrower limits."""
    b = Builder("gripper")
    b.joint("turn", revolute(), limits=Limits((-3.0,), (3.0,)))
    b.joint("left", prismatic(UX), "turn", limits=Limits((0.0,), (0.5,)))
    b.joint("right", prismatic(UX), "left", mimic=Mimic("left", -0.5, 0.3), limits=Limits((0.15,), (0.25,)))
    b.frame("tip", "right", placement=at(0.1, 0, 0))
    return b.robot()


def test_a_position_leaves_the_orientation_free():
    robot = dp.load("ur5")
    target = dp.fk(robot, robot.sample(50, seed=1)[0], "tool0")
    turned = target.copy()
    turned[..., :3, :3] = dp.fk(robot, robot.sample(50, seed=2)[0], "tool0")[..., :3, :3]  # any value will do
    found = dp.ik(robot, turned, "tool0", position_only=True)
    assert found.success.all() and (found.error[..., :3] == 0).all()
    assert np.abs(dp.fk(robot, found.q, "tool0")[..., :3, 3] - target[..., :3, 3]).max() < 2e-9
    for same in ({"task": "position"}, {"mask": [0, 0, 0, 1, 1, 1]}, {"task": (False,) * 3 + (True,) * 3}):
        assert np.array_equal(dp.ik(robot, turned, "tool0", **same).q, found.q)


def test_a_position_and_an_axis_leave_the_turn_about_it_free():
    robot = dp.load("panda")
    target = dp.fk(robot, robot.sample(50, seed=3)[0], "panda_hand")
    spun = target @ dp.spatial.to_matrix(dp.spatial.exp([0, 0, 1.3, 0, 0, 0]))
    found = dp.ik(robot, spun, "panda_hand", task="position+axis")
    assert found.success_rate > 0.95
    reached = dp.fk(robot, found.q, "panda_hand")[found.success]
    assert np.abs(reached[..., :3, 2:] - target[found.success][..., :3, 2:]).max() < 2e-9
    assert np.abs(reached[..., :3, 0] - spun[found.success][..., :3, 0]).max() > 0.1  # free about the axis


def test_an_axis_that_points_the_other_way_is_turned_round():
    robot, q = dp.load("ur5"), np.array([0.2, -1.2, 1.4, -0.4, 1.5, 0.3])
    opposite = dp.fk(robot, q, "tool0") @ np.diag([1.0, -1.0, -1.0, 1.0])
    found = dp.ik(robot, opposite, "tool0", q0=q, task="position+axis")
    assert found.success
    assert dp.fk(robot, found.q, "tool0")[:3, 2] == pytest.approx(opposite[:3, 2], abs=1e-8)


def test_a_mask_asks_for_what_a_scara_can_do():
    robot = scara()
    target = dp.fk(robot, robot.sample(40, seed=0)[0], "tool")
    tilted = target @ dp.spatial.to_matrix(dp.spatial.exp([0.4, 0, 0, 0, 0, 0]))
    found = dp.ik(robot, tilted, "tool", mask=[0, 0, 0, 1, 1, 1])
    assert found.success.all()
    assert dp.ik(robot, target, "tool").success.all()  # poses that it has are found with six numbers too


@pytest.mark.parametrize("engine", ["auto", "numpy"])
def test_every_task_is_followed_compiled_and_not(engine):
    robot, q0 = dp.load("ur5"), [0.0, -1.2, 1.4, -0.2, 1.5, 0.0]
    for task in TASKS:
        done = dp.track(
            robot, dp.Circle(0.05, 4.0, start=q0), dt=0.5, gain=1.0, frame="tool0", task=task, engine=engine
        )
        assert done.position_error.max() < 1e-3
    assert (dp.track(robot, dp.Circle(0.05, 4.0, start=q0), dt=0.5, frame="tool0", task="position",
                     engine=engine).orientation_error == 0).all()  # fmt: skip


def test_tasks_with_less_move_the_joints_less():
    """J^+ has least norm: of more freedom comes no faster motion, at the first step."""
    robot, q0 = dp.load("ur5"), np.array([0.0, -1.2, 1.4, -0.2, 1.5, 0.0])
    speeds = []
    for task in ("pose", "position+axis", "position"):
        done = dp.track(robot, dp.Line([0.1, 0.1, 0.1], 1.0), q0, method="euler", dt=1e-3, t_end=1e-3, frame="tool0",
                        task=task)  # fmt: skip
        speeds.append(np.linalg.norm(done.q[1] - q0))
    assert speeds[0] >= speeds[1] - 1e-12 > speeds[2]


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["ur5", "panda"]), st.booleans())
def test_limits_are_kept_whether_or_not_a_target_is_reached(seed, name, reachable):
    robot, rng = dp.load(name), np.random.default_rng(seed)
    q = robot.lower + (robot.upper - robot.lower) * rng.uniform(-0.5, 1.5, (4, robot.nq))
    target = dp.fk(robot, q, -1)
    target[..., :3, 3] *= 1.0 if reachable else 5.0
    with pytest.warns(dp.DualpinWarning, match="q0 is outside the limits"):
        found = dp.ik(robot, target, q0=robot.upper + 1.0, restarts=1, max_iterations=5)
    assert (found.q >= robot.lower).all() and (found.q <= robot.upper).all()
    assert found.notes[0].startswith("q0 is outside the limits of ")


def test_endless_joints_come_back_near_their_start():
    robot = continuous_arm()
    assert np.isinf(robot.upper).all()
    q = robot.sample(20, seed=0)[0]
    start = 200 * np.pi + q + 0.3
    for q0 in (start, -start, None):
        found = dp.ik(robot, dp.fk(robot, q, -1), q0=q0)
        assert found.success.all()
        assert np.abs(found.q - (0.0 if q0 is None else q0)).max() <= np.pi + 1e-9
        assert np.abs(dp.fk(robot, found.q, -1) - dp.fk(robot, q, -1)).max() < 1e-8


def test_the_search_does_not_depend_on_the_unit_of_length():
    small, large = scara(), scara(1000.0)
    q = small.sample(100, seed=1)[0]
    scale = np.array([1.0, 1.0, 1000.0, 1.0])
    a = dp.ik(small, dp.fk(small, q, "tool"), "tool")
    b = dp.ik(large, dp.fk(large, q * scale, "tool"), "tool", tolerance=1e-7)
    assert a.success.all() and b.success.all()
    assert abs(np.median(a.iterations) - np.median(b.iterations)) <= 2
    assert (b.q >= large.lower).all() and (b.q <= large.upper).all()


def test_numpys_scalars_are_numbers():
    robot, q = dp.load("ur5"), np.array([0.0, -1.2, 1.4, -0.2, 1.5, 0.0])
    f, i, b = np.float32, np.int64, np.bool_
    target = dp.fk(robot, q, "tool0")
    assert dp.ik(robot, target, "tool0", q0=q, tolerance=f(1e-6), damping=f(1e-3), max_iterations=i(9), restarts=i(0),
                 limits=b(True), seed=i(1), position_only=b(False)).success  # fmt: skip
    circle = dp.Circle(f(0.05), np.array(2.0), start=q)
    done = dp.track(robot, circle, dt=np.float64(0.5), t_end=i(2), gain=f(1), damping=i(0), rtol=f(1e-6), frame="tool0")
    assert done.q.shape == (5, 6)
    moved = dp.simulate(robot, q, 0 * q, dt=np.float64(0.01), t_end=f(0.25), every=i(5))
    assert moved.q.shape == (6, 6)
    assert run(robot, frame="tool0", steps=np.array([1.0]), gains=np.array([0]), turns=i(1), methods=["rk4"])


@pytest.mark.parametrize("change", [{"tolerance": True}, {"damping": "1"}, {"restarts": 1.5}, {"seed": -1},
                                    {"max_iterations": np.bool_(True)}, {"task": "poses"}, {"mask": [1, 1]},
                                    {"mask": [0] * 6}, {"mask": [1, 1, 1, 1, 1, 2]}, {"position_only": 1},
                                    {"task": "position", "position_only": True}])  # fmt: skip
def test_what_is_no_number_or_task_is_refused_by_name(change):
    (name, _), *_ = change.items()
    with pytest.raises(dp.ArgumentError, match=rf"ik: .*{'mask' if name == 'mask' else name}"):
        dp.ik(dp.load("ur5"), np.eye(4), "tool0", **change)


def test_a_followers_limits_bound_its_leader_everywhere():
    robot = gripper()
    assert (robot.lower[1], robot.upper[1]) == (pytest.approx(0.1), pytest.approx(0.3))
    q = robot.sample(200, seed=0)[0]
    assert (q[:, 1] >= 0.1).all() and (q[:, 1] <= 0.3).all()
    bound = reach(robot, robot.frame("tip"))
    assert not bound.excess(dp.fk(robot, q, "tip")).any()
    far = dp.fk(robot, [0.0, 0.5], "tip")
    found = dp.ik(robot, far, "tip", task="position", restarts=2)
    assert not found.success and robot.lower[1] <= found.q[1] <= robot.upper[1]
    with pytest.warns(dp.DualpinWarning, match="joint 'left' passes its limits"):
        dp.track(
            robot, dp.Line([0.12, 0, 0], 1.0), [0.0, 0.1], dt=0.1, frame="tip", task="position", unreachable="warn"
        )


def test_configurations_a_coupled_robot_has_are_within_its_reach():
    """Followers in their own coordinate: -2 x + 1 of a slide, turns that follow, a follower of no ratio."""
    b = Builder("telescope")
    b.joint("turn", revolute(UY), limits=Limits((-1.0,), (1.0,)))
    b.joint("out", prismatic(UX), "turn", limits=Limits((0.0,), (0.4,)))
    b.joint("more", prismatic(UX), "out", mimic=Mimic("out", 3.0, 0.2), limits=Limits((0.0,), (2.0,)))
    b.joint("bent", revolute(UY), "more", mimic=Mimic("turn", 0.0, 0.7), placement=at(0.1, 0, 0))
    b.joint("wrist", revolute(UY), "bent", mimic=Mimic("turn", -1.0, 0.0), placement=at(0.3, 0, 0))
    b.frame("tip", "wrist", placement=at(0.2, 0, 0))
    robot = b.robot()
    q = robot.sample(500, seed=3)[0]
    for task in TASKS:
        bound = reach(robot, robot.frame("tip"), task)
        assert not bound.excess(dp.fk(robot, q, "tip")).any()
        assert bound.farthest < 3.0


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["position", "position+axis"]))
def test_the_bound_of_a_task_is_true_for_every_orientation_that_it_leaves_free(seed, task):
    robot, rng = dp.load("ur5"), np.random.default_rng(seed)
    frame = robot.frame("tool0")
    X = dp.fk(robot, robot.sample(50, seed=seed)[0], frame)
    turn = np.zeros((50, 6))
    turn[:, :3] = rng.normal(size=(50, 3)) * ([1, 1, 1] if task == "position" else [0, 0, 1])
    assert not reach(robot, frame, task).excess(X @ dp.spatial.to_matrix(dp.spatial.exp(turn))).any()


def test_huge_limits_are_none_for_a_search():
    b = Builder("huge")
    for i in range(6):
        axis = (UX, UY)[i % 2]
        b.joint(f"j{i}", revolute(axis), f"j{i - 1}" if i else None, placement=at(0.1, 0.2, 0.3 * (i > 0)),
                limits=Limits((-1e308,), (1e308,)))  # fmt: skip
    b.joint("out", prismatic(UX), "j5", limits=Limits((-1e308,), (1e308,)))
    robot = b.robot()
    q = robot.sample(20, seed=0)[0]
    assert not away_from_limits(robot, q).any()
    assert reach(robot, robot.frame(-1)) is None
    found = dp.ik(robot, dp.fk(robot, q, -1))  # an overflow would make the test fail
    assert found.success_rate > 0.9 and np.abs(found.q).max() < 100


def test_too_few_joints_are_told_so():
    robot, start = four_axes(), [0.3, -0.8, 1.2, 0.1]
    circle = dp.Circle(0.05, 2.0, "yz", start=start)
    with pytest.raises(dp.ArgumentError, match=r"4 joints cannot follow 6 numbers \(a pose\).*--task position\)"):
        dp.track(robot, circle, dt=0.1)
    assert dp.track(robot, circle, dt=0.1, gain=1.0, task="position").position_error.max() < 1e-4
    # four joints follow a motion of four freedoms exactly
    flat = dp.Circle(0.05, 2.0, "xy", start=[0.3, 0.8, -0.1, 0.0])
    assert dp.track(scara(), flat, dt=0.1, gain=1.0).position_error.max() < 1e-4
    tilted = dp.fk(robot, start, "tool") @ dp.spatial.to_matrix(dp.spatial.exp([0.3, 0.2, 0, 0, 0, 0]))
    with pytest.warns(dp.DualpinWarning, match="4 joints cannot follow 6 numbers.*1 of 1 targets"):
        assert not dp.ik(robot, tilted, restarts=1).success


def test_the_projects_two_links_follow_a_position_in_their_plane():
    robot = dp.load(Path(__file__).parents[2] / "urdf" / "planar_2r" / "planar_2r.urdf")
    with pytest.raises(dp.ArgumentError, match=r"2 joints cannot follow 6 numbers.*--task position"):
        run(robot)
    rows = run(robot, task="position", steps=[0.1], gains=[1.0], turns=1)
    assert rows[0].plane == "zx" and rows[-1].position_peak < 1e-6


def test_rank_and_instability_are_said_once_with_their_limit():
    robot = scara()
    path = dp.Circle(0.05, 2.0, "xy", start=[0.3, 0.8, -0.1, 0.0])
    done = dp.track(robot, path, dt=0.5, task="position", gain=10.0, t_end=10.0)
    assert [w.partition(":")[0] for w in done.warnings if w.startswith("unstable")] == ["unstable"]
    assert "K dt = 5 exceeds 2.785, the limit of rk4" in done.warnings[0]
    calm = dp.track(robot, path, dt=0.5, task="position", gain=5.0, feedback="held", t_end=2.0)
    assert any("exceeds 2, the limit of rk4 with held feedback" in w for w in calm.warnings)
    b = Builder("flat")
    for i in range(4):
        b.joint(f"j{i}", revolute(), f"j{i - 1}" if i else None, placement=at(0.3 * (i > 0), 0, 0))
    b.frame("tip", "j3", placement=at(0.1, 0, 0))
    flat = dp.track(b.robot(), dp.Line([0.02, 0.02, 0], 1.0), [0.1, 0.5, 0.5, 0.4], dt=0.1)
    assert [w for w in flat.warnings if "rank" in w] == [
        "rank: the Jacobian of frame 'tip' has rank 3 in every configuration: 3 of 6 directions"
    ]


@pytest.mark.parametrize("method", ["euler", "abm4", "rk4"])
def test_a_held_error_grows_beyond_its_limit_and_not_below(method):
    """1.412 of AB4-AM4, whose corrector looks back on held errors; 2 of methods of one step."""
    robot, start = pa10(), np.radians([0, 30, 0, 60, 0, 60, 0])
    rest, off = dp.Circle(0.0, 1.0, start=start), start + 1e-7 * np.cos(np.arange(7))
    limit, grown = dp.integrators.stability_limit(method, held=True), []
    for part in (0.97, 1.03):
        done = dp.track(robot, rest, off, method=method, dt=0.1, t_end=20.0, gain=part * limit / 0.1, feedback="held")
        e = done.position_error + done.orientation_error
        grown.append(e[-10:].max() / e[60:70].max())
        assert any(w.startswith("unstable") for w in done.warnings) == (part > 1)
    assert grown[0] < 1 < grown[1]


def test_a_study_says_why_and_one_note_a_kind():
    rows = run(scara(), task="position", steps=[1.0], gains=[0.0, 5.0], turns=1)
    assert rows[0].plane == "yz" and rows[0].task == "position"
    said = remarks(rows)
    assert len({s.partition(":")[0] for s in said}) == len(said)
    assert any(s.startswith("unstable: K dt = 5 exceeds 2") and s.endswith("more of 8 runs)") for s in said)
    stuck = run(four_axes(), plane="yz", task="pose", steps=[0.01, 0.02], gains=[1.0], turns=1, methods=["rk4", "abm4"],
                unreachable="warn")  # fmt: skip
    assert any(s.startswith("same error: 4 runs with K = 1") and "not to the integrators" in s for s in remarks(stuck))
