"""The functions that `dualpin.torch` and `dualpin.jax` offer: those of `dualpin`, on arrays of the library.

Each takes the robot first, then arrays whose leading axes broadcast, and gives an array that the
library can differentiate.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..errors import ShapeError, nearest
from ..model.robot import Frame, Robot
from ..terms import TERMS
from .operation import Library, Operation

Call = Callable[..., Any]
"""(operation, arrays) -> array; the leading axes need not be equal."""


class Functions:
    """The differentiable terms, by one library's way of calling an operation, and of entering a function."""

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

    def rnea(self, robot: Robot, q: Any, v: Any, a: Any, f_ext: Any = None) -> Any:
        """Inverse dynamics, (..., nv); see `dualpin.rnea`.  Differentiable twice."""
        return self._term(robot, "rnea", q, v, a, f_ext=f_ext)

    def aba(self, robot: Robot, q: Any, v: Any, tau: Any, f_ext: Any = None) -> Any:
        """Forward dynamics, (..., nv); see `dualpin.aba`.  Differentiable twice."""
        return self._term(robot, "aba", q, v, tau, f_ext=f_ext)

    def bias(self, robot: Robot, q: Any, v: Any) -> Any:
        """C(q, v) v + g(q), (..., nv); see `dualpin.bias`.  Differentiable twice."""
        return self._term(robot, "bias", q, v)

    def gravity(self, robot: Robot, q: Any) -> Any:
        """g(q), (..., nv); see `dualpin.gravity`.  Differentiable twice."""
        return self._term(robot, "gravity", q)

    def crba(self, robot: Robot, q: Any) -> Any:
        """The inertia matrix, (..., nv, nv); see `dualpin.crba`.  Differentiable twice, for nv times the cost."""
        return self._term(robot, "crba", q)

    def coriolis(self, robot: Robot, q: Any, v: Any) -> Any:
        """The Coriolis matrix, (..., nv, nv); see `dualpin.coriolis`.  Differentiable twice, as `crba`."""
        return self._term(robot, "coriolis", q, v)

    def integrate(self, robot: Robot, q: Any, v: Any) -> Any:
        """The configuration after a step along v, (..., nq); see `dualpin.integrate`.  Differentiable at will."""
        return Operation.of(robot, "integrate").by_library(self._library(), q, v)

    def minv(self, robot: Robot, q: Any) -> Any:
        """The inverse of the inertia matrix, (..., nv, nv); see `dualpin.minv`.  Differentiable twice, as `crba`."""
        return self._term(robot, "minv", q)

    def jacobian(self, robot: Robot, q: Any, frame: str | int | Frame, reference: str = "world") -> Any:
        """Of a frame, (..., 6, nv); see `dualpin.jacobian`.  Differentiable twice, for nv times the cost."""
        return self._term(robot, "jacobian", q, frame=frame, reference=reference)

    def fk(self, robot: Robot, q: Any, frame: str | int | Frame | None = None) -> Any:
        """Poses of all joints, (..., njoints, 4, 4), or of a frame; see `dualpin.fk`.  Differentiable twice."""
        if frame is None:
            return self._term(robot, "fk", q)
        return self._term(robot, "frame_pose", q, frame=frame)

    def com(self, robot: Robot, q: Any) -> Any:
        """The centre of mass, (..., 3); see `dualpin.com`.  Differentiable three times."""
        return self._term(robot, "com", q)

    def com_jacobian(self, robot: Robot, q: Any) -> Any:
        """Its Jacobian, (..., 3, nv); see `dualpin.com_jacobian`.  Differentiable twice."""
        return self._term(robot, "com_jacobian", q)

    def rnea_jvp(self, robot: Robot, q: Any, v: Any, a: Any, dq: Any, dv: Any, da: Any, f_ext: Any = None) -> Any:
        """d rnea along a direction, (..., nv); see `dualpin.rnea_jvp`.  Differentiable once."""
        return self._term(robot, "rnea_jvp", q, v, a, dq, dv, da, f_ext=f_ext)

    def kinetic_energy(self, robot: Robot, q: Any, v: Any) -> Any:
        """v . M v / 2, (...); see `dualpin.kinetic_energy`.  Differentiable twice."""
        return self._term(robot, "kinetic_energy", q, v)

    def potential_energy(self, robot: Robot, q: Any) -> Any:
        """U(q), (...); see `dualpin.potential_energy`.  Differentiable three times."""
        return self._term(robot, "potential_energy", q)


def absent(module: str, name: str) -> AttributeError:
    """What to say of a name that the module does not have."""
    hint = {
        "centroidal_momentum_matrix": "; the momentum is robot.mass times the velocity of com",
    }.get(name, "")
    why = "has no derivative here" if name in TERMS else "is not known"
    return AttributeError(f"{module}.{name} {why}{hint}; {nearest(name, NAMES, 'functions', most=99)}", name=name)


NAMES = tuple(name for name in vars(Functions) if not name.startswith("_"))


def leading(operation: Operation, shapes: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """The leading axes of each array, after a check that there are as many axes as a sample has."""
    found = []
    for x, rank, shape in zip(operation.term.arguments, operation.ranks, shapes, strict=True):
        wanted = x.shape(operation.robot)
        if shape[len(shape) - rank :] != wanted or len(shape) < rank:
            axes = ", ".join(map(str, wanted))
            raise ShapeError(
                f"{operation.term.name}: {x.name} of shape (..., {axes}) expected for {operation.robot.name} "
                f"({x.meaning(operation.robot)}), got {tuple(shape)}"
            )
        found.append(tuple(shape[: len(shape) - rank]))
    return found
