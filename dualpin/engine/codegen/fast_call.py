"""The functions behind every fast call, against the stable C API of CPython 3.11 and later, and NumPy's.

    entry      called by Python: METH_FASTCALL | METH_KEYWORDS, with a capsule as `self`
    public     the same for functions of a robot: it looks up the form of the call
    compute    checks the arrays, allocates the result, calls the kernel; null if the slow call must answer
    release    the destructor of the capsule

Written with `c_like`, so that a line here is a line of C.  Nothing here runs Python code before the general call.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .c_like import Record, Value, Writer

API = {
    "PyCapsule_GetPointer": "ptr (ptr, ptr)",
    "PyCapsule_GetContext": "ptr (ptr)",
    "PyObject_Call": "ptr (ptr, ptr, ptr)",
    "PyTuple_New": "ptr (i64)",
    "PyTuple_Size": "i64 (ptr)",
    "PyTuple_GetItem": "ptr (ptr, i64)",
    "PyTuple_SetItem": "i32 (ptr, i64, ptr)",
    "PyDict_New": "ptr ()",
    "PyDict_SetItem": "i32 (ptr, ptr, ptr)",
    "PyErr_Clear": "void ()",
    "PyMem_RawMalloc": "ptr (i64)",
    "PyMem_RawFree": "void (ptr)",
    "PyEval_SaveThread": "ptr ()",
    "PyEval_RestoreThread": "void (ptr)",
    "Py_IncRef": "void (ptr)",
    "Py_DecRef": "void (ptr)",
}
NUMPY = {"PyArray_Empty": ("ptr (i32, ptr, ptr, i32)", 184)}
"""Indices in NumPy's table of functions; they are part of its binary interface."""
ARRAY = {
    "references": "i64", "type": "ptr", "data": "ptr", "ndim": "i32", "shape": "ptr", "strides": "ptr", "base": "ptr",
    "dtype": "ptr", "flags": "i32",
}  # fmt: skip
"""Fields of an array in memory (`PyArrayObject_fields`).  NumPy's headers compile their places into every extension
module, so that they are part of its binary interface too; `jit.fast_call` verifies them."""
OPTIONS = 6
FORM = {
    "function": "ptr", "robot": "ptr", "given": "i64", "names": "i64", "spec": "ptr", "inputs": "i64", "out": "i64",
    "options": "i64", "input_at": "ptr", "option_at": "ptr", "option": "ptr", "name": "ptr",
}  # fmt: skip
"""Fields of `jit.public.Form`: the form of a call, and the fast call for it."""

MOST, AXES = 9, 4
"""The most arrays of a call (Hessian products with external forces), and axes of an array for one sample."""
BUCKETS, FORMS = 64, 63
"""Forms are kept in hash buckets; a call searches one bucket."""
_READ, _WRITE = 0x101, 0x501  # flags of an array that is C-contiguous and aligned; and writeable
_WARNS = 1 << 31  # flag of an array whose first change NumPy warns of
_NORM = 1.9e-6  # tolerance of a squared norm, slightly below 1e-6 of the norm; the general call decides the rest


def text(spec: Mapping[str, str], stack: int) -> str:
    """The module, given the fields of `jit.fast_call.Spec` and the bytes of scratch the stack may hold."""
    signatures = API | {name: kind for name, (kind, _) in NUMPY.items()} | {"PyObject_Vectorcall": _VECTORCALL}
    declarations = "".join(f"declare {kind.replace(' (', f' @{name}(', 1)}\n" for name, kind in signatures.items())
    return (
        declarations + "@forms = external global i8\n@stores = external global i64\n"
        + _entry(spec) + _public(spec) + _fits() + _compute(spec, stack) + _general() + _release()
    )  # fmt: skip


_VECTORCALL = "ptr (ptr, ptr, i64, ptr)"


