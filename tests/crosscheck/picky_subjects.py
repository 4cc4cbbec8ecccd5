"""Subjects that do not read every file, for the tests of what is said of a refusal."""

from __future__ import annotations

import os
import sys
from xml.etree import ElementTree

import dualpin as dp


class Picky:
    """dualpin's mass matrix, of files without what `wrong` finds."""

    name, version = "picky", "1.0"

    def __init__(self, urdf: str, floating: bool) -> None:
        self.check(ElementTree.parse(urdf).getroot())
        self.robot = dp.load(urdf, floating=floating)

    def check(self, root) -> None:
        raise NotImplementedError

    def crba(self, q):
        return dp.crba(self.robot, q, engine="numpy")


class NoSliding(Picky):
    def check(self, root) -> None:
        if any(j.get("type") == "prismatic" for j in root.iter("joint")):
            raise KeyError("prismatic")


class NeedsInertialOrigin(Picky):
    def check(self, root) -> None:
        for inertial in root.iter("inertial"):
            inertial.find("origin").get("xyz").split()


class NoSlidingNorMimic(NoSliding):
    def check(self, root) -> None:
        super().check(root)
        if root.find(".//mimic") is not None:
            os.abort()


class NoFile(Picky):
    """Of no file at all."""

    def check(self, root) -> None:
        raise ValueError("I am not ready")


class NeedsLibrary(Picky):
    def check(self, root) -> None:
        import no_such_library  # noqa: F401


if __name__ == "__main__":  # a program with an exchange folder: it reads no <dynamics>
    tree = ElementTree.parse(f"{sys.argv[1]}/robot.urdf")
    sys.exit("dynamics is not implemented" if tree.find(".//dynamics") is not None else 0)
