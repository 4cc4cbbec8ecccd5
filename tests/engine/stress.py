"""A program that calls many terms of many robots from many threads and processes, and compares every bit.

    python stress.py first THREADS ROBOT ...                one process, whose first calls all threads make together
    python stress.py processes METHOD N THREADS SECONDS ROBOT ...     N processes ("fork", "spawn", "forkserver")
                                                            that begin while a thread of this one compiles

A robot is a name, with "+" for a floating base.  Prints one JSON document: what was computed how often, and what
differed.  The tests run it as a process of its own, so that each run begins with nothing compiled.
"""

from __future__ import annotations

import collections
import hashlib
import json
import multiprocessing
import random
import sys
import threading
import time

import numpy as np

import dualpin as dp
from dualpin.call import find
from dualpin.terms import TERMS

PUBLIC = {"rnea": dp.rnea, "crba": dp.crba, "aba": dp.aba, "coriolis": dp.coriolis, "fk": dp.fk}


def load(name):
    return dp.load(name.removesuffix("+"), floating=name.endswith("+"))


def options(robot, term):
    frame = {"frame": robot.frames[-1]}
    if term in ("frame_pose", "frame_quaternion"):
        return frame
    if term in ("jacobian", "jacobian_dot", "frame_velocity"):
        return {**frame, "reference": "local"}
    return {**frame, "reference": "world", "classical": True} if term == "frame_acceleration" else {}


def arrays(robot, term, n):
    q, v, a = robot.sample(n, seed=1)
    f_ext = np.random.default_rng(1).uniform(-1, 1, (n, len(robot), 6))
    given = {"q": q, "v": v, "a": a, "tau": a, "f_ext": f_ext, "q0": q, "q1": robot.sample(n, seed=2)[0]}
    given |= {"w": a, "dq": v, "dv": v, "da": a}
    return [given[key] for key in TERMS[term].inputs]


def answer(robot, term):
    """The bits of a term: one configuration, a batch, and the public function."""
    f, x = robot.kernel(term, **options(robot, term)), arrays(robot, term, 9)
    results = [f(*(y[4] for y in x)), f(*x), f(*x, out=np.empty_like(f(*x)))]
    if term in PUBLIC:
        results += [PUBLIC[term](robot, *x), PUBLIC[term](robot, *(y[4] for y in x))]
    one, batch = results[:2]
    assert all(np.array_equal(r, batch if r.ndim == batch.ndim else one) for r in results), term
    assert np.array_equal(one, batch[4]), term
    return hashlib.sha256(np.ascontiguousarray(batch).tobytes()).hexdigest()[:16]


def compiled(robot, term):
    return find(robot, TERMS[term], options(robot, term), single=True) is not None


def all_at_once(robots, threads, seconds=0.0, seed=0):
    """Each thread computes every term of every robot in an order of its own, again until the time is over."""
    jobs = [(name, term) for name in robots for term in TERMS]
    answers, errors = collections.defaultdict(collections.Counter), []
    gate, end = threading.Barrier(threads), time.monotonic() + seconds

    def work(k):
        order = random.Random(seed + k)
        gate.wait()
        try:
            while True:
                for name, term in order.sample(jobs, len(jobs)):
                    answers[name, term][answer(robots[name], term)] += 1
                if time.monotonic() >= end:
                    return
        except BaseException as e:
            errors.append(f"{type(e).__name__}: {e}")
            raise

    running = [threading.Thread(target=work, args=(k,)) for k in range(threads)]
    for t in running:
        t.start()
    for t in running:
        t.join()
    numpy = [f"{name} {term}" for name, term in jobs if not compiled(robots[name], term)]
    return {
        "errors": errors, "numpy": numpy, "answers": {" ".join(job): dict(found) for job, found in answers.items()},
    }  # fmt: skip


def child(names, threads, seconds, seed, results):
    robots = {name: load(name) for name in names}
    results.put(all_at_once(robots, threads, seconds, seed))


def processes(method, count, threads, seconds, names):
    context = multiprocessing.get_context(method)
    results, stop = context.Queue(), threading.Event()

    def compile_on():
        robot = load(names[0])
        for k in range(10_000):
            if stop.is_set():
                return
            dp.coriolis(robot.with_gravity((0, 0, -9 - k * 1e-3)), *robot.sample(2, seed=0)[:2])

    busy = threading.Thread(target=compile_on, daemon=True)
    busy.start()
    running = [context.Process(target=child, args=(names, threads, seconds, 100 * k, results)) for k in range(count)]
    for p in running:
        time.sleep(0.1)
        p.start()
    parts = [results.get(timeout=seconds + 500) for _ in running]
    for p in running:
        p.join()
    stop.set()
    busy.join()
    total = collections.defaultdict(collections.Counter)
    for part in parts:
        for job, found in part["answers"].items():
            total[job].update(found)
    return {
        "errors": [e for part in parts for e in part["errors"]] + [f"exit {p.exitcode}" for p in running if p.exitcode],
        "numpy": [x for part in parts for x in part["numpy"]], "answers": {job: dict(n) for job, n in total.items()},
    }  # fmt: skip


def main(mode, *arguments):
    sys.setswitchinterval(1e-5)  # switch threads often, so that races show
    if mode == "first":
        threads, *names = arguments
        result = all_at_once({name: load(name) for name in names}, int(threads))
    else:
        method, count, threads, seconds, *names = arguments
        result = processes(method, int(count), int(threads), float(seconds), names)
    print(json.dumps(result))


if __name__ == "__main__":
    main(*sys.argv[1:])
