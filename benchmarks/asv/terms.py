"""Terms of robots, in batches and one state at a time, on one thread."""

from __future__ import annotations

import numpy as np

import dualpin as dp

TERMS = {"rnea": "qva", "aba": "qva", "crba": "q", "coriolis": "qv", "fk": "q", "rnea_derivatives": "qva"}


class Batch:
    """4096 states, the result written into an array of the caller."""

    params = (["ur5", "panda", "talos"], list(TERMS))
    param_names = ("robot", "term")

    def setup(self, name, term):
        dp.set_num_threads(1)
        self.robot = dp.load(name)
        state = dict(zip("qva", self.robot.sample(4096, seed=0), strict=True))
        self.arrays = [state[k] for k in TERMS[term]]
        self.kernel = self.robot.kernel(term)
        self.out = self.kernel(*self.arrays)

    def time_kernel(self, name, term):
        self.kernel(*self.arrays, out=self.out)


class Single:
    """One state: the public function, and the kernel."""

    params = (["ur5", "panda", "talos"], ["rnea", "crba", "fk"])
    param_names = ("robot", "term")

    def setup(self, name, term):
        self.robot, self.function = dp.load(name), getattr(dp, term)
        state = dict(zip("qva", self.robot.sample(seed=0), strict=True))
        self.arrays = [state[k] for k in TERMS[term]]
        self.kernel = self.robot.kernel(term)
        self.function(self.robot, *self.arrays), self.kernel(*self.arrays)

    def time_function(self, name, term):
        self.function(self.robot, *self.arrays)

    def time_kernel(self, name, term):
        self.kernel(*self.arrays)


class First:
    """From a name to a first result, without what earlier runs left on disk."""

    timeout = 300
    number, repeat = 1, (3, 10, 30.0)

    def setup(self):
        import os
        import tempfile

        self.folder = tempfile.TemporaryDirectory()
        os.environ["DUALPIN_CACHE_DIR"] = self.folder.name

    def teardown(self):
        self.folder.cleanup()

    def time_load_and_compile(self):
        robot = dp.load("panda")
        dp.rnea(robot, *robot.sample(100, seed=0))


class Tools:
    """A table of Denavit and Hartenberg, inverse kinematics of a batch, a validation."""

    def setup(self):
        self.robot = dp.load("ur5")
        self.target = dp.fk(self.robot, self.robot.sample(100, seed=0)[0], "tool0")
        dp.ik(self.robot, self.target[:2], "tool0")

    def time_dh(self):
        dp.to_dh(self.robot, tip="tool0")

    def time_ik(self):
        dp.ik(self.robot, self.target, "tool0")

    def peakmem_batch(self):
        q, v, a = self.robot.sample(100_000, seed=0)
        assert np.isfinite(dp.rnea(self.robot, q, v, a)).all()
