"""The loop that executes bytecode, and the one that loads its constants.

    run:   kind, count, d of a run            switch (kind)
    row:   slot[to] = fma(+-slot[a], slot[b], +-slot[c])    next row, until the run is over

Gain: programs that LLVM could not compile in minutes or gigabytes run 40 times as fast as with NumPy, and
three times slower than machine code (tiago_dual `aba_derivatives`, 500 880 operations, Emerald Rapids).
"""

from __future__ import annotations

from ..graph.bytecode import MINUS
from ..graph.schedule import Schedule
from .vector import VectorWriter


def constants_loop(e: VectorWriter, plan: Schedule) -> str:
    """void load_constants(ptr slots, ptr constants): the program's numbers to their slots, in all lanes."""
    first, count = next(iter(plan.known.values())), len(plan.known)
    e.do("br label %loop")
    e.label("loop")
    e.do("%k = phi i64 [0, %entry], [%next, %loop]")
    x = e.broadcast(e.value(f"getelementptr {e.number.name}, ptr %constants, i64 %k"))
    e.store("%slots", e.value(f"add i64 %k, {first}"), x)
    e.do("%next = add i64 %k, 1")
    e.do(f"%more = icmp slt i64 %next, {count}")
    e.do("br i1 %more, label %loop, label %done")
    e.label("done")
    return _function("load_constants(ptr %slots, ptr %constants)", e)


def interpreter_loop(e: VectorWriter) -> str:
    """void interpret(ptr slots, ptr bytecode): every row, up to the end."""
    kinds = ("multiply", "invert", "root", "select")
    e.do("br label %run")
    e.label("run")
    e.do("%head = phi ptr [%bytecode, %entry], " + ", ".join(f"[%{kind}.next, %{kind}]" for kind in kinds))
    kind, count, d = (_word(e, "%head", k) for k in range(3))
    size = e.value(f"shl i64 {e.value(f'zext i32 {count} to i64')}, 4")
    e.do("%first = getelementptr i8, ptr %head, i64 16")
    e.do(f"%end = getelementptr i8, ptr %first, i64 {size}")
    cases = " ".join(f"i32 {k}, label %{kind}" for k, kind in enumerate(kinds))
    e.do(f"switch i32 {kind}, label %done [{cases}]")
    for kind in kinds:
        row = f"%{kind}.row"
        e.label(kind)
        e.do(f"{row} = phi ptr [%first, %run], [%{kind}.next, %{kind}]")
        e.store("%slots", _index(e, _word(e, row, 0)), _computed(e, kind, row, d))
        e.do(f"%{kind}.next = getelementptr i8, ptr {row}, i64 16")
        e.do(f"%{kind}.more = icmp ult ptr %{kind}.next, %end")
        e.do(f"br i1 %{kind}.more, label %{kind}, label %run")
    e.label("done")
    return _function("interpret(ptr %slots, ptr %bytecode)", e)


def _function(head: str, e: VectorWriter) -> str:
    body = "\n".join(e.lines)
    return f"define internal void @{head} noinline #0 {{\nentry:\n{body}\n  ret void\n}}\n"


def _computed(e: VectorWriter, kind: str, row: str, d: str) -> str:
    if kind == "multiply":
        return e.fma(_signed(e, row, 1), _operand(e, row, 2), _signed(e, row, 3))
    if kind == "invert":
        return e.binary("fdiv", _operand(e, row, 2), _operand(e, row, 1))
    if kind == "root":
        return e.unary("sqrt", _operand(e, row, 1))
    x, y, a = (_operand(e, row, k) for k in (1, 2, 3))
    return e.where_less(x, y, a, e.load("%slots", _index(e, d)))


def _word(e: VectorWriter, row: str, k: int) -> str:
    return e.value(f"load i32, ptr {e.value(f'getelementptr i32, ptr {row}, i64 {k}')}, align 4")


def _index(e: VectorWriter, word: str) -> str:
    return e.value(f"zext i32 {word} to i64")


def _operand(e: VectorWriter, row: str, k: int) -> str:
    return e.load("%slots", _index(e, _word(e, row, k)))


def _signed(e: VectorWriter, row: str, k: int) -> str:
    """The number in a slot, or its negative."""
    word, bits = _word(e, row, k), e.number.bits
    sign = e.value(f"and i32 {word}, {-MINUS}")
    if bits == 64:
        sign = e.value(f"shl i64 {_index(e, sign)}, 32")
    slot = _index(e, e.value(f"and i32 {word}, {MINUS - 1}"))
    raw = e.value(f"bitcast {e.vector} {e.load('%slots', slot)} to {e.integer}")
    flipped = e.value(f"xor {e.integer} {raw}, {e.splat(sign, f'i{bits}')}")
    return e.value(f"bitcast {e.integer} {flipped} to {e.vector}")
