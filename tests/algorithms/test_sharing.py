"""What terms have in common is computed once, only where that is asked for, and only for the same numbers."""

import threading

import numpy as np
import pytest

import dualpin as dp
from dualpin.algorithms.kinematics import References
from dualpin.algorithms.sharing import shared, sharing
from dualpin.call import evaluate
from dualpin.interpret import remembered
from dualpin.model.joints import Axial

FRAME_TERMS = ("frame_pose", "jacobian", "jacobian_dot", "frame_velocity", "frame_acceleration")


@pytest.mark.parametrize("n", [None, 3])
def test_terms_of_frames_share_poses_and_keep_their_bits(monkeypatch, n):
    robot = dp.load("panda")
    frame = robot.frames[-1]
    states = dict(zip("qva", robot.sample(n, seed=0), strict=True))
    other = dict(zip("qva", robot.sample(n, seed=1), strict=True))

    def ask(states):
        for name in FRAME_TERMS:
            for reference in References[: 1 if name == "frame_pose" else 3]:
                options = {"frame": frame} if name == "frame_pose" else {"frame": frame, "reference": reference}
                yield evaluate(robot, name, states, engine="numpy", **options)

    alone, others = list(ask(states)), list(ask(other))
    moved = []
    right = Axial.motion
    monkeypatch.setattr(Axial, "motion", lambda *x: (moved.append(1), right(*x))[1])
    with remembered():
        together = list(ask(states))
        once = len(moved)
        again = list(ask(other))
    assert once == len(list(frame.joint.chain)) and len(moved) == 2 * once
    for x, y in ((alone, together), (others, again)):
        assert all(a.tobytes() == b.tobytes() for a, b in zip(x, y, strict=True))


def test_shared_results_are_known_by_their_objects():
    made = []

    @shared
    def total(x, y=0):
        made.append(x)
        return sum(x) + y

    q = [1.5, 2.5]
    assert total(q) == total(q) == 4.0 and len(made) == 2  # nothing is shared
    with sharing():
        assert total(q) == total(list(q)) == 4.0 and len(made) == 3
        q[0] = 3.5  # another object is another number
        assert total(q) == 6.0 and total(q, y=1) == 7.0
        seen = []
        thread = threading.Thread(target=lambda: seen.append(total(q)))
        made.clear()
        thread.start()
        thread.join()
        assert seen == [6.0] and made == [q]  # another thread shares nothing
    total(q)
    assert len(made) == 2


def test_remembered_within_remembered_is_the_same():
    robot = dp.load("ur5")
    q = robot.sample(seed=0)[0]
    with remembered():
        first = dp.fk(robot, q, engine="numpy")
        with remembered():
            assert np.array_equal(dp.fk(robot, q, engine="numpy"), first)
        assert np.array_equal(dp.fk(robot, q, engine="numpy"), first)
