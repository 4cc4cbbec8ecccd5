"""Dynamics in PyTorch: differentiable functions of tensors, with analytic derivatives.

    import dualpin as dp
    import dualpin.torch as dt

    tau = dt.rnea(robot, q, v, a)      # tensors (..., nq), (..., nv), (..., nv)
    tau.square().mean().backward()

Tensors of the host, float32 or float64; none is copied on the way in or out (DLPack), if it is
contiguous.  Gradients are products with the analytic derivatives in O(n), and can be differentiated
again: `create_graph=True`, `torch.autograd.functional.hessian`, `gradgradcheck`.  Higher derivatives that are not
implemented raise an error.  `torch.func.grad`, `vjp`, `vmap` work too; `torch.compile` compiles what is
around these functions.

Quaternions in configurations must be unit quaternions; the gradient by a quaternion has no component along it.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .autodiff.coordinates import scalar_functions
from .autodiff.functions import NAMES, Functions, absent, leading
from .autodiff.operation import Library, Operation
from .autodiff.rules import gradients
from .errors import ArgumentError
from .extras import extra
from .scalars import register

if TYPE_CHECKING:
    from torch import Tensor


@functools.cache
def _torch() -> Any:
    return extra("torch", "torch", "dualpin.torch")


@functools.cache
def _function() -> Any:
    """The class whose `apply` is an operation; made when PyTorch is first needed."""
    torch = _torch()
    Function: Any = torch.autograd.Function

    class Term(Function):
        @staticmethod
        def forward(operation: Operation, *tensors: Tensor) -> Tensor:
            arrays = [np.from_dlpack(x.detach()) for x in tensors]
            result = operation.compute(*arrays)
            return torch.from_dlpack(result if result.ndim else result.reshape(1)).reshape(result.shape)

        @staticmethod
        def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
            ctx.operation, *tensors = inputs
            ctx.save_for_backward(*tensors, output)

        @staticmethod
        def backward(ctx: Any, cotangent: Tensor) -> tuple[Tensor | None, ...]:
            *inputs, output = ctx.saved_tensors
            needed = ctx.needs_input_grad[1:]
            return None, *gradients(ctx.operation, _library(), inputs, output, cotangent.contiguous(), needed)

        @staticmethod
        def vmap(info: Any, in_dims: tuple[Any, ...], operation: Operation, *tensors: Tensor) -> Any:
            moved = [
                x.movedim(at, 0) if at is not None else x.unsqueeze(0)
                for x, at in zip(tensors, in_dims[1:], strict=True)
            ]
            ranks = operation.ranks
            most = max(x.ndim - rank for x, rank in zip(moved, ranks, strict=True))
            padded = [
                x.reshape(x.shape[0], *[1] * (most - x.ndim + rank), *x.shape[1:])
                for x, rank in zip(moved, ranks, strict=True)
            ]
            return _called(operation, *padded), 0

    return Term


@functools.cache
def _library() -> Library:
    torch = _torch()
    register(torch.Tensor, scalar_functions(torch))
    return Library(
        _called, torch.stack, torch.cat, lambda x, like: torch.as_tensor(x, dtype=like.dtype), torch.broadcast_to,
        torch.cos, torch.sin, _ready,
    )  # fmt: skip


def _called(operation: Operation, *given: Any) -> Tensor:
    return _function().apply(operation, *_ready(operation, *given))


def _ready(operation: Operation, *given: Any) -> list[Tensor]:
    torch = _torch()
    tensors = [_tensor(operation, x.name, y) for x, y in zip(operation.term.arguments, given, strict=True)]
    kind = functools.reduce(torch.promote_types, (x.dtype for x in tensors))
    own = leading(operation, [tuple(x.shape) for x in tensors])
    batch = torch.broadcast_shapes(*own)
    ready = []
    for x, axes in zip(tensors, own, strict=True):
        wide = x if axes == batch else x.expand(*batch, *x.shape[len(axes) :])
        ready.append(wide.to(kind).contiguous())
    return ready


def _tensor(operation: Operation, name: str, x: Any) -> Tensor:
    torch = _torch()
    if not isinstance(x, torch.Tensor):
        raise ArgumentError(f"{operation.term.name}: {name} must be a tensor, got {type(x).__name__}")
    if x.device.type != "cpu":
        raise ArgumentError(
            f"{operation.term.name}: {name} is on {x.device}; dualpin.torch computes on the host. Without gradients, "
            f'robot.kernel("{operation.term.name}", device="{x.device}") takes it where it is'
        )
    if x.dtype not in (torch.float32, torch.float64):
        raise ArgumentError(f"{operation.term.name}: {name} of float32 or float64 expected, got {x.dtype}")
    return x


def _eager(f: Callable[..., Any]) -> Callable[..., Any]:
    """What `torch.compile` does not look into: it breaks its graph there."""
    try:
        import torch
    except ImportError:
        _torch()  # which says what to install
        raise
    return torch.compiler.disable(f)


_functions = Functions(_called, _library, _eager)
rnea, aba, bias, gravity, rnea_jvp = (
    _functions.rnea, _functions.aba, _functions.bias, _functions.gravity, _functions.rnea_jvp,
)  # fmt: skip
crba, minv, fk, jacobian = _functions.crba, _functions.minv, _functions.fk, _functions.jacobian
coriolis, integrate = _functions.coriolis, _functions.integrate
com, com_jacobian = _functions.com, _functions.com_jacobian
kinetic_energy, potential_energy = _functions.kinetic_energy, _functions.potential_energy

__all__ = list(NAMES)


def __getattr__(name: str) -> Any:
    raise absent(__name__, name)
