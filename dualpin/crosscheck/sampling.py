"""The random states on which libraries are compared."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from ..functions import integrate, rnea
from ..model.robot import Frame, Robot

STEP = 0.3  # of the tangent step between the two configurations of `difference`: far from any cut
LEAST_TURN = 0.5  # of STEP: turns of planar joints are no smaller, see `tolerance.logarithm`


def states(robot: Robot, n: int, seed: int, engine: str = "numpy") -> dict[str, np.ndarray]:
    """n states: q within the limits (angles of joints whose limits leave no room: anywhere), v, a, tau, f_ext, q1.

    tau is what the acceleration a needs, so that forward dynamics is asked for moderate accelerations.
    """
    q, v, a = robot.sample(n, seed)
    rng = np.random.default_rng([seed, 1])
    stuck = (robot.lower >= robot.upper) & np.isfinite(robot.lower)
    q[:, stuck] = rng.uniform(-pi, pi, (n, robot.nq))[:, stuck]
    step = v / (1 + np.abs(v))
    for i in planar_angles(robot):
        step[:, i] = np.where(step[:, i] < 0, -1.0, 1.0) * (LEAST_TURN + (1 - LEAST_TURN) * np.abs(step[:, i]))
    f_ext = rng.uniform(-10, 10, (n, len(robot), 6))
    return {
        "q": q, "v": v, "a": a, "f_ext": f_ext,
        "tau": rnea(robot, q, v, a, engine=engine),
        "q1": integrate(robot, q, STEP * step, engine="numpy"),
    }  # fmt: skip


def planar_angles(robot: Robot) -> list[int]:
    """Where in v the turning rates stand of joints that turn by an angle, and whose coordinates do not add (planar)."""
    return [
        j.v.start + i
        for j in robot
        for i, what in enumerate(j.model.coordinates)
        if what == "angle" and not j.model.additive
    ]


def frames(robot: Robot, seed: int, most: int = 3) -> list[Frame]:
    """Frames to look at: the last one, the one with most joints under it, and others at random."""
    if not robot.joints:
        return [robot.frames[-1]]
    deepest = max(robot.frames, key=lambda f: sum(1 for _ in f.joint.chain) if f.joint else 0)
    rng = np.random.default_rng([seed, 2])
    others = (robot.frames[i] for i in rng.permutation(len(robot.frames)))
    chosen = dict.fromkeys([robot.frames[-1], deepest])
    for f in others:
        if len(chosen) >= most:
            break
        chosen[f] = None
    return list(chosen)


def batches(n: int, floats_a_sample: int, engine: str) -> Iterator[slice]:
    """Slices of n samples whose results stay under a budget of floats, as far as that is possible.

    Those of kernels stay in the caches.  NumPy takes as long for a few samples as for a hundred: its slices are longer.
    """
    budget = 1 << (22 if engine == "numpy" else 18)
    size = int(np.clip(budget // max(floats_a_sample, 1), 4, 1024))
    for start in range(0, n, size):
        yield slice(start, min(start + size, n))
