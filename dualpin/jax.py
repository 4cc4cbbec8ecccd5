"""Dynamics in JAX: functions of arrays under `jit`, `vmap` and `grad`, by analytic derivatives.

    import dualpin as dp
    import dualpin.jax as dj

    loss = lambda q: dj.rnea(robot, q, v, a) @ w
    jax.jit(jax.vmap(jax.grad(loss)))(q)

Each is a call of the compiled kernel from inside XLA's program, with a `custom_vjp`; a batch, also one of
`vmap`, is one call.  On the host it is machine code that XLA calls (its foreign function interface, `jax.ffi`),
without Python; in programs for other devices, and where there is no compiler, it is `jax.pure_callback`, which
computes the same on the host and costs 0.15 ms a call.

The precision is that of the arrays, which in JAX means float32 unless ``jax_enable_x64`` is set.  Gradients can be
differentiated again in reverse (`jax.grad` of `jax.grad`, `jax.jacrev`); forward mode (`jax.jvp`, `jax.jacfwd`) is
refused by JAX for such functions, and for `rnea` there is `rnea_jvp`.  What was compiled for a robot that a program
of XLA's names stays in memory until the process ends.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import Any

import numpy as np

from .autodiff.functions import NAMES, Functions, absent, leading
from .autodiff.handlers import handler_of
from .autodiff.operation import Library, Operation
from .autodiff.rules import gradients
from .errors import ArgumentError
from .extras import extra
from .locking import LOCK


@functools.cache
def _jax() -> Any:
    jax = extra("jax", "jax", "dualpin.jax")
    extra("jax.ffi", "jax", "dualpin.jax")
    return jax


@functools.cache
def _primitive() -> Any:
    """(operation, *arrays of equal leading axes) -> array; made when JAX is first needed."""
    jax = _jax()

    def computed(operation: Operation, *arrays: Any) -> Any:
        batch = np.broadcast_shapes(*leading(operation, [x.shape for x in arrays]))
        result = jax.ShapeDtypeStruct((*batch, *operation.shape), arrays[0].dtype)

        def host(*given: Any) -> np.ndarray:
            return np.asarray(operation.compute(*(np.asarray(x) for x in given)))

        def called_back(*given: Any) -> Any:
            return jax.pure_callback(host, result, *given, vmap_method="expand_dims")

        name = _target(operation, arrays[0].dtype)
        if name is None:
            return called_back(*arrays)
        direct = jax.ffi.ffi_call(name, result, vmap_method="broadcast_all")
        return jax.lax.platform_dependent(*arrays, cpu=direct, default=called_back)

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


def _target(operation: Operation, dtype: Any) -> str | None:
    """The name under which XLA's programs for the host find the operation; None where they cannot."""
    minor = _interface()
    found = None if minor is None else handler_of(operation, np.dtype(dtype), minor)
    if found is None:
        return None
    name, address = found
    with LOCK:
        if name not in _registered:
            ffi = _jax().ffi
            ffi.register_ffi_target(name, ffi.pycapsule(address), platform="cpu")
            _registered.add(name)
    return name


_registered: set[str] = set()


@functools.cache
def _interface() -> int | None:
    """The minor version of XLA's interface in C, as its header says; None if it is another major one."""
    try:
        text = (Path(_jax().ffi.include_dir()) / "xla/ffi/api/c_api.h").read_text(encoding="utf-8")
    except (OSError, AttributeError):
        return None
    major, minor = (re.search(rf"#define XLA_FFI_API_{x} (\d+)", text) for x in ("MAJOR", "MINOR"))
    return int(minor[1]) if major and minor and int(major[1]) == 0 else None


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
rnea, aba, bias, gravity, rnea_jvp = (
    _functions.rnea, _functions.aba, _functions.bias, _functions.gravity, _functions.rnea_jvp,
)  # fmt: skip
crba, minv, fk, jacobian = _functions.crba, _functions.minv, _functions.fk, _functions.jacobian
coriolis = _functions.coriolis
com, com_jacobian = _functions.com, _functions.com_jacobian
kinetic_energy, potential_energy = _functions.kinetic_energy, _functions.potential_energy

__all__ = list(NAMES)


def __getattr__(name: str) -> Any:
    raise absent(__name__, name)
