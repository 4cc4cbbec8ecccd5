"""URDF to `Robot`: the only place that knows yourdfpy.

yourdfpy parses the checked document; what its numbers mean follows the rules that reproduce
Pinocchio's models exactly: depth-first joint order with siblings by name, fixed joints merged,
axes normalised.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from io import BytesIO
from math import inf
from typing import IO, Any

import numpy as np
from lxml import etree

from ..errors import ArgumentError, DualpinWarning, UrdfError
from ..model.builder import Builder
from ..model.joints import Floating, JointModel, Planar, prismatic, revolute
from ..model.robot import Limits, Mimic, Robot, Rotor
from ..scalars import exact
from ..spatial.inertia import Inertia
from ..spatial.pose import IDENTITY_POSE, Pose
from ..spatial.vector import ZERO_VECTOR, Matrix3, Vector3
from .axes import unit_axis
from .catalogue import find
from .description import yourdfpy
from .document import Document, depth_first
from .mjcf import is_mjcf, read_mjcf
from .remarks import remark
from .xml import parse, read, read_stream


def load(
    name_or_path: str | os.PathLike[str] | IO[Any],
    floating: bool = False,
    mimic: bool = False,
    *,
    xacro_args: Mapping[str, Any] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    without: Sequence[str] = (),
) -> Robot:
    """A robot from a file (URDF, xacro, MJCF), or by its name in example-robot-data.

    Parameters
    ----------
    name_or_path : str, path or file object
        "panda", "ur5", ... (`dualpin list` prints all), a path to a file, or an open file.  A file that ends
        in ``.xacro`` is expanded first; one whose root element is <mujoco> is compiled by MuJoCo.
    floating : bool
        Give the base six degrees of freedom: joint "root_joint", q = (x y z, qw qx qy qz).
    mimic : bool
        Let joints with a <mimic> tag follow; otherwise they are joints like others.
    xacro_args : mapping, optional
        What ``$(arg name)`` of an xacro file stands for.
    packages : mapping, optional
        Name -> folder of the ROS packages that an xacro file finds; others are looked for in the folders
        above it and in ROS_PACKAGE_PATH.
    without : sequence of str
        Tendons and equalities of an MJCF to leave out: a model that has others is refused.

    Returns
    -------
    Robot
        Joints in Pinocchio's order, or in MuJoCo's.  ``robot.notes`` says what was assumed or looks odd.

    Raises
    ------
    UrdfError
        If the file cannot be found, read or trusted; the message names element, attribute and line.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.load("panda").joint_names[:2]
    ['panda_joint1', 'panda_joint2']
    """
    if hasattr(name_or_path, "read"):
        text, source = read_stream(name_or_path)
        return _announced(_of_text(text, source, floating, mimic, without))
    if not isinstance(name_or_path, (str, os.PathLike)):
        raise ArgumentError(f"load: a name or a path or an open file expected, got {type(name_or_path).__name__}")
    path = find(name_or_path, xacro_args, packages)
    if is_mjcf(path):
        return _announced(read_mjcf(path, floating, mimic, without))
    return _announced(build(read(path), floating, mimic, str(path)))


def loads(data: bytes | str, floating: bool = False, mimic: bool = False, source: str = "<text>") -> Robot:
    """A robot from the text of a URDF or an MJCF.

    Parameters
    ----------
    data : str or bytes
        What the file holds.
    floating, mimic : bool
        As in `load`.
    source : str
        Its name in messages; a robot without a name gets the stem of it.

    Returns
    -------
    Robot
        With ``robot.source`` None.

    Raises
    ------
    UrdfError

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.loads('<robot name="post"><link name="base"/></robot>').nv
    0
    """
    if not isinstance(data, (bytes, str)):
        raise ArgumentError(f"loads: the text of a URDF expected, got {type(data).__name__}")
    return _announced(_of_text(data, source, floating, mimic, ()))


def _of_text(data: bytes | str, source: str, floating: bool, mimic: bool, without: Sequence[str]) -> Robot:
    if is_mjcf(data):
        return read_mjcf(data, floating, mimic, without, source)
    return build(parse(data, source), floating, mimic, None)


def _announced(robot: Robot) -> Robot:
    if robot.notes:
        warnings.warn(f"{robot.name}: " + "; ".join(robot.notes), DualpinWarning, stacklevel=3)
    return robot


def build(document: Document, floating: bool, mimic: bool, source: str | None) -> Robot:
    """The robot of a checked document."""
    taken = document.joints.get("root_joint")
    if floating and taken is not None and taken.get("type") != "fixed":
        document.fail(taken, "joint 'root_joint': the name is reserved for the floating base")
    description = _described(document)
    links = {link.name: link for link in description.links}
    joints = {joint.name: joint for joint in description.joints}
    children: dict[str, list[tuple[str, str]]] = {}
    for joint in joints.values():
        children.setdefault(joint.parent, []).append((joint.name, joint.child))
    b = Builder(description.name)
    b.source = source
    base = _inertia(links[document.base])
    if floating:
        b.joint("root_joint", Floating(), inertia=base, link=document.base)
    else:
        b.base(document.base, base)
    for name in depth_first(children, document.base):
        _add(b, joints[name], links[joints[name].child], mimic, document.reductions.get(name))
    try:
        robot = b.robot()
    except ArgumentError as e:
        where = (joint for name, joint in document.joints.items() if str(e).startswith(f"joint {name!r} "))
        document.fail(next(where, None), str(e))
    remark(document, robot, mimic)
    return replace(robot, notes=(*document.notes.texts(), *robot.notes))


def _described(document: Document) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        stream = BytesIO(etree.tostring(document.root))
        try:
            return yourdfpy().URDF.load(stream, build_scene_graph=False, load_meshes=False).robot
        except (ValueError, TypeError, LookupError, AttributeError) as e:  # of another release than was tested
            raise UrdfError(f"{document.source}: yourdfpy cannot read what was checked ({e})") from e


def _add(b: Builder, joint: Any, link: Any, mimic: bool, reduction: float | None) -> None:
    placement = IDENTITY_POSE if joint.origin is None else Pose.from_matrix(joint.origin)
    inertia = _inertia(link)
    if joint.type == "fixed":
        b.fixed(joint.name, joint.parent, placement, inertia, link=joint.child)
        return
    follows = joint.mimic if mimic else None
    model = _model(joint)
    b.joint(
        joint.name, model, joint.parent, placement, inertia, link=joint.child, limits=_limits(joint),
        mimic=None if follows is None else Mimic(follows.joint, *_ratio(follows)),
        rotor=None if reduction is None or model.nv != 1 else Rotor(ratio=reduction),
    )  # fmt: skip


def _ratio(mimic: Any) -> tuple[float, float]:
    multiplier = 1.0 if mimic.multiplier is None else float(mimic.multiplier)
    return multiplier, 0.0 if mimic.offset is None else float(mimic.offset)


def _model(joint: Any) -> JointModel:
    if joint.type == "floating":
        return Floating()
    if joint.type == "planar":
        return Planar()
    axis = unit_axis(joint.axis)
    return prismatic(axis) if joint.type == "prismatic" else revolute(axis, kind=joint.type)


def _limits(joint: Any) -> Limits:
    limit, dynamics = joint.limit, joint.dynamics
    damping = float((dynamics and dynamics.damping) or 0.0)
    friction = float((dynamics and dynamics.friction) or 0.0)
    if limit is None:
        return Limits(damping=damping, friction=friction)
    bounds: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
    if joint.type in ("revolute", "prismatic"):
        bounds = (float(limit.lower or 0.0),), (float(limit.upper or 0.0),)
    velocity, effort = (inf if x is None else float(x) for x in (limit.velocity, limit.effort))
    return Limits(*bounds, velocity, effort, damping, friction)


def _inertia(link: Any) -> Inertia | None:
    """The ten parameters about the link's own frame, from mass, centre and inertia about it."""
    if link.inertial is None:
        return None
    origin = IDENTITY_POSE if link.inertial.origin is None else Pose.from_matrix(link.inertial.origin)
    rows = [Vector3(*map(exact, row)) for row in np.asarray(link.inertial.inertia, dtype=float).tolist()]
    return origin @ Inertia(exact(float(link.inertial.mass)), ZERO_VECTOR, Matrix3(*rows))
