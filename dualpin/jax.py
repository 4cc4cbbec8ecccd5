"""Dynamics in JAX: functions of arrays under `jit`, `vmap` and `grad`, by analytic derivatives.

    import dualpin as dp
    import dualpin.jax as dj

    loss = lambda q: dj.rnea(robot, q, v, a) @ w
    jax.jit(jax.vmap(jax.grad(loss)))(q)

Each is a call of the compiled kernel from inside XLA's program (`jax.pure_callback`, on the host) with
a `custom_vjp`; a batch, also one of `vmap`, is one call.  The precision is that of the arrays, which in
JAX means float32 unless ``jax_enable_x64`` is set.  Gradients can be differentiated again in reverse
(`jax.grad` of `jax.grad`, `jax.jacrev`); forward mode (`jax.jvp`, `jax.jacfwd`) is refused by JAX for
such functions, and for `rnea` there is `dualpin.rnea_jvp`.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from .autodiff.functions import NAMES, Functions, leading
from .autodiff.operation import Library, Operation
from .autodiff.rules import gradients
from .errors import ArgumentError
from .extras import extra


@functools.cache
def _jax() -> Any:
    return extra("jax", "jax", "dualpin.jax")


@functools.cache
def _primitive() -> Any:
    """(operation, *arrays of equal leading axes) -> array; made when JAX is first needed."""
    jax = _jax()

    def computed(operation: Operation, *arrays: Any) -> Any:
        batch = np.broadcast_shapes(*leading(operation, [x.shape for x in arrays]))
        result = jax.ShapeDtypeStruct((*batch, *operation.shape), arrays[0].dtype)

        def host(*given: Any) -> np.ndarray:
            return np.asarray(operation.compute(*(np.asarray(x) for x in given)))

        return jax.pure_callback(host, result, *arrays, vmap_method="expand_dims")

    def forward(operation: Operation, *arrays: Any) -> tuple[Any, Any]:
        output = primitive(operation, *arrays)
        return output, (arrays, output)

    def backward(operation: Operation, kept: Any, cotangent: Any) -> tuple[Any, ...]:
        arrays, output = kept
        found = gradients(operation, _library(), arrays, output, cotangent, [True] * len(arrays))
        return tuple(found)

    primitive = jax.custom_vjp(computed, nondiff_argnums=(0,))
    primitive.defvjp(forward, backward)
    return primitive


@functools.cache
def _library() -> Library:
    import jax.numpy as jnp

    return Library(
        _called, jnp.stack, jnp.concatenate, lambda x, like: jnp.asarray(x, dtype=like.dtype), jnp.broadcast_to,
        jnp.cos, jnp.sin,
    )  # fmt: skip


def _called(operation: Operation, *given: Any) -> Any:
    _jax()
    import jax.numpy as jnp

    arrays = [jnp.asarray(x) for x in given]
    kind = jnp.result_type(*arrays, jnp.float32)
    if kind not in (jnp.float32, jnp.float64):
        raise ArgumentError(f"{operation.term.name}: arrays of float32 or float64 expected, got {kind}")
    own = leading(operation, [x.shape for x in arrays])
    batch = np.broadcast_shapes(*own)
    ready = [
        jnp.broadcast_to(x.astype(kind), (*batch, *x.shape[len(axes) :])) for x, axes in zip(arrays, own, strict=True)
    ]
    return _primitive()(operation, *ready)


_functions = Functions(_called)
rnea, aba, bias, gravity, crba = (
    _functions.rnea, _functions.aba, _functions.bias, _functions.gravity, _functions.crba,
)  # fmt: skip
fk, com = _functions.fk, _functions.com
kinetic_energy, potential_energy = _functions.kinetic_energy, _functions.potential_energy

__all__ = list(NAMES)
