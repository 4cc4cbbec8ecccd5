"""Which model a robot is compared with: the file it came from, the URDF it writes, or the same joints again."""

from __future__ import annotations

import tempfile
import warnings
from dataclasses import dataclass, field
from pathlib import Path

from ..arguments import choice
from ..errors import DualpinError, DualpinWarning
from ..io.catalogue import find
from ..io.mjcf import is_mjcf
from ..io.urdf import load
from ..model.robot import Robot
from .checks import Case
from .oracles import ORACLES, Oracle, OracleError
from .reading import Difference, describe, differences

ASSEMBLED = "compared with a {} model of the same joints, bodies, rotors and gravity, not with a file"


@dataclass
class Pair:
    """A robot and its oracle.

    Attributes
    ----------
    notes : list of str
        What the oracle's model was made of, where that is not the robot's own file.
    apart : list of Difference
        What the two do not share, found before any term is compared.
    oracle : Oracle or None
        None where joints are not the same, so that no term can be compared.
    """

    robot: Robot
    oracle: Oracle | None
    floating: bool
    notes: list[str] = field(default_factory=list)
    apart: list[Difference] = field(default_factory=list)


def paired(case: Case) -> Pair:
    """The robot of a case, with the oracle that fits.

    - A robot as it was read from a file: the oracle reads the same file; where it refuses that, the
      URDF that dualpin writes of it; where it refuses this too, as the next.
    - A robot that was changed since, or built in code: a model of the oracle's put together from
      the robot's own joints, bodies, rotors and gravity.
    - `against` a file, whatever the robot is: the oracle's reading of that file.

    Raises
    ------
    UrdfError
        If dualpin does not read the robot.
    OracleError
        If there is no model to compare with.
    """
    library = ORACLES[choice("validate: oracle", case.oracle, tuple(ORACLES))]
    robot = case.robot if isinstance(case.robot, Robot) else quietly_loaded(case.robot, case.floating, case.mimic)
    floating = robot.floating
    if case.against is not None:
        path = str(find(str(case.against)))
        whose, theirs = Path(path).name, library.described(path, floating)
        if [body.joint for body in theirs.bodies] != robot.joint_names:
            return Pair(robot, None, floating, apart=differences(robot, theirs, whose))
        return _checked(Pair(robot, library.of_file(robot, path, floating), floating), whose)
    of_model = robot.source is not None and is_mjcf(Path(robot.source))  # readers of MJCF have rules of their own
    if of_model or (isinstance(case.robot, Robot) and not unchanged(robot, floating)):
        return _checked(
            Pair(robot, library.of_robot(robot), floating, [ASSEMBLED.format(library.name)]), f"{library.name}'s model"
        )
    try:
        oracle, notes = library.of_file(robot, str(robot.source), floating), []
    except OracleError as refusal:
        oracle, made = _of_written(library, robot, floating, refusal)
        notes = [f"{refusal}; {made}"]
    if oracle.refusal:
        notes.append(f"mimic: {oracle.refusal}; projected from the uncoupled model")
    return _checked(Pair(robot, oracle, floating, notes), f"{library.name}'s reading")


def _checked(pair: Pair, whose: str) -> Pair:
    if pair.oracle:
        pair.apart = differences(pair.robot, pair.oracle.description, whose)
    return pair


def _of_written(library: type[Oracle], robot: Robot, floating: bool, refusal: OracleError) -> tuple[Oracle, str]:
    """The library's reading of what dualpin writes, else the same joints; or its refusal of the file itself."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        path = str(Path(folder) / "written.urdf")
        try:
            robot.to_urdf(path)
            return library.of_file(robot, path, floating), "compared with the URDF that dualpin writes"
        except DualpinError:
            pass
    try:
        return library.of_robot(robot), ASSEMBLED.format(library.name)
    except OracleError:
        raise refusal from None


def quietly_loaded(name: str, floating: bool, mimic: bool) -> Robot:
    """Loaded without warnings: its notes are in the result."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DualpinWarning)
        return load(name, floating, mimic)


def unchanged(robot: Robot, floating: bool) -> bool:
    """Whether it is what its file holds."""
    if robot.source is None:
        return False
    try:
        again = quietly_loaded(robot.source, floating, robot.coupled)
    except DualpinError:
        return False
    same = [f.name for f in again.frames] == [f.name for f in robot.frames]
    return same and not differences(robot, describe(again), "the file")
