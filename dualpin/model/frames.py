"""Frames by name: those of the description, and those at centres of mass, which are made on request."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import ArgumentError, FrameNotFoundError, nearest
from ..spatial.pose import Pose
from .memory import memory
from .robot import Robot
from .tree import Frame

COM = "com:"


def find(robot: Robot, name: str | int | Frame) -> Frame:
    """The frame of that name or index.

    Parameters
    ----------
    name : str, int or Frame
        A name that a link and a joint share means the link.  "com:LINK" is the frame at a link's centre of mass
        with the axes of the link's frame; it is not listed in `Robot.frame_names`.  An index counts
        `Robot.frames`.

    Raises
    ------
    FrameNotFoundError
        If there is none, with the nearest names.
    ArgumentError
        If it is neither a name, an index nor a frame, or is "com:" of a link without mass.

    Examples
    --------
    >>> import numpy as np, dualpin as dp
    >>> robot = dp.load("ur5")
    >>> dp.fk(robot, np.zeros(6), "com:upper_arm_link")[:3, 3].round(5).tolist()
    [0.28, 0.13585, 0.08916]
    """
    if isinstance(name, Frame):
        if not any(f is name for f in robot.frames) and _centres(robot).get(name.name) is not name:
            raise FrameNotFoundError(f"frame {name.name!r} is of another robot than {robot.name}; give its name")
        return name
    if isinstance(name, (int, np.integer)) and not isinstance(name, bool):
        if -len(robot.frames) <= name < len(robot.frames):
            return robot.frames[name]
        raise FrameNotFoundError(f"frame {name} of {robot.name}: it has {len(robot.frames)} frames")
    if not isinstance(name, str):
        raise ArgumentError(f"frame: a name, an index or a Frame expected, got {type(name).__name__}")
    found = _named(robot).get(name) or _centre(robot, name)
    if found is None:
        raise FrameNotFoundError(f"frame {name!r} not in {robot.name}; {nearest(name, robot.frame_names, 'frames')}")
    return found


def key(robot: Robot, frame: Any) -> int | str:
    """A key that `find` accepts, in this robot and in copies of it (with other scalars, unpickled)."""
    return frame.name if frame.role == "com" else robot.frames.index(frame)


def _named(robot: Robot) -> dict[str, Frame]:
    kept = memory(robot)
    if "frames" not in kept:
        # of frames with one name the last is taken: a link's before a joint's, a moving joint's before a fixed one's
        order = sorted(robot.frames, key=lambda f: (f.role == "link", f.role != "fixed_joint"))
        kept["frames"] = {f.name: f for f in order}
    named: dict[str, Frame] = kept["frames"]
    return named


def _centres(robot: Robot) -> dict[str, Frame]:
    """The frames at centres of mass that were requested before."""
    centres: dict[str, Frame] = memory(robot).setdefault("centres", {})
    return centres


def _centre(robot: Robot, name: str) -> Frame | None:
    """The frame "com:LINK", always the same object."""
    if not name.startswith(COM):
        return None
    wanted = name.removeprefix(COM)
    link = next((k for k in robot.links if k.name == wanted), None)
    if link is None:
        raise FrameNotFoundError(
            f"frame {name!r}: {robot.name} has no link {wanted!r}; {nearest(wanted, robot.link_names, 'links')}"
        )
    if link.inertia.massless:
        raise ArgumentError(f"frame {name!r}: link {wanted!r} of {robot.name} has no mass, so it has no centre of mass")
    centre, _ = link.inertia.central
    parent = robot.frames.index(_named(robot)[wanted])
    return _centres(robot).setdefault(
        name, Frame(name, "com", link.joint, link.placement @ Pose(position=centre), parent)
    )
