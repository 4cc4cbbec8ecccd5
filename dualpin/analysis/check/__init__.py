"""Faults of robot descriptions, with their effect on terms.

References
----------
Wensing, Kim & Slotine (2018), "Linear matrix inequalities for physically consistent inertial parameter
identification: a statistical perspective on the mass distribution", IEEE RA-L 3(1).
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

from ...model.robot import Robot
from . import joints, limbs, shapes, tensors, texts  # noqa: F401  (they enter their rules)
from .description import described
from .effects import Effects
from .findings import Checked, Edit, Effect, Finding
from .fixing import diff, fixed
from .rules import RULES, Case, Rule, run, wanted

__all__ = ["RULES", "Checked", "Edit", "Effect", "Finding", "Rule", "check", "diff", "fixed"]


def check(
    robot: str | Path | Robot, *, only: Iterable[str] | None = None, without: Iterable[str] | None = None
) -> Checked:
    """Look for faults of a robot description.

    Parameters
    ----------
    robot : str, Path or Robot
        A name or a file (URDF, xacro, MJCF), whose lines, shapes and meshes are checked too; or a robot, whose
        masses, tensors and joints are checked.
    only, without : iterable of str, optional
        Ids of rules, of `dualpin.analysis.check.RULES`.

    Returns
    -------
    Checked
        A sequence of findings: ``.rule .severity .says .item .file .line .why .effect .fix``, in the order
        of the file.  ``.passed`` is True if there is none.

    Raises
    ------
    UrdfError
        If the file cannot be read; the message says why and where.
    ArgumentError
        If there is no such rule.

    Examples
    --------
    >>> import dualpin as dp
    >>> text = '''<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/>
    ... <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="3"/></inertial></link>
    ... <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>'''
    >>> found = dp.check(dp.loads(text))
    >>> [f.rule for f in found], found[0].effect.unit
    (['triangle-inequality'], 'N m')
    """
    ids = (wanted(only, "only") or set(RULES)) - wanted(without, "without")
    about = described(robot)
    found = list(run(Case(about, Effects(about.robot, about.floating)), ids))
    notes = []
    if about.document is not None and not find_spec("trimesh"):
        notes.append("shapes were not compared with masses: pip install 'dualpin[view]' brings trimesh")
    return Checked(about.name, found, len(about.bodies), len(about.hinges), about.text, notes)
