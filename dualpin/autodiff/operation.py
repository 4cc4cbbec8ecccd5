"""A term as a differentiable operation: its value and its gradient."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..call.arguments import check_robot
from ..call.making import function_of
from ..errors import ArgumentError
from ..model.memory import memory
from ..model.robot import Robot
from ..terms import Options, Shape, Term, flat
from ..terms import term as term_named


@dataclass(frozen=True)
class Library:
    """The interface to a library of arrays that rules need.

    Attributes
    ----------
    apply : callable
        (operation, *arrays) -> array, differentiable by the operation's own gradient.
    stack, concatenate : callable
        Of a list of arrays along an axis.
    constant : callable
        A NumPy array and an array of the library -> the former, as an array like the latter.
    ready : callable
        (operation, *arrays) -> the arrays, checked, of one type, with equal leading axes.
    """

    apply: Callable[..., Any]
    stack: Callable[[Sequence[Any], int], Any]
    concatenate: Callable[[Sequence[Any], int], Any]
    constant: Callable[[np.ndarray, Any], Any]
    broadcast: Callable[[Any, Shape], Any]
    cos: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    ready: Callable[..., Sequence[Any]]


@dataclass(frozen=True)
class Operation:
    """One term of one robot on arrays whose leading axes are equal.

    Attributes
    ----------
    options : tuple
        The settled options, in the order of the term's.
    """

    robot: Robot
    term: Term
    options: tuple[Hashable, ...] = ()

    @classmethod
    def of(cls, robot: Robot, name: str, **options: Any) -> Operation:
        """The operation of that name, with checked options; cached for the robot."""
        check_robot(robot, name)
        kept, key, term = memory(robot), ("operation", name, *options.items()), term_named(name)
        settled = kept.get(key)
        if settled is None:
            settled = kept.setdefault(key, tuple(term.settled(robot, options).values()))
        return cls(robot, term, settled)

    @property
    def settled(self) -> Options:
        return {x.name: value for x, value in zip(self.term.options, self.options, strict=True)}

    @property
    def shape(self) -> Shape:
        """Of one result."""
        return self.term.shape(self.robot, **self.settled)

    @property
    def ranks(self) -> list[int]:
        """The number of axes of one sample of each array."""
        return [len(x.shape(self.robot)) for x in self.term.arguments]

    def by_library(self, library: Library, *given: Any) -> Any:
        """The source itself on arrays of the library, which differentiates it; for terms of few operations."""
        arrays = library.ready(self, *given)
        batch = arrays[0].shape[:-1]
        columns = [[x[..., i] for i in range(x.shape[-1])] for x in arrays]
        entries = flat(self.term.compute(self.robot, *columns, **self.settled))
        return library.stack([library.broadcast(x, batch) for x in entries], -1)

    def compute(self, *arrays: np.ndarray) -> np.ndarray:
        """The result, in the arrays' type."""
        kinds = {x.dtype for x in arrays}
        if len(kinds) > 1 or not kinds <= {np.dtype(np.float32), np.dtype(np.float64)}:
            names = ", ".join(f"{x.name} {y.dtype}" for x, y in zip(self.term.arguments, arrays, strict=True))
            raise ArgumentError(f"{self.term.name}: arrays of one type expected, float32 or float64; got {names}")
        return function_of(self.robot, self.term, self.settled, kinds.pop())(*arrays)
