"""MJCF to `Robot`, by the model that MuJoCo compiles: its defaults, includes, meshes and frames are resolved there.

    X_body(q) = X_parent X_b  prod_k  T(p_k) motion_k(q_k - q_k0) T(-p_k)

X_b is the body's pose in its parent, p_k the anchor of its k-th joint, q_k0 the coordinate at which the file shows
it.  A joint of the robot is T(p_k) and a motion about its origin, so T(-p_k) moves on to what comes after.

References
----------
MuJoCo documentation, "Computation: kinematics" and "XML reference".
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from ..dual import Dual
from ..errors import ArgumentError, UrdfError, nearest
from ..extras import extra
from ..model.builder import Builder
from ..model.joints import Floating, JointModel, prismatic, revolute, spherical
from ..model.robot import BASE, Limits, Mimic, Robot
from ..scalars import ZERO
from ..spatial.arrays import to_matrix
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import Vector3
from .axes import unit_axis
from .document import unused
from .notes import Notes

FREE, BALL, SLIDE, HINGE = range(4)  # mjtJoint
LOOK = 1 << 16  # bytes within which the root element begins


def is_mjcf(source: Path | bytes | str) -> bool:
    """Whether the root element is <mujoco>, whatever the file is called."""
    if isinstance(source, Path):
        try:
            with source.open("rb") as stream:
                source = stream.read(LOOK)
        except OSError:
            return False  # reading it raises the error
    data = source[:LOOK].encode("utf-8", "replace") if isinstance(source, str) else source[:LOOK]
    parser = etree.XMLPullParser(("start",), resolve_entities=False, no_network=True, load_dtd=False, recover=True)
    try:
        parser.feed(data)
        return any(True for _, e in parser.read_events() if e.tag == "mujoco" and e.getparent() is None)
    except (etree.XMLSyntaxError, ValueError):
        return False


def read_mjcf(
    source: Path | bytes | str, floating: bool, mimic: bool, without: Sequence[str] = (), name: str = "<text>"
) -> Robot:
    """The robot of an MJCF file or text.

    Parameters
    ----------
    source : Path, bytes or str
    floating : bool
        Give the world body six degrees of freedom; for a model whose bodies are fixed in the world.
    mimic : bool
        Let a joint whose equality says that it is linear in another's coordinate follow that, rigidly.
    without : sequence of str
        Tendons and equalities to leave out.
    name : str
        Of the text, in messages.

    Raises
    ------
    UrdfError
        If MuJoCo refuses the file, or the model holds what a tree of joints does not.
    """
    mujoco = extra("mujoco", "mujoco", "an MJCF file")
    name = source.name if isinstance(source, Path) else name
    try:
        with _listening(mujoco) as said:
            if isinstance(source, Path):
                model = mujoco.MjModel.from_xml_path(str(source))
            else:
                model = mujoco.MjModel.from_xml_string(source if isinstance(source, str) else source.decode("utf-8"))
    except (ValueError, UnicodeDecodeError, mujoco.FatalError) as e:
        raise UrdfError(f"{name}: MuJoCo refuses it: {' '.join(str(e).split())[:400]}") from None
    try:
        reader = _Reader(mujoco, model, name, without)
        for text in said:
            reader.notes.add(f"MuJoCo: {text}")
        return reader.robot(floating, mimic, source)
    except ArgumentError as e:
        raise UrdfError(f"{name}: {e}") from None


@contextmanager
def _listening(mujoco: Any) -> Iterator[list[str]]:
    """Collect MuJoCo's warnings, which it otherwise prints and writes to a file in the current folder."""
    said: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: said.append(" ".join(str(text).split())))
    try:
        yield said
    finally:
        mujoco.set_mju_user_warning(before)