def _entry(fields: Mapping[str, str]) -> str:
    c = Writer("ptr @entry() nounwind", capsule="ptr", args="ptr", nargs="i64", names="ptr")
    capsule, args, nargs, names = c.parameters
    spec = c.call("PyCapsule_GetPointer", capsule, c.null, gives="ptr")
    slow, inputs = Record(spec, fields).slow, Record(spec, fields).inputs

    def general() -> None:
        c.returns(c.call("general", slow, args, nargs, names, gives="ptr"))

    # the keyword `out`, after all inputs, and no other
    named = names != c.null
    with c.if_(named):
        with c.if_((c.call("PyTuple_Size", names, gives="i64") != 1) | (nargs != inputs)):
            general()
        with c.if_(c.call("PyTuple_GetItem", names, c.number(0), gives="ptr") != Record(spec, fields).out_name):
            general()
    given = nargs + named.to("zext", "i64")
    with c.if_((given != inputs) & (given != inputs + 1)):
        general()
    out = c.choose(given != inputs, lambda: args.item("ptr", inputs), lambda: c.null)
    result = c.call("compute", spec, args, out, gives="ptr")
    with c.if_(result == c.null):
        general()
    c.returns(result)
    return c.text


def _public(fields: Mapping[str, str]) -> str:
    """A call of a known form: its arrays are found by their positions."""
    c = Writer("ptr @public() nounwind", function="ptr", args="ptr", nargs="i64", names="ptr")
    function, args, nargs, names = c.parameters
    arrays = c.room("ptr", MOST + 1)
    with c.if_(nargs > 0):
        robot = args.item("ptr")
        count = c.choose(names == c.null, lambda: c.number(0), lambda: c.call("PyTuple_Size", names, gives="i64"))
        sum_ = (function.to("ptrtoint", "i64") >> 5) + (robot.to("ptrtoint", "i64") >> 4)
        bucket = Value(c, "@forms", "ptr").at(f"[{FORMS + 1} x ptr]", sum_ & (BUCKETS - 1))
        with c.for_(bucket.item("i64")) as k:
            place = bucket.item("ptr", k + 1)
            form = Record(place, FORM)
            same = (form.robot == robot) & (form.function == function) & (form.given == nargs) & (form.names == count)
            with c.if_(same), c.if_(c.call("fits", place, args, names, gives="i1") == 1):
                inputs = form.inputs
                with c.for_(inputs) as i:
                    c.store(args.item("ptr", form.input_at.item("i64", i)), arrays.at("ptr", i))
                out = c.choose(form.out < 0, lambda: c.null, lambda: args.item("ptr", form.out))
                result = c.call("compute", form.spec, arrays, out, gives="ptr")
                with c.if_(result != c.null):
                    c.returns(result)
                c.store(out, arrays.at("ptr", inputs))
                given = inputs + (out != c.null).to("zext", "i64")
                slow = Record(form.spec, fields).slow
                c.returns(c.call("general", slow, arrays, given, c.null, gives="ptr"))
    c.returns(c.call("PyObject_Vectorcall", function, args, nargs, names, gives="ptr"))
    return c.text


def _fits() -> str:
    """Whether the names and the options of a call are identical objects to those of a form."""
    c = Writer("internal i1 @fits() nounwind", form="ptr", args="ptr", names="ptr")
    place, args, names = c.parameters
    form, no = Record(place, FORM), c.number(0, "i1")
    with (
        c.for_(form.names) as k,
        c.if_(c.call("PyTuple_GetItem", names, k, gives="ptr") != form.name.item("ptr", k)),
    ):
        c.returns(no)
    with (
        c.for_(form.options) as k,
        c.if_(args.item("ptr", form.option_at.item("i64", k)) != form.option.item("ptr", k)),
    ):
        c.returns(no)
    c.returns(c.number(1, "i1"))
    return c.text


