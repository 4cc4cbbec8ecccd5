"""The function that a program of XLA calls where a term stands: its typed FFI, version 0 of the interface in C.

    handler    (XLA_FFI_CallFrame *) -> XLA_FFI_Error *, null if all went well

It finds the arrays in the call frame and calls the kernel: no Python, no lock.  What is not plain goes to a
function of Python's: a kernel that is not compiled yet, a batch worth several threads, a quaternion that is not a
unit.  The structures are those of xla/ffi/api/c_api.h, which grow at their ends; fields of 4 bytes that are followed
by 4 of padding are read as 8 where nothing depends on the upper half.
"""

from __future__ import annotations

from collections.abc import Mapping

from .c_like import Record, Value, Writer
from .fast_call import API, not_units, working

FRAME = {
    "size": "i64", "extension": "ptr", "api": "ptr", "context": "ptr", "stage": "i64",
    "args_size": "i64", "args_extension": "ptr", "args_count": "i64", "args_types": "ptr", "args": "ptr",
    "rets_size": "i64", "rets_extension": "ptr", "rets_count": "i64", "rets_types": "ptr", "rets": "ptr",
}  # fmt: skip
"""XLA_FFI_CallFrame, with its XLA_FFI_Args and XLA_FFI_Rets."""
BUFFER = {"size": "i64", "extension": "ptr", "dtype": "i64", "data": "ptr", "rank": "i64", "dims": "ptr"}
API_TABLE = {
    "size": "i64", "extension": "ptr", "version_size": "i64", "version_extension": "ptr", "version": "i64",
    "internal": "ptr", "error": "ptr",
}  # fmt: skip
"""The beginning of XLA_FFI_Api: its version, and XLA_FFI_Error_Create."""
METADATA, INVALID = 1, 3  # XLA_FFI_Extension_Metadata, XLA_FFI_Error_Code_INVALID_ARGUMENT
_GIVEN = ("PyMem_RawMalloc", "PyMem_RawFree")


def text(spec: Mapping[str, str], stack: int) -> str:
    """The module, given the fields of `jit.xla.Spec` and the bytes of scratch the stack may hold."""
    declarations = "".join(f"declare {API[name].replace(' (', f' @{name}(', 1)}\n" for name in _GIVEN)
    return declarations + "@spec = external global i8\n" + _handler(spec, stack) + _general(spec)


def _handler(fields: Mapping[str, str], stack: int) -> str:
    c = Writer("ptr @handler() nounwind", place="ptr")
    (place,) = c.parameters
    frame, spec = Record(place, FRAME), Record(Value(c, "@spec", "ptr"), fields)
    extension, api = frame.extension, frame.api
    with c.if_(extension != c.null), c.if_(extension.item("i32", 2) == METADATA):
        _about(c, extension.item("ptr", 3), spec.minor)
        c.returns(c.null)

    # where the arrays are, and how many samples: the axes before those of one
    inputs, args = spec.inputs, frame.args
    pointers, count = c.room("ptr", inputs + 1), c.room("i64")
    with c.for_(inputs) as k:
        c.store(Record(args.item("ptr", k), BUFFER).data, pointers.at("ptr", k))
    c.store(Record(frame.rets.item("ptr"), BUFFER).data, pointers.at("ptr", inputs))
    first = Record(args.item("ptr"), BUFFER)
    dims = first.dims
    c.store(c.number(1), count)
    with c.for_(first.rank - spec.axes) as k:
        c.store(count.item("i64") * dims.item("i64", k), count)
    n = count.item("i64")
    with c.if_(n <= 0):
        c.returns(c.null)

    def general() -> None:
        c.returns(c.call("general", n, pointers, api, gives="ptr"))

    code, many = spec.code, (n > 1).to("zext", "i64")
    kernel = code.item("ptr", many, how=" acquire, align 8")
    with c.if_(kernel == c.null):
        general()
    with c.if_((n > 1) & (n > code.item("i64", 4)) & (spec.threads.item("i64") != 1)):
        general()
    strides = spec.strides
    with c.for_(spec.configurations) as k:
        not_units(c, spec, n, pointers.item("ptr", k), strides.item("i64", k), general)
    memory, block = working(c, code.item("i64", many + 2), stack, general)
    c.call(kernel, n, memory, pointers, strides)
    with c.if_(block != c.null):
        c.call("PyMem_RawFree", block)
    c.returns(c.null)
    return c.text


def _about(c: Writer, metadata: Value, minor: Value) -> None:
    """What XLA asks when the handler is registered: the version that it has itself, since it takes no other."""
    for place, x in ((6, c.number(0, "i32")), (7, minor.to("trunc", "i32")), (8, c.number(0, "i32"))):
        c.store(x, metadata.at("i32", place))  # major, minor, traits


def _general(fields: Mapping[str, str]) -> str:
    """Python computes; what it has to say becomes an error of XLA's."""
    c = Writer("internal ptr @general() nounwind noinline", n="i64", pointers="ptr", api="ptr")
    n, pointers, api = c.parameters
    message = c.call(Record(Value(c, "@spec", "ptr"), fields).general, n, pointers, gives="ptr")
    with c.if_(message == c.null):
        c.returns(c.null)
    asked = c.room("i64", 4)  # size of the structure, no extension, message, code
    for k, x in enumerate((c.number(28), c.null, message, c.number(INVALID))):
        c.store(x, asked.at("i64", k))
    c.returns(c.call(Record(api, API_TABLE).error, asked, gives="ptr"))
    return c.text