class _Reader:
    """A compiled model while its bodies become joints."""

    def __init__(self, mujoco: Any, model: Any, source: str, without: Sequence[str]) -> None:
        self.mj, self.m, self.source = mujoco, model, source
        self.notes = Notes()
        title = _name(model.names, 0)
        self.b = Builder(title or Path(source).stem.strip("<>") or "robot", self._gravity())
        self.bodies = self._names("body", model.nbody)
        self.joints = self._names("joint", model.njnt)
        self.without = tuple(without)
        known = {*self._names("tendon", model.ntendon), *self._names("equality", model.neq)}
        for x in self.without:
            if x not in known:
                raise ArgumentError(f"without: {x!r} is no tendon or equality; {nearest(x, known)}")

    def robot(self, floating: bool, mimic: bool, source: Any) -> Robot:
        followers = self._checked(mimic)
        m, b = self.m, self.b
        if floating:
            b.joint(BASE, Floating(), link=self.bodies[0])
        else:
            b.base(self.bodies[0])
        for i in range(1, m.nbody):
            self._body(i, followers)
        for i in range(m.nsite):
            self._site(i)
        self._remarks()
        robot = b.robot()
        path = str(source) if isinstance(source, (Path, os.PathLike)) else None
        return replace(robot, notes=(*self.notes.texts(), *robot.notes), source=path)

    # names

    def _names(self, kind: str, count: int) -> list[str]:
        """Names of all elements of a kind; those without one get a numbered name that is not in use."""
        of: Callable[[int], Any] = getattr(self.m, kind)
        found = [of(i).name for i in range(count)]
        taken = set(found)
        return [name or unused(f"{kind}{i}", taken) for i, name in enumerate(found)]

    def _gravity(self) -> list[float]:
        off = self.m.opt.disableflags & int(self.mj.mjtDisableBit.mjDSBL_GRAVITY)
        return [0.0, 0.0, 0.0] if off else self.m.opt.gravity.tolist()

    # bodies

    def _body(self, i: int, followers: dict[int, Mimic]) -> None:
        m, b, name = self.m, self.b, self.bodies[i]
        inertia, on, X = self._inertia(i), self.bodies[m.body_parentid[i]], _pose(m.body_pos[i], m.body_quat[i])
        first, count = int(m.body_jntadr[i]), int(m.body_jntnum[i])
        if m.body_mocapid[i] >= 0:
            self.notes.add("a mocap body stands still", "body", name)
        carried = False
        for k in range(first, first + count):
            model, anchor = self._joint(k), Vector3(*map(float, m.jnt_pos[k]))
            if m.jnt_type[k] == FREE:
                X, anchor = IDENTITY_POSE, Vector3(ZERO, ZERO, ZERO)
            centred = not any(map(float, anchor))
            carried = centred and k == first + count - 1
            link = name if carried else self._free(self.joints[k])
            b.joint(
                self.joints[k], model, on, X @ Pose(position=anchor) @ self._shown(k), inertia if carried else None,
                link=link, limits=self._limits(k), mimic=followers.get(k), armature=self._armature(k, model),
            )  # fmt: skip
            on, X = link, IDENTITY_POSE if centred else Pose(position=-anchor)
        if not carried:
            b.fixed(self._free(f"{name}_fixed"), on, X, inertia, link=name)

    def _free(self, name: str) -> str:
        """A name that no body, joint or frame has."""
        taken = {*self.bodies, *self.b._link_places}
        while name in taken or (name not in self.joints and name in self.b._places):
            name += "_link"
        return name

    def _inertia(self, i: int) -> Inertia | None:
        m = self.m
        if not m.body_mass[i] and not m.body_inertia[i].any():
            return None
        R = _rotation(m.body_iquat[i])
        central = R @ np.diag(m.body_inertia[i]) @ R.T
        return Inertia.of(float(m.body_mass[i]), m.body_ipos[i].tolist(), ((central + central.T) / 2).tolist())

    # joints

    def _joint(self, k: int) -> JointModel:
        m = self.m
        if m.jnt_type[k] == FREE:
            return Floating()
        if m.jnt_type[k] == BALL:
            return spherical()
        axis = unit_axis(m.jnt_axis[k])
        return prismatic(axis) if m.jnt_type[k] == SLIDE else revolute(axis)

    def _shown(self, k: int) -> Pose:
        """What undoes the coordinate at which the file shows the joint: motion(q - q0) = motion(-q0) motion(q)."""
        q0 = float(self.m.qpos0[self.m.jnt_qposadr[k]])
        if self.m.jnt_type[k] not in (SLIDE, HINGE) or q0 == 0:
            return IDENTITY_POSE
        angle = Dual(ZERO, -q0) if self.m.jnt_type[k] == SLIDE else Dual(-q0, ZERO)
        return Pose.about(unit_axis(self.m.jnt_axis[k]), angle)

    def _dof(self, k: int) -> int:
        return int(self.m.jnt_dofadr[k])

    def _armature(self, k: int, model: JointModel) -> list[float]:
        return [float(x) for x in self.m.dof_armature[self._dof(k) : self._dof(k) + model.nv]]

    def _limits(self, k: int) -> Limits:
        m, at = self.m, self._dof(k)
        effort = float(np.abs(m.jnt_actfrcrange[k]).max()) if m.jnt_actfrclimited[k] else inf
        bounds: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
        if m.jnt_type[k] in (SLIDE, HINGE) and m.jnt_limited[k]:
            bounds = (float(m.jnt_range[k, 0]),), (float(m.jnt_range[k, 1]),)
        elif m.jnt_limited[k]:
            self.notes.add("the cone of a ball joint is not kept", "joint", self.joints[k])
        return Limits(*bounds, inf, effort, float(m.dof_damping[at]), float(m.dof_frictionloss[at]))

    def _site(self, i: int) -> None:
        m, b = self.m, self.b
        name = m.site(i).name
        if name:
            taken = name in b._places or name in b._link_places
            b.frame(self._free(f"{name}_site") if taken else name, self.bodies[m.site_bodyid[i]],
                    _pose(m.site_pos[i], m.site_quat[i]))  # fmt: skip

    # what a tree of joints does not hold

    def _checked(self, mimic: bool) -> dict[int, Mimic]:
        """Refuse by name what would change the motion and has no counterpart; joint -> what it follows."""
        m, followers = self.m, {}
        wrong: list[str] = []
        for i, name in enumerate(self._names("tendon", m.ntendon)):
            if name in self.without:
                self.notes.add("left out as asked", "tendon", name)
            else:
                wrong.append(f"tendon {name!r}{self._over(i)}")
        for i, name in enumerate(self._names("equality", m.neq)):
            kind = self.mj.mjtEq(m.eq_type[i]).name.removeprefix("mjEQ_").lower()
            follower = self._follower(i) if mimic else None
            if name in self.without:
                self.notes.add("left out as asked", "equality", name)
            elif not m.eq_active0[i]:
                self.notes.add("an equality that is not active is left out", "equality", name)
            elif follower is not None:
                followers[int(m.eq_obj1id[i])] = follower
            else:
                wrong.append(f"equality {name!r} ({kind}{self._between(i, kind)})")
        if wrong:
            raise UrdfError(
                f"{self.source}: {'; '.join(wrong)}: a tree of joints holds no tendons and equalities.  "
                f"`without=[name, ...]` leaves them out{self._way_out()}"
            )
        for kind, count in (("flex", m.nflex), ("plugin", m.nplugin)):
            if count:
                names = self._names("flex", count) if kind == "flex" else [str(count)]
                raise UrdfError(f"{self.source}: {kind} {', '.join(names)}: bodies that are not rigid are not read")
        return followers

    def _over(self, i: int) -> str:
        """The joints that a fixed tendon combines, or what a spatial one goes along."""
        m = self.m
        at, n = int(m.tendon_adr[i]), int(m.tendon_num[i])
        ids = [int(m.wrap_objid[k]) for k in range(at, at + n) if m.wrap_type[k] == int(self.mj.mjtWrap.mjWRAP_JOINT)]
        return f" (over {', '.join(self.joints[k] for k in ids)})" if ids else " (spatial)"

    def _between(self, i: int, kind: str) -> str:
        if kind != "joint":
            return ""
        ids = (int(self.m.eq_obj1id[i]), int(self.m.eq_obj2id[i]))
        return " of " + " and ".join(self.joints[k] for k in ids if k >= 0)

    def _way_out(self) -> str:
        kinds = {int(k) for k in self.m.eq_type}
        return (
            "; `mimic=True` reads a linear one of two joints as rigid" if int(self.mj.mjtEq.mjEQ_JOINT) in kinds else ""
        )

    def _follower(self, i: int) -> Mimic | None:
        """q1 - q1_0 = c0 + c1 (q2 - q2_0) of an equality of two joints, where nothing is of higher order."""
        m = self.m
        one, other, c = int(m.eq_obj1id[i]), int(m.eq_obj2id[i]), m.eq_data[i][:5]
        if m.eq_type[i] != int(self.mj.mjtEq.mjEQ_JOINT) or other < 0 or c[2:].any():
            return None
        one0, other0 = (float(m.qpos0[m.jnt_qposadr[k]]) for k in (one, other))
        return Mimic(self.joints[other], float(c[1]), float(c[0] + one0 - c[1] * other0))

    def _remarks(self) -> None:
        m = self.m
        for k, name in enumerate(self.joints):
            if m.jnt_stiffness[k]:
                self.notes.add("springs are not kept, no term contains them", "joint", name)
            if m.dof_damping[self._dof(k)] or m.dof_frictionloss[self._dof(k)]:
                self.notes.add("damping and friction are kept, but no term contains them", "joint", name)
        for i, name in enumerate(self.bodies):
            if m.body_gravcomp[i]:
                self.notes.add("the compensation of gravity is not kept", "body", name)
        if m.nu:
            self.notes.add("actuators are not kept: torques act on the joints", "actuator", f"{m.nu} of them")
        if m.opt.density or m.opt.viscosity:
            self.notes.add("the forces of a fluid are not kept")


def _name(names: bytes, at: int) -> str:
    """The text that ends with the first zero."""
    return names[at : names.index(b"\0", at)].decode("utf-8", "replace")


def _rotation(wxyz: np.ndarray) -> np.ndarray:
    wxyz = wxyz / np.linalg.norm(wxyz)
    return to_matrix(np.array([*wxyz, 0.0, 0.0, 0.0, 0.0]))[:3, :3]


def _pose(position: np.ndarray, wxyz: np.ndarray) -> Pose:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = _rotation(wxyz), position
    return Pose.from_matrix(X)