def _compute(fields: Mapping[str, str], stack: int) -> str:
    """The result for arrays that need no conversion; null, possibly with an exception set, for all others.

    `asked` is an array for the result, None, or null.
    """
    c = Writer("internal ptr @compute() nounwind noinline", spec="ptr", arrays="ptr", asked="ptr")
    place, arrays, asked = c.parameters
    spec = Record(place, fields)
    pointers, sizes = c.room("ptr", MOST), c.room("i64", AXES + 1)
    inputs, none = spec.inputs, spec.none
    has_out = (asked != c.null) & (asked != none)
    held = inputs + has_out.to("zext", "i64")

    def array(k: Value) -> Record:
        return Record(c.choose(k == inputs, lambda: asked, lambda: arrays.item("ptr", k)), ARRAY)

    def give_up() -> None:
        c.returns(c.null)

    # NumPy's own arrays of the same dtype object, contiguous; the last of them is the result
    dtype, kind = spec.dtype, spec.array
    with c.for_(held) as k:
        x = array(k)
        with c.if_(x.type != kind):
            give_up()
        last = k == inputs
        wanted = c.value(f"select i1 {last.name}, i32 {_WRITE}, i32 {_READ}", "i32")
        flags = c.value(f"select i1 {last.name}, i32 {_WRITE - _WARNS}, i32 {_READ}", "i32")
        with c.if_((x.dtype != dtype) | ((x.flags & flags) != wanted)):
            give_up()
        c.store(x.data, pointers.at("ptr", k))

    # one sample, or n with one axis more: every shape that of the table (axes, bytes, lengths)
    shapes = spec.shapes
    first = array(c.number(0))
    many = first.ndim.to("sext", "i64") - shapes.item("i64")
    with c.if_((many != 0) & (many != 1)):
        give_up()
    n = c.choose(many == 1, lambda: first.shape.item("i64"), lambda: c.number(1))
    with c.for_(held) as k:
        x, row = array(k), shapes.at("i64", k * (2 + AXES))
        axes, shape = row.item("i64"), x.shape
        with c.if_(x.ndim.to("sext", "i64") != axes + many):
            give_up()
        with c.if_(c.choose(many == 1, lambda: shape.item("i64"), lambda: n) != n):
            give_up()
        with c.for_(axes) as i, c.if_(shape.item("i64", many + i) != row.item("i64", i + 2)):
            give_up()

    # the kernel, if it is compiled yet; it is set after all the rest.  A batch of one is one sample.
    code = spec.code
    several = c.choose(n == 1, lambda: c.number(0), lambda: many)
    kernel = code.item("ptr", several, how=" acquire, align 8")
    with c.if_(kernel == c.null):
        give_up()
    scratch = code.item("i64", several + 2)

    # a batch: at most the samples for one thread, and a result that does not overlap the inputs
    row = shapes.at("i64", inputs * (2 + AXES))
    with c.if_(many == 1):
        alone = spec.alone != 0
        one = (spec.threads.item("i64") == 1) | alone
        with c.if_((n <= 0) | ((several == 1) & (n > code.item("i64", 4)) & (one == 0))):
            give_up()
        with c.if_(has_out):
            start = pointers.item("ptr", inputs).to("ptrtoint", "i64")
            end = start + row.item("i64", 1) * n
            with c.for_(inputs) as k:
                begin = pointers.item("ptr", k).to("ptrtoint", "i64")
                size = shapes.item("i64", k * (2 + AXES) + 1) * n
                with c.if_((begin < end) & (start < begin + size)):
                    give_up()
        # a large one: memory from the pool and, the first time, the choice of stores
        with c.if_((row.item("i64", 1) * n >= spec.pooled) & (alone == 0)):
            settled = Value(c, "@stores", "ptr").item("i64", 1)
            with c.if_((has_out == 0) | (settled == 0)):
                give_up()

    # unit quaternions; otherwise the general call raises the error
    strides = spec.strides
    not_units(c, spec, n, pointers.item("ptr"), strides.item("i64"), give_up)

    def allocated() -> Value:
        axes = row.item("i64")
        c.store(n, sizes)
        with c.for_(axes) as i:
            c.store(row.item("i64", i + 2), sizes.at("i64", many + i))
        c.call("Py_IncRef", dtype)  # the array takes this reference
        count = (axes + many).to("trunc", "i32")
        return c.call("PyArray_Empty", count, sizes, dtype, c.number(0, "i32"), gives="ptr")

    def borrowed() -> Value:
        c.call("Py_IncRef", asked)
        return asked

    out = c.choose(has_out, borrowed, allocated)
    with c.if_(out == c.null):
        give_up()
    with c.if_(has_out == 0):
        c.store(Record(out, ARRAY).data, pointers.at("ptr", inputs))

    def no_memory() -> None:
        c.call("Py_DecRef", out)
        give_up()

    memory, block = working(c, scratch, stack, failed=no_memory)
    with c.if_(several == 0):
        c.call(kernel, c.number(1), memory, pointers, strides)
    with c.if_(several == 1):  # releases the GIL
        state = c.call("PyEval_SaveThread", gives="ptr")
        c.call(kernel, n, memory, pointers, strides)
        c.call("PyEval_RestoreThread", state)
    with c.if_(block != c.null):
        c.call("PyMem_RawFree", block)
    c.returns(out)
    return c.text


