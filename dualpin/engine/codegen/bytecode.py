"""Programs too long for a compiler: a tape of operations, and the loop that walks it.

LLVM takes some 25 us for an operation, and memory in proportion.  From `schedule.LONG` of them on, a
program is a table of numbers instead of code.  Almost every operation is one of

    slot[to] = +-slot[a] slot[b] +- slot[c]

with known ones and zeros where there are no operands, so that a run of them needs no decisions.
Steps, order and rounding are those of compiled code, and so are the bits of the results.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from ..graph.schedule import Schedule, Stage, Step, exactly
from .vector import Lanes

MULTIPLY, INVERT, ROOT, SELECT, END = range(5)
_MINUS = 1 << 31  # with the number of a slot: the negative of what is there

Row = tuple[int, int, int, int]
"""(to, a, b, c), or before each run of one kind (kind, how many, d, 0), d the fourth operand of a selection."""


def tape(plan: Schedule, stage: Stage) -> bytes:
    """The steps of a stage."""
    runs: list[tuple[int, int, list[Row]]] = []
    for kind, d, row in _rows(plan, stage):
        if kind == SELECT or not runs or runs[-1][0] != kind:
            runs.append((kind, d, []))
        runs[-1][2].append(row)
    words = [x for kind, d, rows in runs for row in ((kind, len(rows), d, 0), *rows) for x in row]
    return struct.pack(f"<{len(words) + 4}I", *words, END, 0, 0, 0)


def _rows(plan: Schedule, stage: Stage) -> Iterator[tuple[int, int, Row]]:
    one, nothing = plan.known[exactly(1.0)], plan.known[exactly(-0.0)]  # x + -0 is x, whatever its sign
    for chunk in stage.chunks:
        for step in chunk:
            places = [plan.slots + place for place in plan.places.get(step.i, ())]
            to, *copies = [plan.slot[step.i], *places] if step.i in plan.slot else places
            slots = [plan.slot[a] for a in step.args]
            if step.op == "select":
                yield SELECT, slots[3], (to, slots[0], slots[1], slots[2])
            elif step.op == "inv":
                yield INVERT, 0, (to, slots[0], one, 0)
            elif step.op == "sqrt":
                yield ROOT, 0, (to, slots[0], 0, 0)
            else:
                yield MULTIPLY, 0, (to, *_product(plan, step, slots))
            for place in copies:
                yield MULTIPLY, 0, (place, to, one, nothing)


def _product(plan: Schedule, step: Step, slots: list[int]) -> tuple[int, int, int]:
    """A step as a b + c."""
    one, zero, nothing = (plan.known[exactly(x)] for x in (1.0, 0.0, -0.0))
    if step.op == "neg":  # no result is -0
        return slots[0] | _MINUS, one, zero if step.i in plan.places else nothing
    x, y = slots[:2]
    if step.op == "fma":
        of_product, of_sum = (0 if sign > 0 else _MINUS for sign in step.signs)
        return x | of_product, y, slots[2] | of_sum
    if step.op == "*":
        return x, y, nothing
    return (x, one, y) if step.op == "+" else (y | _MINUS, one, x)


def teller(e: Lanes, plan: Schedule) -> str:
    """void tell(ptr slots, ptr constants): the numbers of a tape to their slots, in all lanes."""
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
    return _function("tell(ptr %slots, ptr %constants)", e)


def walker(e: Lanes) -> str:
    """void walk(ptr slots, ptr tape): what the tape says, up to its end."""
    kinds = ("multiply", "invert", "root", "select")
    e.do("br label %run")
    e.label("run")
    e.do("%head = phi ptr [%tape, %entry], " + ", ".join(f"[%{kind}.next, %{kind}]" for kind in kinds))
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
    return _function("walk(ptr %slots, ptr %tape)", e)


def _function(head: str, e: Lanes) -> str:
    body = "\n".join(e.lines)
    return f"define internal void @{head} noinline #0 {{\nentry:\n{body}\n  ret void\n}}\n"


def _computed(e: Lanes, kind: str, row: str, d: str) -> str:
    if kind == "multiply":
        return e.fma(_signed(e, row, 1), _operand(e, row, 2), _signed(e, row, 3))
    if kind == "invert":
        return e.binary("fdiv", _operand(e, row, 2), _operand(e, row, 1))
    if kind == "root":
        return e.unary("sqrt", _operand(e, row, 1))
    x, y, a = (_operand(e, row, k) for k in (1, 2, 3))
    return e.where_less(x, y, a, e.load("%slots", _index(e, d)))


def _word(e: Lanes, row: str, k: int) -> str:
    return e.value(f"load i32, ptr {e.value(f'getelementptr i32, ptr {row}, i64 {k}')}, align 4")


def _index(e: Lanes, word: str) -> str:
    return e.value(f"zext i32 {word} to i64")


def _operand(e: Lanes, row: str, k: int) -> str:
    return e.load("%slots", _index(e, _word(e, row, k)))


def _signed(e: Lanes, row: str, k: int) -> str:
    """The number in a slot, or the negative of it."""
    word, bits = _word(e, row, k), e.number.bits
    sign = e.value(f"and i32 {word}, {-_MINUS}")
    if bits == 64:
        sign = e.value(f"shl i64 {_index(e, sign)}, 32")
    slot = _index(e, e.value(f"and i32 {word}, {_MINUS - 1}"))
    raw = e.value(f"bitcast {e.vector} {e.load('%slots', slot)} to {e.integer}")
    flipped = e.value(f"xor {e.integer} {raw}, {e.splat(sign, f'i{bits}')}")
    return e.value(f"bitcast {e.integer} {flipped} to {e.vector}")
