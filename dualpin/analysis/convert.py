"""Conversion of a robot to another format, verified by the library that reads this format."""

from __future__ import annotations

import os
import sys
import warnings
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ..crosscheck.judging import judged
from ..crosscheck.results import AGREES, DIFFERS, RobotResult
from ..crosscheck.subjects import QUESTIONS, Asking, resolve
from ..crosscheck.subjects.asking import random_states
from ..crosscheck.subjects.convention import columns
from ..errors import ArgumentError, DualpinWarning
from ..io.mjcf import is_mjcf
from ..io.urdf import load
from ..model.robot import Robot
from .diff import Diff, diff

SUBJECTS = {
    ".urdf": ("pinocchio", "pinocchio"),
    ".xml": ("mujoco:clean", "mujoco"),
    ".mjcf": ("mujoco:clean", "mujoco"),
}
"""Suffix -> the subject that reads it, and the module that this needs."""


LISTED = 3  # items listed of each kind of loss


@dataclass
class Conversion:
    """The outcome of a conversion, with the comparison by the target's library.

    Attributes
    ----------
    terms : dict
        Term -> largest scaled difference over the states, between dualpin's values of the robot that was read and
        the library's values of the file that was written.
    differs : list of str
        The terms that differ by more than rounding.
    diff : Diff
        Of the robot that was read and the one that dualpin reads back.
    notes : list of str
        What the target cannot hold.
    reason : str
        Why nothing was compared.
    """

    source: str
    target: str
    library: str = ""
    terms: dict[str, float] = field(default_factory=dict)
    differs: list[str] = field(default_factory=list)
    diff: Diff | None = None
    notes: list[str] = field(default_factory=list)
    reason: str = ""

    @property
    def passed(self) -> bool:
        """Whether the library read the file and agrees in every term."""
        return bool(self.terms) and not self.differs

    def to_dict(self) -> dict[str, Any]:
        return {
            "source": self.source, "target": self.target, "library": self.library, "passed": self.passed,
            "terms": self.terms, "differs": self.differs, "verdict": self.diff.verdict if self.diff else "",
            "notes": self.notes, "reason": self.reason,
        }  # fmt: skip


def convert(
    robot: str | Path | Robot,
    target: str | os.PathLike[str],
    samples: int = 16,
    seed: int = 0,
    *,
    floating: bool = False,
) -> Conversion:
    """Write a robot in another format, and verify it by the library that reads this format.

    Parameters
    ----------
    robot : str, Path or Robot
        A name, a file (URDF, xacro, MJCF) or a robot.
    target : path
        ``.urdf`` is judged by Pinocchio, ``.xml`` or ``.mjcf`` (MJCF) by MuJoCo.
    samples, seed : int
        Random states.
    floating : bool
        Give the base of a file six degrees of freedom.

    Returns
    -------
    Conversion
        ``.terms`` with the largest difference of each, ``.passed``, ``.notes``.

    Raises
    ------
    ArgumentError
        If the suffix is of no format, or the format cannot hold the robot.
    UrdfError
        If the file cannot be read or written.

    Examples
    --------
    >>> import dualpin as dp, tempfile, pathlib
    >>> done = dp.convert("ur5", pathlib.Path(tempfile.mkdtemp()) / "ur5.xml", samples=4)
    >>> done.passed, max(done.terms.values()) < 1e-12
    (True, True)
    """
    path = Path(target)
    if path.suffix.lower() not in SUBJECTS:
        raise ArgumentError(
            f"convert: {path.name!r}: a name that ends in {', '.join(SUBJECTS)} expected, which says the format"
        )
    name = robot.name if isinstance(robot, Robot) else str(robot)
    if not isinstance(robot, Robot):
        robot = _quietly(robot, floating)
    done = Conversion(name, str(path))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", DualpinWarning)
        robot.to_urdf(path) if path.suffix.lower() == ".urdf" else robot.to_mjcf(path)
    done.notes = [str(w.message) for w in said if issubclass(w.category, DualpinWarning)]
    _judge(done, robot, path, samples, seed)
    return done


def _lost(found: Diff) -> list[str]:
    """What counts, by kind: "limit velocity: of 'joint1', 'joint2', ... (9 in all)"."""
    kinds: dict[str, list[str]] = {}
    for c in found.changes:
        if c.counts:
            kinds.setdefault(f"{c.about}: {c.what}", []).append(repr(c.item))
    more = {k: f", ... ({len(x)} in all)" if len(x) > LISTED else "" for k, x in kinds.items()}
    return [f"{k} differs: {', '.join(x[:LISTED])}{more[k]}" for k, x in kinds.items()]


def _quietly(source: Any, floating: bool, mimic: bool = False) -> Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        return load(source, floating, mimic)


def _judge(done: Conversion, robot: Robot, path: Path, samples: int, seed: int) -> None:
    """Ask the library about the file, and dualpin about the robot."""
    subject, module = SUBJECTS[path.suffix.lower()]
    again = _quietly(path, robot.floating and not is_mjcf(path), robot.coupled)
    done.diff = diff(robot, again, samples, seed)
    done.notes += _lost(done.diff)
    if not robot.nv:
        done.reason = "no joint moves, so there is no term to compare"
        return
    if not find_spec(module):
        done.reason = f"{module} is not installed: pip install 'dualpin[{'mujoco' if is_mjcf(path) else 'validate'}]'"
        return
    asked = robot
    if sorted(columns(robot)[0]) != sorted(columns(again)[0]):
        asked = again
        done.notes.append(
            "joints of the file have other names: the library is compared with what dualpin reads from it"
        )
    mjcf = str(path.resolve()) if is_mjcf(path) else ""
    text = "" if mjcf else path.read_text(encoding="utf-8")
    asking = Asking(done.source, asked, text, random_states(asked, samples, seed), tuple(QUESTIONS), seed, mjcf)
    answers = resolve(subject, python=sys.executable)(asking, lambda what: None)
    result: RobotResult = judged(answers, asking, diagnosing=False)
    done.library, done.reason = f"{answers.name} {answers.version}".strip(), result.reason
    for term, t in result.terms.items():
        if t.status in (AGREES, DIFFERS):
            done.terms[term] = float(t.max_scaled_error)
            if t.status == DIFFERS:
                done.differs.append(term)
