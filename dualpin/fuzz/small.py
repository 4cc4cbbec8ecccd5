"""A minimised robot with a difference, and both errors: by the definition, and enclosed by ball arithmetic."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from ..crosscheck.checks import CHECKS, Case
from ..crosscheck.compare import compare
from ..crosscheck.enclosure import enclosure, error
from ..crosscheck.results import DIFFERS, ORACLE, TermResult
from ..crosscheck.sampling import states
from ..errors import DualpinError, DualpinWarning
from ..model.robot import Robot
from .examine import SAMPLES, examine
from .identities import IDENTITIES, identities
from .shrink import shrink
from .spec import Spec

ERROR = "error: "
"""What the name of an exception stands after, where it is shown like a term."""


@dataclass
class SmallCase:
    """A minimal robot that shows a difference.

    Attributes
    ----------
    spec : Spec
        The robot.
    term, nearer : str
        What differs, and whose value is nearer.
    error, tolerance : float
        The scaled difference of the two, and what was allowed.
    against_50_digits : dict
        The scaled errors of "dualpin" and "oracle" by the term's definition; empty where it is not decided.
    enclosed : dict
        Least and largest error of both, proved by ball arithmetic; empty without python-flint.
    urdf : str
        The robot as a URDF; empty where that cannot hold it.
    """

    spec: Spec
    term: str
    nearer: str
    error: float
    tolerance: float
    against_50_digits: dict[str, float]
    enclosed: dict[str, tuple[float, float]]
    urdf: str


def small_case(spec: Spec, term: str, nearer: str) -> SmallCase:
    """Shrink a robot as long as the term differs and the same side is nearer."""

    def shows(s: Spec) -> bool:
        found = _found(s, term)
        return found is not None and found.status == DIFFERS and found.nearer == nearer

    least = shrink(spec, shows)
    found = _found(least, term)
    assert found is not None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        robot = least.robot()
        try:
            urdf = robot.to_urdf()
        except DualpinError:
            urdf = ""
    return SmallCase(
        least, term, nearer, found.max_scaled_error, found.tolerance, dict(found.worst.get("against_50_digits", {})),
        _enclosed(robot, term, found), urdf,
    )  # fmt: skip


def _found(spec: Spec, term: str) -> TermResult | None:
    """The result of one term or identity; None where there is no such robot."""
    if term.startswith(ERROR):
        error = examine(spec).error
        raised = error.partition(":")[0] == term.removeprefix(ERROR)
        return TermResult(status=DIFFERS, nearer=ORACLE, reason=error) if raised else None
    try:
        robot = spec.robot()
        if term in IDENTITIES:
            return identities(robot, 0, [term])[term]
        return compare(Case(robot), SAMPLES, 0, [CHECKS[term]], "numpy").terms[term]
    except DualpinError:
        return None


def _enclosed(robot: Robot, term: str, found: TermResult) -> dict[str, tuple[float, float]]:
    """Both errors at the worst entry of the worst sample; they are not scaled."""
    if find_spec("flint") is None or term not in CHECKS or "entry" not in found.worst:
        return {}
    check, worst = CHECKS[term], found.worst
    given: dict[str, np.ndarray] = states(robot, SAMPLES, 0)
    state = {key: given[name][worst["sample"]] for key, name in check.inputs.items()}
    options: dict[str, Any] = check.variants(robot, 0)[worst["variant"]]
    try:
        ball = enclosure(robot, term, state, **options)[worst["entry"]]
    except (DualpinError, ZeroDivisionError, TypeError, AttributeError):
        return {}  # a comparison that balls do not decide, or a function they lack
    return {who: error(ball, worst[who]) for who in ("dualpin", "oracle")}
