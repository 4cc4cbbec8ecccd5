"""How the functions of `dualpin.torch` and `dualpin.jax` call an operation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..model.robot import Robot
from .operation import Library, Operation

Call = Callable[..., Any]
"""(operation, arrays) -> array; the leading axes need not be equal."""


class Caller:
    """One library's way of calling an operation, and of entering a function."""

    def __init__(
        self, call: Call, library: Callable[[], Library],
        enter: Callable[[Callable[..., Any]], Callable[..., Any]] = lambda f: f,
    ) -> None:  # fmt: skip
        self._call, self._library, self._enter = call, library, enter

    def _term(self, robot: Robot, name: str, *arrays: Any, f_ext: Any = None, **options: Any) -> Any:
        if f_ext is not None:
            name, arrays = f"{name}_f_ext", (*arrays, f_ext)
        return self._enter(self._of)(robot, name, arrays, options)

    def _of(self, robot: Robot, name: str, arrays: tuple[Any, ...], options: dict[str, Any]) -> Any:
        return self._call(Operation.of(robot, name, **options), *arrays)
