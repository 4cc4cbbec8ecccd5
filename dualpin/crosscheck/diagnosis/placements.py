"""Frames that stand elsewhere: the base, a tool, the origin of one joint, found from poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import acos, degrees

import numpy as np

from .case import Case, View
from .description import Description, Part
from .displaced import displaced
from .hypothesis import Hypothesis, Story
from .rules.register import ALL, SIX

SEEN = ("fk", *SIX, "com", "com_jacobian", "centroidal_momentum_matrix")
TOOLED = ("fk", *SIX, "frame_acceleration")
NOTICED = 1e-6
"""An offset below this is one of precision, not of place."""
SAME = 1e-7
"""Poses that are to be the same in all samples may differ by this: what is fitted is confirmed by the prediction."""


def placements(case: Case, term: str, story: Story) -> list[Hypothesis]:
    """What the poses of frames say of a base, a tool or an origin that stands elsewhere."""
    keys = {h.key for h in story}
    if "fk" not in case.observed or keys & {"base_offset", "tool_offset", "origin_fit"}:
        return []
    x, p = case.observed["fk"], case.predict("fk", tuple(h for h in story if "fk" in h.terms))
    if p is None or x.shape != p.shape:
        return []
    have = [k for k in range(x.shape[1]) if np.isfinite(x[:, k]).all()]
    off = [k for k in have if np.abs(x[:, k] - p[:, k]).max() > NOTICED]
    if not off:
        return []
    found = []
    found += _base(case, x, p, have)
    if term in TOOLED:
        found += _tools(case, x, p, off)
    if not story:
        found += _origins(case, x, p, have, off)
    return found


def _constant(poses: np.ndarray) -> np.ndarray | None:
    """The one pose that all are, if they are one."""
    return poses[0] if np.abs(poses - poses[0]).max() < SAME else None


def _words(H: np.ndarray) -> str:
    angle = degrees(acos(max(-1.0, min(1.0, (np.trace(H[:3, :3]) - 1) / 2))))
    return f"({', '.join(f'{x + 0.0:.4g}' for x in H[:3, 3])}) m, {angle:.4g} deg"


def _base(case: Case, x: np.ndarray, p: np.ndarray, have: Sequence[int]) -> list[Hypothesis]:
    """The subject's world seen in ours: x = B p, for all frames."""
    B = _constant(np.concatenate([x[:, k] @ np.linalg.inv(p[:, k]) for k in have]))
    if B is None or np.abs(B - np.eye(4)).max() < NOTICED:
        return []
    link = _link_at(case, B)
    words = _words(B) + (f" (the base's pose is given to {link})" if link else "")
    fix = (
        f"give the pose to {case.description.root}, not to {link}"
        if link
        else "place the robot's base at the world's origin"
    )
    h = Hypothesis(
        "base_offset", "the base stands elsewhere", SEEN, "change", lambda view, term, x: _moved(term, x, B), fix, (),
        words, 1.0 if link else 1.5,
    )  # fmt: skip
    # a base that does not move carries all that hangs on it; one that floats is seen from elsewhere
    return [h if case.floating else replace(h, terms=ALL, place="edit", act=lambda d, items: _set(d, B))]


def _set(d: Description, B: np.ndarray) -> Description:
    """The root with all that hangs on it, moved by B."""
    return d.with_parts(lambda p, _: p.placed(B @ p.pose) if p.parent == d.root else p)


def _link_at(case: Case, B: np.ndarray) -> str:
    """The link on the root whose frame is taken for the root's."""
    for f in case.robot.frames:
        if f.role == "link" and (f.joint is None or (case.floating and f.joint is case.robot.joints[0])):
            P = np.array([[float(c) for c in row] for row in f.placement.rows])
            if np.abs(P - np.eye(4)).max() > 1e-9 and np.abs(np.linalg.inv(P) - B).max() < 1e-9:
                return f.name
    return ""


def _moved(term: str, x: np.ndarray, B: np.ndarray) -> np.ndarray:
    R, p = B[:3, :3], B[:3, 3]
    if term == "fk":
        return np.asarray(B @ x)
    if term == "com":
        return x @ R.T + p
    if term == "com_jacobian":
        return R @ x
    if term == "frame_velocity":
        return np.concatenate([x[..., :3] @ R.T, x[..., 3:] @ R.T], -1)
    return np.concatenate([R @ x[..., :3, :], R @ x[..., 3:, :]], -2)


def _tools(case: Case, x: np.ndarray, p: np.ndarray, off: Sequence[int]) -> list[Hypothesis]:
    """Frames that stand elsewhere on their links: x = p T, a T for each."""
    tools = {}
    for k in off:
        T = _constant(np.linalg.inv(p[:, k]) @ x[:, k])
        if T is not None:
            tools[k] = T
    if not tools:
        return []
    frames = tuple(case.frames[k] for k in tools)
    words = "; ".join(_words(T) for T in list(tools.values())[:3])
    says, fix = "frames stand elsewhere on their links", "use the link's own frame, at its joint"
    return [
        Hypothesis("tool_offset", says, TOOLED, "change", _tooled(tools), fix, frames, words, 1.6 + 0.2 * len(tools))
    ]


def _tooled(tools: Mapping[int, np.ndarray]) -> Callable[[View, str, np.ndarray], np.ndarray]:
    return lambda view, term, x: displaced(view, term, x, tools)


def _origins(case: Case, x: np.ndarray, p: np.ndarray, have: Sequence[int], off: Sequence[int]) -> list[Hypothesis]:
    """One joint (or fixed joint) whose origin stands elsewhere: every frame below it is moved alike."""
    view = case.view(())
    if view is None:
        return []
    below = _below(case)
    poses = _joint_sides(case, view)
    out = []
    for part in case.description.parts:
        beneath = [k for k in have if case.frames[k] in below[part.joint]]
        if not set(off) <= set(beneath) or part.joint not in poses:
            continue
        A = poses[part.joint]
        moved = [np.linalg.inv(A) @ x[:, k] @ np.linalg.inv(p[:, k]) @ A for k in off]
        D = _constant(np.concatenate(moved))
        if D is not None:
            out.append(_origin(part, D))
    return out[-4:]


def _origin(part: Part, D: np.ndarray) -> Hypothesis:
    def edit(d: Description, items: Sequence[str]) -> Description:
        return d.with_parts(lambda p, _: p.placed(p.pose @ D) if p.joint == part.joint else p)

    says, fix = "the origin of a joint stands elsewhere", "compare the joint's <origin> and zero position with the file"
    return Hypothesis("origin_fit", says, ALL, "edit", edit, fix, (part.joint,), _words(D), 2.3, single=True)


def _below(case: Case) -> dict[str, set[str]]:
    """The links that each joint carries."""
    found: dict[str, set[str]] = {p.joint: {p.link} for p in case.description.parts}
    by_link = {p.link: p for p in case.description.parts}
    for p in case.description.parts:
        up = by_link.get(p.parent)
        while up is not None:
            found[up.joint].add(p.link)
            up = by_link.get(up.parent)
    return found


def _joint_sides(case: Case, view: View) -> dict[str, np.ndarray]:
    """The pose of each joint's origin in the world, before it moves (n, 4, 4)."""
    from ...call import evaluate as call

    q, robot = view.states["q"], case.robot
    links: dict[str, np.ndarray] = {}
    out = {}
    for p in case.description.parts:
        if p.parent not in links:
            links[p.parent] = call(robot, "frame_pose", {"q": q}, engine="numpy", frame=robot.frame(p.parent))
        out[p.joint] = links[p.parent] @ p.pose
    return out
