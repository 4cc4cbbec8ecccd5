"""The data of a comparison: a robot, and how one of its terms is compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ..algorithms.kinematics import References
from ..model.robot import Robot
from ..terms import TERMS
from .definitions import Definitions
from .extent import ORDINARY, Extent
from .sampling import frames
from .tolerance import Reference, Tolerance, recursion

Array = np.ndarray
Definition = Callable[..., Any]

INERTIA, GRAVITY = "inertia", "gravity"
FORCES = frozenset({INERTIA, GRAVITY})


@dataclass(frozen=True, eq=False)
class Check:
    """A term to compare.

    Attributes
    ----------
    definition : callable
        (definitions, *indices along `parts`, **options) -> the term, or that part of it, in 50 digits.
    adds : callable, optional
        extent -> how large the numbers are that add up in it (n,), from which its tolerance follows; see `extent`.
    bounds : callable, optional
        (reference, its values) -> the tolerance, where it follows from more than that.
    parts : tuple of int
        If it is not found as a whole: the axes whose indices say which part is found at once.
    solves : bool
        Whether a linear system with M is solved in it.
    enters : set of str
        What enters it besides motion: INERTIA, GRAVITY.
    form : str
        What kind of quantity it is: how `subjects.Layout` rewrites it in other coordinates.
    """

    term: str
    definition: Definition
    adds: Callable[[Extent], Any] | None = None
    bounds: Callable[[Reference, Array], Tolerance] | None = None
    parts: tuple[int, ...] = ()
    solves: bool = False
    enters: Set[str] = FORCES
    form: str = "plain"

    # --- inputs and options ---------------------------------------------------------------------------

    @property
    def inputs(self) -> dict[str, str]:
        """The term's inputs, each with the sampled quantity that it is given."""
        return {key: "q" if key == "q0" else key for key in TERMS[self.term].inputs}

    def variants(self, robot: Robot, seed: int) -> list[dict[str, Any]]:
        """The options it is compared with: all combinations, of frames a few; others have their defaults."""
        values = {"frame": frames(robot, seed), "reference": References, "classical": (False, True)}
        names = [option.name for option in TERMS[self.term].options if option.name in values]
        return [dict(zip(names, chosen, strict=True)) for chosen in product(*(values[name] for name in names))]

    @property
    def weighs(self) -> bool:
        """Whether it is nothing but zeros (or 0 / 0) on a robot without mass."""
        return INERTIA in self.enters and "f_ext" not in self.inputs

    # --- how far apart two answers may be -----------------------------------------------------------

    def size(self, extent: Extent) -> Array:
        """How large what adds up in it is, shape (n,), as a multiple of what is ordinary."""
        assert self.adds is not None, self.term
        return np.broadcast_to(self.adds(extent) / ORDINARY, extent.reach.shape)

    def bound(self, reference: Reference, values: Array) -> Tolerance:
        """How far from the reference's values another answer may be, sample by sample."""
        if self.bounds is not None:
            return self.bounds(reference, values)
        return recursion(reference.robot, len(values), self.size(reference.extent), values)

    # --- what it is ---------------------------------------------------------------------------------

    def entry(self, of: Definitions, index: tuple[int, ...], options: Mapping[str, Any]) -> Any:
        """One entry, by the definition."""
        rest = tuple(i for axis, i in enumerate(index) if axis not in self.parts)
        found = self.definition(of, *(index[axis] for axis in self.parts), **of.lifted(options))
        return np.asarray(found, object)[rest]

    def whole(self, of: Definitions, shape: tuple[int, ...], options: Mapping[str, Any]) -> Array:
        """All entries, by the definition."""
        out, options = np.empty(shape, object), of.lifted(options)
        for chosen in np.ndindex(*(shape[axis] for axis in self.parts)):
            at = dict(zip(self.parts, chosen, strict=True))
            place = tuple(at.get(axis, slice(None)) for axis in range(len(shape)))
            out[place] = self.definition(of, *chosen, **options)
        return out


def compared(**how: Any) -> Callable[[Definition], Check]:
    """The check of the term that the function defines; `how` says the rest of it, see `Check`."""
    return lambda definition: Check(definition.__name__, definition, **how)


@dataclass(frozen=True)
class Case:
    """A robot to validate: by name or path, or itself.

    Attributes
    ----------
    against : str, optional
        A file to compare with instead of its own.
    engine : str
        What computes it, where that is not what the whole campaign is computed with.
    title : str
        What to call it, where that is not the name or path.
    oracle : str
        The library it is compared with.
    """

    robot: str | Robot
    floating: bool = False
    mimic: bool = False
    against: str | None = None
    engine: str = ""
    title: str = ""
    oracle: str = "pinocchio"

    @property
    def name(self) -> str:
        if self.title:
            return self.title
        return self.robot.name if isinstance(self.robot, Robot) else str(self.robot)