def not_units(c: Writer, spec: Record, n: Value, q: Value, size: Value, then: Callable[[], object]) -> None:
    """`then` if a quaternion in n configurations of so many numbers is not of norm 1; it leaves the function.

    The spec has `quaternions`, how many, `quaternion_at`, where they start, and `single`, whether numbers are floats.
    """
    at, single, quaternions = spec.quaternion_at, spec.single != 0, spec.quaternions
    with c.if_(quaternions != 0), c.for_(n) as sample, c.for_(quaternions) as k:
        begin = sample * size + at.item("i64", k)

        def squares(load: Callable[[Value], Value], begin: Value = begin) -> Value:
            total = c.number(-1.0, "double")
            for i in range(4):
                x = load(begin + i)
                total = x * x + total
            return total

        norm = c.choose(
            single,
            lambda: squares(lambda i: q.item("float", i).to("fpext", "double")),
            lambda: squares(lambda i: q.item("double", i)),
        )
        with c.if_((norm > _NORM) | (norm < -_NORM)):
            then()


def working(c: Writer, size: Value, stack: int, failed: Callable[[], object]) -> tuple[Value, Value]:
    """Memory for a kernel, on the stack or, aligned, on the heap; and what is to be freed then, or null."""
    small = size <= stack
    block = c.choose(small, lambda: c.null, lambda: c.call("PyMem_RawMalloc", size + 64, gives="ptr"))
    with c.if_((block == c.null) & (size > stack)):
        failed()
    memory = c.choose(
        small,
        lambda: c.room("i8", size, align=64),
        lambda: ((block.to("ptrtoint", "i64") + 63) & -64).to("inttoptr", "ptr"),
    )
    return memory, block


def _general() -> str:
    """slow(*args, **keywords)"""
    c = Writer("internal ptr @general() nounwind noinline", slow="ptr", args="ptr", nargs="i64", names="ptr")
    slow, args, nargs, names = c.parameters
    c.call("PyErr_Clear")
    arguments = c.call("PyTuple_New", nargs, gives="ptr")
    with c.if_(arguments == c.null):
        c.returns(c.null)
    with c.for_(nargs) as k:
        x = args.item("ptr", k)
        c.call("Py_IncRef", x)
        c.call("PyTuple_SetItem", arguments, k, x, gives="i32")
    keywords = c.choose(names != c.null, lambda: c.call("PyDict_New", gives="ptr"), lambda: c.null)
    with c.if_(names != c.null):
        with c.if_(keywords == c.null):
            c.call("Py_DecRef", arguments)
            c.returns(c.null)
        with c.for_(c.call("PyTuple_Size", names, gives="i64")) as k:
            name = c.call("PyTuple_GetItem", names, k, gives="ptr")
            c.call("PyDict_SetItem", keywords, name, args.item("ptr", nargs + k), gives="i32")
    result = c.call("PyObject_Call", slow, arguments, keywords, gives="ptr")
    c.call("Py_DecRef", arguments)
    with c.if_(keywords != c.null):
        c.call("Py_DecRef", keywords)
    c.returns(result)
    return c.text


def _release() -> str:
    """The destructor of the capsule: releases its references."""
    c = Writer("void @release() nounwind", capsule="ptr")
    c.call("Py_DecRef", c.call("PyCapsule_GetContext", *c.parameters, gives="ptr"))
    c.returns()
    return c.text
