"""Dynamics in JAX: functions of arrays under `jit`, `vmap` and `grad`, by analytic derivatives.

    import dualpin as dp
    import dualpin.jax as dj

    loss = lambda q: dj.rnea(robot, q, v, a) @ w
    jax.jit(jax.vmap(jax.grad(loss)))(q)

Each is a call of the compiled kernel from inside XLA's program; a batch, also one of `vmap`, is one call.  On the
host it is machine code that XLA calls (its foreign function interface, `jax.ffi`), without Python; in programs for
other devices, and where there is no compiler, it is `jax.pure_callback`, which computes the same on the host and
costs 0.15 ms a call.

The precision is that of the arrays, which in JAX means float32 unless ``jax_enable_x64`` is set.  Derivatives are
analytic in reverse and in forward mode (`jax.grad`, `jax.jvp`, `jax.jacfwd`, `jax.linearize`), and can be taken twice,
in any order (`jax.hessian`); the third is refused.  What was compiled for a robot that a program of XLA's names stays
in memory until the process ends.
"""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import Any

import numpy as np

from .autodiff.coordinates import scalar_functions
from .autodiff.functions import NAMES, Functions, absent, leading
from .autodiff.handlers import handler_of
from .autodiff.operation import Library, Operation
from .autodiff.rules import gradients
from .errors import ArgumentError
from .extras import extra
from .locking import LOCK
from .scalars import register


@functools.cache
def _jax() -> Any:
    jax = extra("jax", "jax", "dualpin.jax")
    extra("jax.ffi", "jax", "dualpin.jax")
    return jax


@functools.cache
def _primitive() -> Any:
    """(*arrays of equal leading axes, operation=) -> array; made when JAX is first needed.

    A rule of `autodiff.rules` gives the gradient, which is linear in the cotangent, and thereby all that JAX wants to
    know: its transpose by the cotangent is the derivative along a tangent, and its part by an argument in which the
    term is linear is the transpose of the term.
    """
    jax = _jax()
    from jax.extend.core import Primitive
    from jax.interpreters import ad, batching, mlir

    primitive = Primitive("dualpin")

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

    eager = jax.jit(computed, static_argnums=0)

    def abstract(*arrays: Any, operation: Operation) -> Any:
        batch = arrays[0].shape[: arrays[0].ndim - operation.ranks[0]]
        return jax.core.ShapedArray((*batch, *operation.shape), arrays[0].dtype)

    def along(primals: Any, tangents: Any, *, operation: Operation) -> tuple[Any, Any]:
        output = primitive.bind(*primals, operation=operation)
        needed = [type(x) is not ad.Zero for x in tangents]

        def pulled(cotangent: Any) -> list[Any]:
            found = gradients(operation, _library(), primals, output, cotangent, needed)
            return [x for x, wanted in zip(found, needed, strict=True) if wanted]

        (tangent,) = jax.linear_transpose(pulled, output)([x for x, n in zip(tangents, needed, strict=True) if n])
        return output, tangent

    def transposed(cotangent: Any, *arrays: Any, operation: Operation) -> list[Any]:
        linear = [ad.is_undefined_primal(x) for x in arrays]
        if type(cotangent) is ad.Zero:
            return [ad.Zero(x.aval) if unknown else None for x, unknown in zip(arrays, linear, strict=True)]
        known = [jax.numpy.zeros(x.aval.shape, x.aval.dtype) if ad.is_undefined_primal(x) else x for x in arrays]
        found = gradients(operation, _library(), known, None, cotangent, linear)
        return [x if unknown else None for x, unknown in zip(found, linear, strict=True)]

    def batched(arrays: Any, axes: Any, *, operation: Operation) -> tuple[Any, int]:
        n = next(x.shape[at] for x, at in zip(arrays, axes, strict=True) if at is not None)
        wide = [
            jax.numpy.broadcast_to(x, (n, *x.shape)) if at is None else jax.numpy.moveaxis(x, at, 0)
            for x, at in zip(arrays, axes, strict=True)
        ]
        return primitive.bind(*wide, operation=operation), 0

    primitive.def_impl(lambda *arrays, operation: eager(operation, *arrays))
    primitive.def_abstract_eval(abstract)
    mlir.register_lowering(
        primitive, mlir.lower_fun(lambda *arrays, operation: computed(operation, *arrays), multiple_results=False)
    )
    ad.primitive_jvps[primitive] = along
    ad.primitive_transposes[primitive] = transposed
    batching.primitive_batchers[primitive] = batched
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

    jax = _jax()
    with jax.ensure_compile_time_eval():
        for kind in (type(jnp.zeros(())), jax.core.Tracer):
            register(kind, scalar_functions(jnp))
    return Library(
        _called, jnp.stack, jnp.concatenate, lambda x, like: jnp.asarray(x, dtype=like.dtype), jnp.broadcast_to,
        jnp.cos, jnp.sin, _ready,
    )  # fmt: skip


def _called(operation: Operation, *given: Any) -> Any:
    return _primitive().bind(*_ready(operation, *given), operation=operation)


def _ready(operation: Operation, *given: Any) -> list[Any]:
    _jax()
    import jax.numpy as jnp

    arrays = [jnp.asarray(x) for x in given]
    kind = jnp.result_type(*arrays, jnp.float32)
    if kind not in (jnp.float32, jnp.float64):
        raise ArgumentError(f"{operation.term.name}: arrays of float32 or float64 expected, got {kind}")
    own = leading(operation, [x.shape for x in arrays])
    batch = np.broadcast_shapes(*own)
    return [
        jnp.broadcast_to(x.astype(kind), (*batch, *x.shape[len(axes) :])) for x, axes in zip(arrays, own, strict=True)
    ]


_functions = Functions(_called, _library)
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
