"""The data sheet of a robot, on one page."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..analysis.check import check
from ..analysis.identification import base_parameters
from ..analysis.workspace import payload_capacity, reach_map, static_load
from ..crosscheck import validate
from ..crosscheck.results import Report
from ..errors import ArgumentError, DualpinError
from ..forms import to_dh, to_screws
from ..forms.export import caption, display, residual_line
from ..forms.text import tidy
from ..functions import gravity
from ..model.describe import rows as joint_rows
from ..model.limits import effort_limits, ranges
from ..model.robot import Frame, Joint, Robot
from .page import page
from .sections import Section
from .skeleton import skeleton
from .voxels import workspace_section

STATES = 20_000
"""Random configurations for torques under gravity."""
REACH = 2_000_000
"""Random configurations of the workspace."""
SHOWN = 80
"""Base parameters that are written out."""


@dataclass(frozen=True)
class Table:
    """Rows of text under a heading; the first column names them."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    title: str = ""
    note: str = ""


@dataclass(frozen=True)
class Sheet:
    """What the template of a robot's section shows, in this order."""

    facts: Sequence[tuple[str, str]] = ()
    skeleton: Any = None
    tree: Any = None
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()
    says: str = ""


@dataclass(frozen=True)
class Node:
    """A joint in the tree of a robot."""

    name: str
    says: str
    children: list[Node] = field(default_factory=list)


def robot_page(robot: Robot, frame: str | Frame | None = None, *, samples: int = 200, reach: int = REACH) -> str:
    """The data sheet of a robot, a self-contained HTML page.

    Tree, drawing, joints and limits, masses, DH and screws, findings, base parameters, torques under
    gravity, workspace, and the verdict of the validation.

    Parameters
    ----------
    robot : Robot
    frame : str or Frame, optional
        What the forms and the workspace are of; by default the last frame that a joint moves.
    samples : int
        States for the comparison with Pinocchio; 0 leaves it out.
    reach : int
        Random configurations of the workspace; 0 leaves it out.

    Returns
    -------
    str

    Raises
    ------
    ArgumentError
        If Jinja is not installed, or the robot is of symbols.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.report import robot_page
    >>> html = robot_page(dp.load("ur5"), samples=2, reach=10_000)
    >>> "Base parameters" in html, "shoulder_pan_joint" in html
    (True, True)
    """
    if not isinstance(robot, Robot) or robot.numbers == "symbolic":
        raise ArgumentError("report: a page is of a robot of numbers")
    at = robot.frame(frame) if frame is not None else _tip(robot)
    parts = [_robot(robot), _joints(robot), _masses(robot), _forms(robot, at)]
    parts += [x for x in (_findings(robot), _base(robot), _torques(robot, at)) if x]
    if reach and at is not None and at.joint is not None and not robot.floating:
        parts.append(workspace_section(reach_map(robot, at, n=reach, progress=lambda done, n: None)))
    verdict = _verdict(robot, samples) if samples else None
    return page(*parts, *([verdict] if verdict is not None else []), title=f"{robot.name}: data sheet")


def _tip(robot: Robot) -> Frame | None:
    moved = [f for f in robot.frames if f.joint is not None]
    return moved[-1] if moved else None


def _robot(robot: Robot) -> Section:
    """General data, the tree, and a drawing in the middle of the limits."""
    lower, upper = ranges(robot)
    q = robot.neutral.copy()
    for j in robot:
        if j.mimic is None and not j.quaternions:
            q[j.q] = np.clip(q[j.q], lower[j.q], upper[j.q])
    total = sum(float(k.inertia.mass) for k in robot.links)
    facts = [
        ("joints", str(len(robot))), ("coordinates nq, velocities nv", f"{robot.nq}, {robot.nv}"),
        ("links", str(len(robot.links))), ("frames", str(len(robot.frames))),
        ("moving mass", f"{robot.mass:.6g} kg"), ("mass with the base", f"{total:.6g} kg"),
        ("gravity", f"({', '.join(f'{float(x):g}' for x in robot.gravity)}) m/s^2"),
    ]  # fmt: skip
    if robot.source:
        facts.append(("file", Path(robot.source).name))
    view = Sheet(facts=facts, skeleton=skeleton(robot, q), tree=_tree(robot), notes=robot.notes)
    return Section("Robot", "sheet.html.j2", view)


def _tree(robot: Robot) -> Node:
    """The tree of joints, with the links that each carries."""
    carried: dict[Joint | None, list[str]] = {}
    for link in robot.links:
        carried.setdefault(link.joint, []).append(link.name)
    nodes: dict[Joint | None, Node] = {None: Node("ground", ", ".join(carried.get(None, [])))}
    for j in robot:
        nodes[j] = Node(j.name, f"{j.kind}; {', '.join(carried.get(j, [])) or 'no link'}")
        nodes[j.parent].children.append(nodes[j])
    return nodes[None]


def _joints(robot: Robot) -> Section:
    head, *body = joint_rows(robot)
    speeds = {j.name: f"{j.limits.velocity:.4g}".replace("inf", "none") for j in robot}
    rows = [[row[1], row[2], *row[3:], speeds[j.name], ", ".join(f"{float(x):.4g}" for x in j.armature) or "0"]
            for row, j in zip(body, robot, strict=True)]  # fmt: skip
    table = Table([head[1], head[2], *head[3:], "velocity", "armature"], rows,
                  note="Angles in rad, lengths in m, effort in N m or N; as the description states them.")  # fmt: skip
    return Section("Joints and limits", "sheet.html.j2", Sheet(tables=[table]))


