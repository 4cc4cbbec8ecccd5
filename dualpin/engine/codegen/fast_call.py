"""The functions behind every fast call, against the stable C API of CPython 3.11 and later.

    entry      what Python calls: METH_FASTCALL | METH_KEYWORDS, with a capsule as `self`
    hand_on    gives back what a call holds, and hands it to the general function
    release    the destructor of the capsule

Written with `c_like`, so that a line here is a line of C.  Looking up an attribute and allocating may run
Python code, so they come before the first buffer is held.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .c_like import Record, Value, Writer, struct

API = {
    "PyCapsule_GetPointer": "ptr (ptr, ptr)",
    "PyCapsule_GetContext": "ptr (ptr)",
    "PyObject_GetAttr": "ptr (ptr, ptr)",
    "PyObject_GetBuffer": "i32 (ptr, ptr, i32)",
    "PyBuffer_Release": "void (ptr)",
    "PyObject_Call": "ptr (ptr, ptr, ptr)",
    "PyTuple_New": "ptr (i64)",
    "PyTuple_Size": "i64 (ptr)",
    "PyTuple_GetItem": "ptr (ptr, i64)",
    "PyTuple_SetItem": "i32 (ptr, i64, ptr)",
    "PyDict_New": "ptr ()",
    "PyDict_SetItem": "i32 (ptr, ptr, ptr)",
    "PyErr_Clear": "void ()",
    "PyErr_NoMemory": "ptr ()",
    "PyMem_RawMalloc": "ptr (i64)",
    "PyMem_RawFree": "void (ptr)",
    "PyEval_SaveThread": "ptr ()",
    "PyEval_RestoreThread": "void (ptr)",
    "Py_IncRef": "void (ptr)",
    "Py_DecRef": "void (ptr)",
}
BUFFER = {
    "buf": "ptr", "obj": "ptr", "len": "i64", "itemsize": "i64", "readonly": "i32", "ndim": "i32", "format": "ptr",
    "shape": "ptr", "strides": "ptr", "suboffsets": "ptr", "internal": "ptr",
}  # fmt: skip
CODE = {"one": "ptr", "many": "ptr", "scratch_one": "i64", "scratch_many": "i64", "most": "i64"}
"""Of `jit.fast_call.Code`: two kernels, what each needs to work in, and how many samples are worth one thread."""

MOST, AXES = 6, 4
"""Arrays a call can have, and axes one of them for one sample."""
_READ, _WRITE = 0x8, 0x9  # PyBUF_ND, with PyBUF_WRITABLE: contiguous, with a shape
_NORM = 1.9e-6  # of a quaternion's squared norm, 1e-6 of its norm and a little less: the general call decides


def text(spec: Mapping[str, str], stack: int) -> str:
    """The module, given the fields of `jit.fast_call.Spec` and the bytes of scratch the stack may hold."""
    declarations = "".join(f"declare {kind.replace(' (', f' @{name}(', 1)}\n" for name, kind in API.items())
    return declarations + _entry(spec, stack) + _hand_on() + _general() + _release()


def _entry(fields: Mapping[str, str], stack: int) -> str:
    c = Writer("ptr @entry() nounwind", capsule="ptr", args="ptr", nargs="i64", names="ptr")
    capsule, args, nargs, names = c.parameters
    buffers, pointers = c.room(struct(BUFFER), MOST), c.room("ptr", MOST)
    spec = Record(c.call("PyCapsule_GetPointer", capsule, c.null, gives="ptr"), fields)
    slow, inputs, with_out = spec.slow, spec.inputs, spec.inputs + 1

    def buffer(k: Value) -> Record:
        return Record(buffers.at(struct(BUFFER), k), BUFFER)

    def general() -> None:
        c.returns(c.call("general", slow, args, nargs, names, gives="ptr"))

    # the keyword `out`, after all inputs, and no other
    named = names != c.null
    with c.if_(named):
        with c.if_((c.call("PyTuple_Size", names, gives="i64") != 1) | (nargs != inputs)):
            general()
        with c.if_(c.call("PyTuple_GetItem", names, c.number(0), gives="ptr") != spec.out_name):
            general()
    given = nargs + named.to("zext", "i64")
    with c.if_((given != inputs) & (given != with_out)):
        general()
    # out=None is no out
    no, none = c.number(0, "i1"), spec.none
    has_out = c.choose(given == with_out, lambda: args.item("ptr", inputs) != none, lambda: no)

    # every dtype is the very one
    dtype, dtype_name = spec.dtype, spec.dtype_name
    with c.for_(inputs + has_out.to("zext", "i64")) as k:
        found = c.call("PyObject_GetAttr", args.item("ptr", k), dtype_name, gives="ptr")
        with c.if_(found == c.null):
            general()
        c.call("Py_DecRef", found)
        with c.if_(found != dtype):
            general()

    def borrowed() -> Value:
        theirs = args.item("ptr", inputs)
        c.call("Py_IncRef", theirs)
        return theirs

    out = c.choose(
        has_out, borrowed, lambda: c.call("PyObject_Call", spec.allocate, spec.allocate_args, c.null, gives="ptr")
    )
    with c.if_(out == c.null):
        c.returns(c.null)

    def hand_on(held: Value, to: Value = slow) -> None:
        c.returns(c.call("hand_on", to, args, nargs, names, buffers, held, out, gives="ptr"))

    # all arrays contiguous, the last of them the result
    with c.for_(with_out) as k:
        last = k == inputs
        x = c.choose(last, lambda: out, lambda: args.item("ptr", k))
        flags = c.value(f"select i1 {last.name}, i32 {_WRITE}, i32 {_READ}", "i32")
        place = buffers.at(struct(BUFFER), k)
        with c.if_(c.call("PyObject_GetBuffer", x, place, flags, gives="i32") < 0):
            hand_on(k)
        c.store(place.item("ptr"), pointers.at("ptr", k))

    # one sample, or n with one axis more: every shape that of the table (axes, bytes, lengths)
    shapes = spec.shapes
    first = buffer(c.number(0))
    many = first.ndim.to("sext", "i64") - shapes.item("i64")
    with c.if_((many != 0) & (many != 1)):
        hand_on(with_out)
    n = c.choose(many == 1, lambda: first.shape.item("i64"), lambda: c.number(1))
    with c.for_(with_out) as k:
        b, row = buffer(k), shapes.at("i64", k * (2 + AXES))
        axes, shape = row.item("i64"), b.shape
        with c.if_((b.ndim.to("sext", "i64") != axes + many) | (b.len != row.item("i64", 1) * n)):
            hand_on(with_out)
        with c.if_(c.choose(many == 1, lambda: shape.item("i64"), lambda: n) != n):
            hand_on(with_out)
        with c.for_(axes) as i, c.if_(shape.item("i64", many + i) != row.item("i64", i + 2)):
            hand_on(with_out)

    # the kernel, if it is compiled yet; it is set after all the rest
    code = spec.code
    kernel = code.item("ptr", many, how=" acquire, align 8")
    with c.if_(kernel == c.null):
        hand_on(with_out)
    scratch = code.item("i64", many + 2)

    # a batch: no more samples than one thread should have, and a result apart from what is still to be read
    with c.if_(many == 1):
        alone = (spec.threads.item("i64") == 1) | (spec.alone != 0)
        with c.if_((n <= 0) | ((n > code.item("i64", 4)) & (alone == 0))):
            hand_on(with_out)
        result = buffer(inputs)
        start = result.buf.to("ptrtoint", "i64")
        end = start + result.len
        with c.for_(inputs) as k:
            y = buffer(k)
            begin = y.buf.to("ptrtoint", "i64")
            with c.if_((begin + y.len > start) & (end > begin)):
                hand_on(with_out)

    # quaternions of norm 1, or the general call says which is not
    strides, single, quaternions = spec.strides, spec.single != 0, spec.quaternions
    with c.if_(quaternions != 0):
        q, at, size = pointers.item("ptr"), spec.quaternion_at, strides.item("i64")
        with c.for_(n) as sample, c.for_(quaternions) as k:
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
                hand_on(with_out)

    # scratch on the stack or, aligned, on the heap
    small = scratch <= stack
    block = c.choose(small, lambda: c.null, lambda: c.call("PyMem_RawMalloc", scratch + 64, gives="ptr"))
    with c.if_((block == c.null) & (scratch > stack)):
        c.call("PyErr_NoMemory", gives="ptr")
        hand_on(with_out, c.null)
    memory = c.choose(
        small,
        lambda: c.room("i8", scratch, align=64),
        lambda: ((block.to("ptrtoint", "i64") + 63) & -64).to("inttoptr", "ptr"),
    )
    with c.if_(many == 0):
        c.call(kernel, c.number(1), memory, pointers, strides)
    with c.if_(many == 1):  # other threads of Python may run meanwhile
        state = c.call("PyEval_SaveThread", gives="ptr")
        c.call(kernel, n, memory, pointers, strides)
        c.call("PyEval_RestoreThread", state)
    with c.if_(block != c.null):
        c.call("PyMem_RawFree", block)
    with c.for_(with_out) as k:
        c.call("PyBuffer_Release", buffers.at(struct(BUFFER), k))
    c.returns(out)
    return c.text


def _hand_on() -> str:
    """Release the first buffers and the result; then the general function answers, if there is one."""
    c = Writer(
        "internal ptr @hand_on() nounwind noinline",
        slow="ptr", args="ptr", nargs="i64", names="ptr", buffers="ptr", held="i64", out="ptr",
    )  # fmt: skip
    slow, args, nargs, names, buffers, held, out = c.parameters
    with c.for_(held) as k:
        c.call("PyBuffer_Release", buffers.at(struct(BUFFER), k))
    c.call("Py_DecRef", out)
    with c.if_(slow == c.null):
        c.returns(c.null)
    c.returns(c.call("general", slow, args, nargs, names, gives="ptr"))
    return c.text


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
    """The capsule goes, and with it what it kept."""
    c = Writer("void @release() nounwind", capsule="ptr")
    c.call("Py_DecRef", c.call("PyCapsule_GetContext", *c.parameters, gives="ptr"))
    c.returns()
    return c.text
