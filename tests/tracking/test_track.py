"""`dualpin.track` beyond the reference: batches, engines, singularities, null space, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import dualpin as dp
from dualpin.tracking import away_from_limits, manipulability_gradient, reach

from .arms import PA10_START, double_pendulum, pa10, slider

CIRCLE = dp.Circle(0.1, 10.0, plane="yz", start=PA10_START)
METHODS = ["euler", "trapezoidal", "abm4", "rk4", "heun", "midpoint", "rkmk4", "crouch_grossman3"]


@pytest.fixture(scope="module")
def panda():
    return dp.load("panda")


@pytest.mark.parametrize("feedback", ["stage", "held"])
@pytest.mark.parametrize("method", METHODS)
def test_compiled_steps_equal_the_interpreted_ones(method, feedback):
    options = {"method": method, "dt": 0.5, "t_end": 5.0, "gain": 0.8, "feedback": feedback}
    runs = [dp.track(pa10(), CIRCLE, engine=engine, **options) for engine in ("auto", "numpy")]
    # the same formulas, rounded in another order
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-13
    assert np.abs(runs[0].position_error - runs[1].position_error).max() < 1e-13


@pytest.mark.parametrize("feedback", ["stage", "held"])
@pytest.mark.parametrize("method", ["euler", "abm4", "rk4"])
def test_a_whole_step_equals_its_stages(method, feedback):
    """A null-space objective of zero keeps the whole-step kernel away and changes nothing else."""
    options = {"method": method, "dt": 0.5, "t_end": 5.0, "gain": 0.8, "feedback": feedback}
    whole = dp.track(pa10(), CIRCLE, **options)
    staged = dp.track(pa10(), CIRCLE, nullspace=lambda q: np.zeros_like(q), **options)
    assert np.abs(whole.q - staged.q).max() < 1e-13
    assert whole.cost.evaluations == staged.cost.evaluations


@pytest.mark.parametrize("method", ["abm4", "rk4", "rk45"])
def test_a_batch_is_its_members(method):
    starts = PA10_START + 0.05 * np.random.default_rng(0).normal(size=(2, 3, 7))
    path = dp.Circle(0.05, 10.0, plane="yz", start=starts)
    together = dp.track(pa10(), path, method=method, dt=0.5, t_end=2.0, gain=1.0, rtol=1e-11)
    assert together.q.shape == (2, 3, 5, 7) and together.position_error.shape == (2, 3, 5)
    alone = dp.track(pa10(), dp.Circle(0.05, 10.0, plane="yz", start=starts[1, 2]), method=method, dt=0.5, t_end=2.0,
                     gain=1.0, rtol=1e-11)  # fmt: skip
    # the adaptive method takes the batch's common step
    assert np.abs(together.q[1, 2] - alone.q).max() < (1e-8 if method == "rk45" else 1e-13)


def test_a_batch_may_start_off_one_trajectory():
    starts = PA10_START + 0.02 * np.random.default_rng(1).normal(size=(5, 7))
    run = dp.track(pa10(), CIRCLE, q0=starts, dt=0.05, t_end=10.0, gain=2.0)
    assert run.position_error[:, 0].min() > 1e-3
    assert run.position_error[:, -1].max() < 1e-5  # e^-20 of the start, and the error of the method


def test_the_error_of_the_closed_loop_decays_exponentially():
    rest = dp.Circle(0.0, 1.0, start=PA10_START)
    run = dp.track(pa10(), rest, q0=PA10_START + 1e-6, dt=0.01, t_end=2.0, gain=3.0)
    assert np.allclose(run.position_error, run.position_error[0] * np.exp(-3.0 * run.t), rtol=1e-4)


@pytest.mark.parametrize("name", ["DOP853", "LSODA", "Radau", "rk45"])
def test_references_agree_with_small_steps(name):
    truth = dp.track(pa10(), CIRCLE, method="rk4", dt=0.0125, t_end=5.0, gain=1.0).q[-1]
    run = dp.track(pa10(), CIRCLE, method=name, dt=2.5, t_end=5.0, gain=1.0, rtol=1e-10, atol=1e-11)
    assert np.abs(run.q[-1] - truth).max() < 1e-8
    assert run.q.shape == (3, 7)


@pytest.mark.parametrize(("name", "frame"), [("ur5", "tool0"), ("panda", "panda_hand")])
@pytest.mark.parametrize("path", ["line", "screw", "callable"])
def test_every_trajectory_on_robots_from_urdf(name, frame, path):
    robot = dp.load(name)
    q0 = {"ur5": [0.0, -1.2, 1.4, -0.2, 1.5, 0.0], "panda": [0, -0.5, 0, -2.0, 0, 1.6, 0.8, 0.02, 0.02]}[name]
    T0 = dp.fk(robot, q0, frame)
    goal = T0 @ dp.spatial.to_matrix(dp.spatial.exp([0.1, 0.2, -0.1, 0.05, 0.02, -0.04]))

    def still(t):
        return T0, np.zeros(6)

    trajectory = {"line": dp.Line([0.05, -0.1, 0.05], 1.0), "screw": dp.Screw(goal, 1.0), "callable": still}[path]
    run = dp.track(robot, trajectory, q0, frame=frame, dt=0.05, t_end=1.0, gain=1.0)
    assert run.position_error.max() < 1e-6 and run.orientation_error.max() < 1e-6
    end = {"line": T0[:3, 3] + [0.05, -0.1, 0.05], "screw": goal[:3, 3], "callable": T0[:3, 3]}[path]
    assert np.abs(dp.fk(robot, run.q[-1], frame)[:3, 3] - end).max() < 1e-6


def test_a_floating_base_is_tracked_on_the_group():
    robot = dp.load("ur5", floating=True)
    q0 = np.concatenate([[0.1, 0.2, 0.3], np.array([1, 2, 3, 4]) / np.sqrt(30), [0.0, -1.2, 1.4, -0.2, 1.5, 0.0]])
    run = dp.track(robot, dp.Line([0.5, 0.2, -0.4], 2.0), q0, frame="tool0", dt=0.1, gain=1.0)
    assert run.position_error.max() < 1e-6
    assert np.abs(np.linalg.norm(run.q[:, 3:7], axis=-1) - 1).max() < 4e-16
    with pytest.raises(dp.ArgumentError, match="did you mean 'rkmk4'"):
        dp.track(robot, dp.Line([0.5, 0.2, -0.4], 2.0), q0, frame="tool0", dt=0.1, method="abm4")


def test_fewer_joints_than_directions_follow_what_they_can():
    """Two sliders follow a line in their plane exactly."""
    run = dp.track(slider(), dp.Line([0.3, -0.2, 0.0], 1.0), [0.0, 0.0], dt=0.25)
    assert run.position_error.max() < 1e-15
    assert np.allclose(run.q[-1], [0.3, -0.2])


def test_rates_at_a_singularity_are_those_of_the_pseudo_inverse():
    """Stretched out, J J^T has no inverse: the singular value decomposition takes over and drops what cannot move."""
    robot, straight = pa10(), np.zeros(7)
    path = dp.Line([0.0, 0.05, 0.0], 1.0)
    with pytest.warns(dp.DualpinWarning, match="near a singularity"):
        run = dp.track(robot, path, straight, method="euler", dt=1e-3, t_end=1e-3)
    J = dp.jacobian(robot, straight, -1, "local_world_aligned")
    assert np.allclose((run.q[1] - run.q[0]) / 1e-3, np.linalg.pinv(J, rcond=1e-13) @ [0, 0, 0, 0, 0.05, 0], atol=1e-9)
    assert any("singular" in text for text in run.warnings)


def test_damping_keeps_rates_small_near_a_singularity():
    start = np.array([0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0])
    path = dp.Line([0.0, 0.0, -0.05], 1.0)
    with pytest.warns(dp.DualpinWarning):
        exact, damped = (
            dp.track(pa10(), path, start, method="euler", dt=1e-3, t_end=1e-3, damping=d) for d in (0.0, 0.05)
        )
    speed = [np.abs(run.q[1] - run.q[0]).max() / 1e-3 for run in (exact, damped)]
    assert speed[0] > 50 and speed[1] < 1


def test_null_space_motion_does_not_disturb_the_task(panda):
    q0 = np.array([0.5, -0.5, 0.3, -2.0, 0.2, 1.6, 0.8, 0.02, 0.02])
    path = dp.Line([0.0, 0.1, 0.0], 2.0)
    plain = dp.track(panda, path, q0, frame="panda_hand", dt=0.02, gain=5.0)
    limits = dp.track(
        panda, path, q0, frame="panda_hand", dt=0.02, gain=5.0, nullspace="joint_limits", nullspace_gain=20.0
    )
    assert limits.position_error.max() < 1e-6
    middle, span = (panda.lower + panda.upper) / 2, panda.upper - panda.lower
    cost = [np.sum(((run.q[-1] - middle) / span) ** 2) for run in (plain, limits)]
    assert cost[1] < cost[0]
    assert np.allclose(away_from_limits(panda, plain.q[-1]), (middle - plain.q[-1]) / span**2)


def test_manipulability_grows_in_the_null_space(panda):
    q0 = np.array([0.5, -0.5, 0.3, -2.0, 0.2, 1.6, 0.8, 0.02, 0.02])
    rest, frame = dp.Circle(0.0, 1.0), panda.frame("panda_hand")
    run = dp.track(
        panda, rest, q0, frame=frame, dt=0.05, t_end=2.0, gain=2.0, nullspace="manipulability", nullspace_gain=5.0
    )
    w = manipulability_gradient(panda, frame, run.q)[0]
    assert run.position_error.max() < 1e-6
    assert (np.diff(w) > 0).all()


def test_the_gradient_of_manipulability_is_its_slope(panda):
    frame, q = panda.frame("panda_hand"), np.array([0.5, -0.5, 0.3, -2.0, 0.2, 1.6, 0.8, 0.02, 0.02])
    slope, h = manipulability_gradient(panda, frame, q)[1], 1e-6
    steps = q + h * np.vstack([np.eye(9), -np.eye(9)])
    w = manipulability_gradient(panda, frame, steps)[0]
    assert np.allclose(slope, (w[:9] - w[9:]) / (2 * h), atol=1e-8)  # central differences


def test_joint_limits_passed_are_announced(panda):
    q0 = np.array([2.85, -0.5, 0, -2.0, 0, 1.6, 0.8, 0.02, 0.02])  # the first joint may turn to 2.897
    with pytest.warns(dp.DualpinWarning, match="passes its limits"):
        run = dp.track(panda, dp.Line([-0.09, -0.3, 0.0], 1.0), q0, frame="panda_hand", dt=0.05, gain=1.0)
    assert any("passes its limits" in text for text in run.warnings)


def test_reach_is_a_true_bound(panda):
    for robot in (pa10(), panda, dp.load("ur5"), dp.load("talos")):
        frame = robot.frame(-1)
        bound = reach(robot, frame)
        q, _, _ = robot.sample(2000, seed=0)
        T = dp.fk(robot, q, frame)
        if bound is not None:
            assert bound.distance(T).max() <= bound.farthest + 1e-9
            assert bound.distance(T).min() >= bound.nearest - 1e-9
            assert not bound.excess(T).any()


def test_reach_of_known_arms():
    bound = reach(pa10(), pa10().frame(-1))
    assert bound.farthest == pytest.approx(0.93, abs=1e-9)  # 0.45 + 0.48: shoulder to wrist
    assert bound.nearest == pytest.approx(0.03, abs=1e-8)
    assert reach(slider(), slider().frame(-1)) is None
    assert reach(double_pendulum(), double_pendulum().frame("lower")).farthest == pytest.approx(1.0)


BAD = [
    ({"dt": 0.0}, dp.ArgumentError, "dt = 0.0 s, a positive step"),
    ({"dt": -0.1}, dp.ArgumentError, "dt = -0.1 s"),
    ({"t_end": -1.0}, dp.ArgumentError, "t_end = -1.0 s"),
    ({"dt": 0.3, "t_end": 1.0}, dp.ArgumentError, "not a whole number of steps"),
    ({"q0": [np.nan] * 7}, dp.ArgumentError, "not finite, the first at index"),
    ({"q0": np.zeros(6)}, dp.ShapeError, "nq = 7"),
    ({"q0": "home"}, dp.ArgumentError, "real numbers expected"),
    ({"method": "rk5"}, dp.ArgumentError, "did you mean 'rk4"),
    ({"method": "eular"}, dp.ArgumentError, "did you mean 'euler'"),
    ({"method": "variational"}, dp.ArgumentError, "dualpin.simulate takes it"),
    ({"feedback": "stages"}, dp.ArgumentError, "did you mean 'stage'"),
    ({"startup": "paperr"}, dp.ArgumentError, "did you mean 'paper'"),
    ({"gain": -1.0}, dp.ArgumentError, "gain = -1.0"),
    ({"gain": float("inf")}, dp.ArgumentError, "gain = inf"),
    ({"damping": -0.1}, dp.ArgumentError, "damping = -0.1"),
    ({"frame": "tip9"}, dp.FrameNotFoundError, "frame 'tip9' not in"),
    ({"nullspace": "limits"}, dp.ArgumentError, "did you mean 'joint_limits'"),
    ({"nullspace": lambda q: np.zeros(3)}, dp.ShapeError, r"nullspace\(q\) of shape"),
    ({"method": "rk45", "feedback": "held"}, dp.ArgumentError, "needs equal steps"),
    ({"trajectory": "circle"}, dp.ArgumentError, "a trajectory expected"),
    ({"trajectory": lambda t: np.eye(4), "t_end": 1.0, "q0": PA10_START}, dp.ShapeError, "a tuple"),
    ({"trajectory": lambda t: (np.eye(4), np.zeros(6)), "q0": PA10_START}, dp.ArgumentError, "t_end"),
    ({"trajectory": dp.Circle(0.1, 1.0)}, dp.ArgumentError, "q0 expected"),
    (
        {"q0": np.zeros((2, 7)), "trajectory": dp.Circle(0.1, 10.0, start=np.zeros((3, 7)))},
        dp.ShapeError,
        "do not broadcast",
    ),
]


@pytest.mark.parametrize(("change", "error", "message"), BAD)
def test_bad_input_is_named(change, error, message):
    arguments = {"trajectory": CIRCLE, "dt": 0.1, **change}
    with pytest.raises(error, match=message):
        dp.track(pa10(), arguments.pop("trajectory"), **arguments)


def test_a_name_instead_of_a_robot_is_named():
    with pytest.raises(dp.ArgumentError, match="a Robot expected"):
        dp.track("panda", CIRCLE)


def test_no_time_gives_the_start():
    run = dp.track(pa10(), CIRCLE, t_end=0.0)
    assert run.q.tolist() == [PA10_START.tolist()] and run.position_error.max() < 1e-15


def test_an_empty_batch_is_no_work():
    run = dp.track(pa10(), dp.Circle(0.1, 10.0, start=np.zeros((0, 7))), dt=0.1, t_end=1.0)
    assert run.q.shape == (0, 11, 7)
