"""Subjects of all sorts, for the tests."""

from __future__ import annotations

import os
import time

import numpy as np

import dualpin as dp


class Light:
    """dualpin's own terms, but for gravity."""

    name, version = "light", "1.0"

    def __init__(self, urdf: str, floating: bool, gravity: list[float]) -> None:
        self.robot = dp.load(urdf, floating=floating).with_gravity((0, 0, -9.8))

    def crba(self, q):
        return dp.crba(self.robot, q, engine="numpy")

    def rnea(self, q, v, a):
        return dp.rnea(self.robot, q, v, a, engine="numpy")


class Crashes(Light):
    """Dies half-way through gravity."""

    calls = 0

    def gravity(self, q):
        self.calls += 1
        if self.calls > 3:
            os.abort()
        return dp.gravity(self.robot, q, engine="numpy")


class Hangs(Light):
    def gravity(self, q):
        time.sleep(600)


class Refuses:
    def __init__(self, urdf: str) -> None:
        raise RuntimeError("no such construct")


class Forgets(Light):
    """Its answers depend on what was asked before."""

    last = 0.0

    def gravity(self, q):
        out = dp.gravity(self.robot, q, engine="numpy") + self.last
        self.last = float(q[0])
        return out


class Slow(Light):
    def bias(self, q, v):
        time.sleep(0.05)
        return np.zeros_like(v)
