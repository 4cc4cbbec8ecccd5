"""Interface of an oracle: a library that computes a robot's terms, in dualpin's conventions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence, Set
from typing import Any, ClassVar

import numpy as np

from ...errors import DualpinError
from ...model.robot import Robot
from ..reading import Description, describe


class OracleError(DualpinError):
    """The oracle is missing, or refuses the robot."""


class Oracle(ABC):
    """The terms of one robot, computed by another library.

    Attributes
    ----------
    name : str
        As reports call it.
    terms : set of str
        What it answers; "fk" and "crba" at least, from which tolerances are derived.
    robot : Robot
        Whose terms they are.
    description : Description
        The robot as the library reads it, which is compared before any term.
    refusal : str
        Why it computes a coupled robot's terms from the uncoupled one, if it does.
    """

    name: ClassVar[str]
    terms: ClassVar[Set[str]]
    robot: Robot
    description: Description
    refusal: str = ""

    @classmethod
    @abstractmethod
    def version(cls) -> str:
        """Of the library; an `OracleError` where it is not installed."""

    @classmethod
    @abstractmethod
    def of_file(cls, robot: Robot, path: str, floating: bool) -> Oracle:
        """As the library itself reads the file of a robot."""

    @classmethod
    def of_robot(cls, robot: Robot) -> Oracle:
        """Put together from the robot's own joints, bodies and gravity."""
        raise OracleError(f"{cls.name} reads files only; {robot.name} was changed or built in code")

    @classmethod
    def described(cls, path: str, floating: bool) -> Description:
        """The robot of a file, whatever its joints; by default, as dualpin reads it."""
        from ...io.urdf import load

        return describe(load(path, floating))

    @abstractmethod
    def compute(
        self, term: str, states: dict[str, np.ndarray], variants: Sequence[dict[str, Any]] = ({},)
    ) -> list[np.ndarray]:
        """A term on states (n, size), once for each variant, in dualpin's conventions: arrays (n, ...)."""

    def offers(self, options: Mapping[str, Any]) -> bool:
        """Whether it has what the options of a variant name, such as a frame."""
        return True

    def source(self, term: str) -> str:
        """How the answers to a term were obtained, for reports."""
        return self.name
