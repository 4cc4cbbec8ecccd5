"""Random robots: trees of every joint kind through `Builder`, and plain URDF texts for two readers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from dualpin.model import (
    Builder,
    Floating,
    JointModel,
    Limits,
    Mimic,
    Planar,
    Robot,
    cylindrical,
    helical,
    prismatic,
    revolute,
    spherical,
)
from dualpin.spatial import AXES, Inertia, Matrix3, Pose, Rotation, Vector3


def unit(rng: np.random.Generator) -> np.ndarray:
    x = rng.standard_normal(3)
    return x / np.linalg.norm(x)


def random_axis(rng: np.random.Generator) -> Vector3:
    """A coordinate axis, its negative, or any direction."""
    kind = rng.integers(3)
    axis = AXES[rng.integers(3)]
    return axis if kind == 0 else -axis if kind == 1 else Vector3(*unit(rng).tolist())


def random_pose(rng: np.random.Generator, reach: float = 0.5) -> Pose:
    position = Vector3(*rng.uniform(-reach, reach, 3).tolist())
    if rng.random() < 0.25:
        return Pose(position=position)
    return Pose(Rotation.about(Vector3(*unit(rng).tolist()), float(rng.uniform(-3, 3))), position)


def random_inertia(rng: np.random.Generator, points: int = 6) -> Inertia:
    """The inertia of a few point masses, so that it is one a body can have."""
    mass, place = rng.uniform(0.1, 1.0, points), rng.uniform(-0.3, 0.3, (points, 3))
    J = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(mass, place, strict=True))
    rows = [Vector3(*row) for row in np.asarray(J).tolist()]
    return Inertia(float(mass.sum()), Vector3(*(mass @ place).tolist()), Matrix3(*rows))


def random_model(kind: str, rng: np.random.Generator) -> JointModel:
    whole = {"floating": Floating, "planar": Planar, "spherical": spherical}
    if kind in whole:
        return whole[kind]()
    axis = random_axis(rng)
    if kind == "helical":
        return helical(axis, float(rng.uniform(-0.3, 0.3)))
    makers = {"revolute": revolute, "prismatic": prismatic, "cylindrical": cylindrical}
    return revolute(axis, kind="continuous") if kind == "continuous" else makers[kind](axis)


def tree(
    kinds: Sequence[str],
    seed: int,
    *,
    branching: float = 0.4,
    massless: float = 0.0,
    armature: bool = False,
    mimics: int = 0,
    depth_first: bool = False,
) -> Robot:
    """A random tree with these joint kinds in this order.

    branching: the chance that a joint hangs on an earlier joint than the last; massless: the chance
    of a link with children to have no inertia (leaves always have one: M stays invertible);
    mimics: how many of the joints with one coordinate follow the one before it; depth_first: joints
    hang on the last one's ancestors only, the order in which Pinocchio wants them.
    """
    rng = np.random.default_rng(seed)
    on: list[int | None] = []
    for i in range(len(kinds)):
        branches = bool(i) and rng.random() < branching
        earlier: Sequence[int] = range(i)
        if depth_first and branches:
            earlier = [i - 1]
            while (parent := on[earlier[-1]]) is not None:
                earlier.append(parent)
        on.append(None if i == 0 else earlier[int(rng.integers(len(earlier)))] if branches else i - 1)
    b = Builder(f"tree{seed}", gravity=(0.3, -0.2, -9.81))
    b.base("ground", random_inertia(rng))
    single = [i for i, k in enumerate(kinds) if k in ("revolute", "prismatic", "helical", "continuous")]
    followers = dict(zip(single[1 : 1 + mimics], single, strict=False))
    for i, kind in enumerate(kinds):
        model, leader = random_model(kind, rng), followers.get(i)
        has_children = i in on
        weightless = has_children and kind in ("revolute", "prismatic") and rng.random() < massless
        b.joint(
            f"joint{i}", model, None if on[i] is None else f"link{on[i]}", random_pose(rng),
            None if weightless else random_inertia(rng), link=f"link{i}",
            mimic=None if leader is None else Mimic(f"joint{leader}", *rng.uniform(-2, 2, 2).tolist()),
            armature=rng.uniform(0.01, 0.1, model.nv).tolist() if armature else (),
            limits=Limits((-2.0,) * model.nq, (2.0,) * model.nq) if kind == "prismatic" else None,
        )  # fmt: skip
        if rng.random() < 0.3:
            b.fixed(f"weld{i}", f"link{i}", random_pose(rng), random_inertia(rng), link=f"part{i}")
    b.frame("tool", f"link{len(kinds) - 1}", random_pose(rng))
    return b.robot()


SPECS: dict[str, tuple[Sequence[str], dict]] = {
    "pendulum": (("revolute",), {}),
    "slider": (("prismatic",), {}),
    "arm": (("revolute",) * 6, {"branching": 0.0}),
    "branched": (("revolute", "prismatic", "continuous", "revolute", "prismatic", "revolute", "continuous"), {}),
    "massless": (("revolute",) * 4 + ("prismatic",) * 2 + ("revolute",) * 2, {"massless": 0.9, "branching": 0.2}),
    "screws": (("cylindrical", "helical", "revolute", "cylindrical", "prismatic", "helical"), {}),
    "rotors": (("revolute", "cylindrical", "prismatic", "revolute", "planar"), {"armature": True}),
    "mimic_rotors": (("revolute", "prismatic", "revolute", "revolute"), {"mimics": 2, "armature": True}),
    "planar": (("planar", "revolute", "revolute", "planar", "prismatic"), {}),
    "floating": (("floating", "revolute", "prismatic", "revolute", "revolute", "helical"), {"branching": 0.6}),
    "ball": (("spherical",), {}),
    "spherical": (("spherical", "revolute", "prismatic", "spherical", "revolute"), {"armature": True}),
    "floating_spherical": (("floating", "spherical", "revolute", "spherical", "planar"), {"branching": 0.6}),
    "mixed": (("revolute", "floating", "planar", "cylindrical", "helical", "prismatic"), {}),
    "mimic": (("revolute", "revolute", "prismatic", "revolute", "cylindrical", "revolute"), {"mimics": 3}),
    "floating_mimic": (("floating", "revolute", "revolute", "revolute", "planar"), {"mimics": 1}),
}
"""What the identities are tested on: every joint kind, alone, as base and in mid-tree."""

FIXED_BASE = ("pendulum", "slider", "arm", "branched", "massless", "screws", "mimic")
"""Those whose velocities are derivatives of coordinates."""


@cache
def robot(name: str, seed: int = 7) -> Robot:
    kinds, options = SPECS[name]
    return tree(kinds, seed, **options)


# --- URDF texts ----------------------------------------------------------------------------------

URDF_KINDS = ("revolute", "continuous", "prismatic", "fixed", "revolute", "planar", "floating")


def random_urdf(seed: int, joints: int = 9, *, kinds: Sequence[str] = URDF_KINDS, mimic: bool = False) -> str:
    """The text of a random URDF, written without the library.

    Joint names are not in the order of the file, siblings abound, some links have no inertial, and
    numbers are written in full.
    """
    rng = np.random.default_rng(seed)

    def numbers(values: Sequence[float] | np.ndarray) -> str:
        return " ".join(repr(float(x)) for x in values)

    def origin() -> str:
        return f'<origin xyz="{numbers(rng.uniform(-0.5, 0.5, 3))}" rpy="{numbers(rng.uniform(-3, 3, 3))}"/>'

    def inertial() -> str:
        if rng.random() < 0.2:
            return ""
        I = rng.standard_normal((3, 3))
        I = I @ I.T
        I = 0.05 * (np.trace(I) * np.eye(3) - I + 0.1 * np.eye(3))
        entries = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), I[np.triu_indices(3)], strict=True)
        shown = " ".join(f'{k}="{float(x)!r}"' for k, x in entries)
        return f'<inertial>{origin()}<mass value="{rng.uniform(0.1, 5)!r}"/><inertia {shown}/></inertial>'

    names = [f"{'abcXYZ_'[rng.integers(7)]}{rng.integers(1000)}_{i}" for i in range(joints)]
    links, elements, single = ['<link name="base">' + inertial() + "</link>"], [], []
    for i, name in enumerate(names):
        kind = kinds[rng.integers(len(kinds))]
        parent = "base" if i == 0 else rng.choice(["base", *(f"l{k}" for k in range(i))])
        body = f'<parent link="{parent}"/><child link="l{i}"/>{origin()}'
        if kind not in ("fixed", "floating", "planar"):
            axis = np.eye(3)[rng.integers(3)] * rng.choice([1, -1]) if rng.random() < 0.5 else rng.standard_normal(3)
            body += f'<axis xyz="{numbers(axis)}"/>'
        if kind in ("revolute", "prismatic"):
            body += (
                f'<limit lower="{-rng.uniform(0.5, 2)!r}" upper="{rng.uniform(0.5, 2)!r}" effort="10" velocity="3"/>'
            )
            if mimic and single and rng.random() < 0.5:
                body += f'<mimic joint="{rng.choice(single)}" multiplier="{rng.uniform(-2, 2)!r}" offset="0.25"/>'
            else:
                single.append(name)
        links.append(f'<link name="l{i}">{inertial()}</link>')
        elements.append(f'<joint name="{name}" type="{kind}">{body}</joint>')
    parts = [*links, *elements]
    order = rng.permutation(len(parts))
    text = "\n  ".join(parts[i] for i in order)
    return f'<?xml version="1.0"?>\n<robot name="random{seed}">\n  {text}\n</robot>\n'
