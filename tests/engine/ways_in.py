"""A program in which many threads make the first use of the package together, through all public ways in.

    python ways_in.py WAY THREADS          WAY: imports, terms, tools, judge, validate or jax

Each thread does the same work in an order of its own, in a process that has imported and compiled nothing before.
Prints one JSON document: how many threads ended, their distinct answers, and what was raised.  A process that does
not end within `LIMIT` prints the stacks of all its threads.
"""

from __future__ import annotations

import faulthandler
import importlib
import json
import random
import sys
import threading
import traceback

LIMIT = 200.0  # s


def imports(k):
    import dualpin as dp

    names = [*dp._PACKAGES, *dp.__all__]
    random.Random(k).shuffle(names)
    for name in names:
        getattr(dp, name)
    return [importlib.import_module(f"dualpin.{name}").__name__ for name in ("export", "fuzz", "peers", "cli")]


def terms(k):
    """Functions, kernel objects, single calls, `out=`, other types and engines."""
    import numpy as np

    import dualpin as dp

    robot = shared()
    q, v, a = robot.sample(5, seed=0)
    calls = {
        "rnea": lambda: dp.rnea(robot, q, v, a), "one": lambda: dp.rnea(robot, q[0], v[0], a[0]),
        "fk": lambda: dp.fk(robot, q, frame="tool0", as_="dual_quaternion"), "crba": lambda: dp.crba(robot, q),
        "out": lambda: dp.aba(robot, q, v, a, out=np.empty((5, 6))), "minv": lambda: dp.minv(robot, q),
        "jacobian": lambda: dp.jacobian_dot(robot, q, v, "tool0", "local"),
        "kernel": lambda: robot.kernel("coriolis")(q, v, out=np.empty((5, 6, 6))),
        "single": lambda: dp.bias(robot, q, v, dtype="float32"), "numpy": lambda: dp.com(robot, q, engine="numpy"),
        "derivatives": lambda: np.concatenate(dp.aba_derivatives(robot, q, v, a)),
        "links": lambda: np.stack([x.C for x in dp.link_terms(robot, q[0], v[0])]),
        "difference": lambda: dp.difference(robot, q, dp.integrate(robot, q, v)),
    }  # fmt: skip
    order = list(calls)
    random.Random(k).shuffle(order)
    found = {name: calls[name]().tolist() for name in order}
    return [found[name] for name in calls]


def tools(k):
    import dualpin as dp

    robot = dp.load("ur5")
    q = robot.sample(3, seed=0)[0]
    run = dp.track(robot, dp.Circle(0.05, 2.0, start=q[0]), method="rk4", dt=0.1, t_end=0.5)
    solved = dp.ik(robot, dp.fk(robot, q[0], frame="tool0"), frame="tool0", q0=q[0] + 0.05)
    forms = dp.to_dh(robot, tip="tool0").fk(q), dp.to_screws(robot, tip="tool0").fk(q)
    kept = [f.rule for f in dp.check(robot)], dp.diff(robot, robot.with_gravity((0, 0, -1))).verdict
    return [*kept, dp.base_parameters(robot).names, robot.to_urdf(), *(x.tolist() for x in (*forms, run.q, solved.q))]


def judge(k):
    """Of code that counts gravity upwards."""
    import dualpin as dp

    wrong = dp.load("ur5").with_gravity((0, 0, 9.81))
    subject = {"rnea": lambda q, v, a: dp.rnea(wrong, q, v, a), "gravity": lambda q: dp.gravity(wrong, q)}
    report = dp.judge("ur5", subject, samples=4)
    return [[f.key for f in report.findings], *((n, t.status) for n, t in report.terms.items())]


def validate(k):
    import dualpin as dp

    return [(n, t.status, t.max_scaled_error) for n, t in dp.validate("ur5", samples=5).terms.items()]


def jax(k):
    import jax

    import dualpin.jax as dj

    robot = shared()
    q, v, a = robot.sample(3, seed=0)
    by_q = jax.jit(jax.grad(lambda q: dj.rnea(robot, q, v, a).sum()))(q)
    return by_q.tolist()


_lock, _kept = threading.Lock(), []


def shared():
    """One robot for all threads."""
    import dualpin as dp

    with _lock:
        return _kept[0] if _kept else _kept.append(dp.load("ur5")) or _kept[0]


def main(way, threads):
    faulthandler.dump_traceback_later(LIMIT, exit=True)
    sys.setswitchinterval(1e-5)  # switch threads often, so that races show
    gate, answers, errors = threading.Barrier(threads), [], []

    def work(k):
        gate.wait()
        try:
            answers.append(json.dumps(globals()[way](k)))
        except BaseException:
            errors.append(traceback.format_exc())

    running = [threading.Thread(target=work, args=(k,)) for k in range(threads)]
    for t in running:
        t.start()
    for t in running:
        t.join()
    print(json.dumps({"ended": len(answers), "distinct": len(set(answers)), "errors": sorted(set(errors))}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