def _masses(robot: Robot) -> Section:
    rows = []
    for link in robot.links:
        if link.inertia.massless:
            continue
        centre, J = link.inertia.central
        moments = np.linalg.eigvalsh(J.array)
        c = ", ".join(f"{float(x):.4g}" for x in centre)
        rows.append([link.name, f"{float(link.inertia.mass):.5g}", c, *(f"{x:.4g}" for x in moments)])
    head = ["link", "mass [kg]", "centre in the link's frame [m]", "I1 [kg m^2]", "I2", "I3"]
    table = Table(head, rows, note="I1 to I3: principal moments about the centre; links without mass are left out.")
    return Section("Masses", "sheet.html.j2", Sheet(tables=[table]))


def _forms(robot: Robot, at: Frame | None) -> Section:
    """Denavit-Hartenberg rows and screws of the chain to a frame."""
    tables, says = [], ""
    try:
        tip = at.name if at is not None else None
        dh = to_dh(robot, tip=tip)
        head = ["row", "joint", "kind", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"]
        note = "; ".join([residual_line(dh), *dh.notes])
        tables.append(Table(head, [[*map(str, row)] for row in display(dh)], caption(dh), note))
        screws = to_screws(robot, tip=tip)
        rows = [[name, *map(tidy, s)] for name, s in zip(screws.joint_names, screws.screws, strict=True)]
        home = "; ".join(", ".join(tidy(x) for x in row) for row in screws.home[:3])
        head = ["joint", "wx", "wy", "wz", "vx", "vy", "vz"]
        tables.append(Table(head, rows, f"Screws in the {screws.frame} frame", f"Home, row by row: {home}"))
    except DualpinError as e:
        says = f"No chain to write down: {e}"
    return Section("Denavit-Hartenberg and screws", "sheet.html.j2", Sheet(tables=tables, says=says))


def _findings(robot: Robot) -> Section:
    """What `dualpin.check` finds in the file, or in the robot where it was made in code."""
    found = check(robot.source if robot.source and Path(robot.source).is_file() else robot)
    rows = [[f.rule, f.severity, f.item, f.says, f.why, f.fix] for f in found]
    says = "" if rows else "Nothing found."
    tables = [Table(["rule", "severity", "where", "what", "why it matters", "fix"], rows)] if rows else []
    return Section("Findings", "sheet.html.j2", Sheet(tables=tables, says=says))


def _base(robot: Robot) -> Section:
    base = base_parameters(robot)
    rows = [[name, f"{x:.6g}"] for name, x in list(zip(base.names, base.values(), strict=True))[:SHOWN]]
    left = len(base) - len(rows)
    kept, dropped = base.margin.kept, base.margin.dropped
    note = (
        f"Distance from the span of the others: at least {kept:.1e} of those kept, at most {dropped:.1e} of the rest."
    )
    note += f" {left} more are not shown." if left > 0 else ""
    facts = [("base parameters", str(len(base))), ("of", str(len(base.parameters)))]
    table = Table(["combination", "value"], rows, note=note)
    return Section("Base parameters", "sheet.html.j2", Sheet(facts, tables=[table]))


def _torques(robot: Robot, at: Frame | None) -> Section | None:
    """The largest torques that hold the robot, over random configurations, and what it could carry."""
    if robot.nv == 0:
        return None
    q, _, _ = robot.sample(STATES, seed=0)
    g = gravity(robot, q)
    limit = effort_limits(robot)
    rows = []
    for name, k in _named(robot):
        share = f"{100 * np.abs(g[:, k]).max() / limit[k]:.0f} %" if np.isfinite(limit[k]) else "no limit"
        rows.append(
            [name, f"{g[:, k].min():.4g}", f"{g[:, k].max():.4g}", f"{np.sqrt(np.mean(g[:, k] ** 2)):.4g}", share]
        )
    table = Table(["joint", "least", "greatest", "rms", "share of the limit"], rows,
                  note=f"[N m, N], over {STATES:,} random configurations within the limits, at rest.")  # fmt: skip
    facts = []
    if at is not None and at.joint is not None and np.isfinite(limit).any() and not robot.floating:
        some = q[:5000]
        held = payload_capacity(robot, some, at)
        share = np.abs(static_load(robot, some, at)).max(axis=-1)
        facts = [
            (f"mass that {at.name} holds anywhere", f"{held.min():.3g} kg"),
            ("in half of the configurations", f"{np.median(held):.3g} kg"),
            ("configurations in which it holds itself", f"{100 * (share <= 1).mean():.3g} %"),
        ]  # fmt: skip
    return Section("Torques under gravity", "sheet.html.j2", Sheet(facts, tables=[table]))


def _named(robot: Robot) -> Iterator[tuple[str, int]]:
    for j in robot:
        if j.mimic is None:
            for n, what in enumerate(j.model.velocity_names):
                yield (f"{j.name} {what}" if j.model.nv > 1 else j.name), j.v.start + n


def _verdict(robot: Robot, samples: int) -> Report | Section:
    try:
        return validate(robot, samples=samples)
    except (DualpinError, ImportError) as e:
        return Section("Validation", "sheet.html.j2", Sheet(says=f"Not compared with Pinocchio: {e}"))
