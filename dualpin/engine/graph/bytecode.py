"""Bytecode for programs that are too long to compile, executed by the loop of `codegen.interpreter`.

From `tuning.BYTECODE_FROM` operations on, a program is a table of rows of four 32-bit words.  Almost
every operation is one of

    slot[to] = +-slot[a] slot[b] +- slot[c]          row: to | a | b | c     (bit 31 of a, c: the negative)

with constant ones and zeros for missing operands, so that a run of them needs no branches:

    kind | count | d | 0                             before each run of one kind
    to   | a     | b | c                             count times
    END  | 0     | 0 | 0

Operations, order and rounding are those of compiled code, so the results have the same bits.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

from .schedule import Schedule, Stage, Step, exactly

MULTIPLY, INVERT, ROOT, SELECT, END = range(5)
MINUS = 1 << 31  # added to the index of a slot: its negative

Row = tuple[int, int, int, int]
"""(to, a, b, c), or before each run of one kind (kind, count, d, 0), d the fourth operand of a select."""


def encoded(plan: Schedule, stage: Stage) -> bytes:
    """The steps of a stage."""
    runs: list[tuple[int, int, list[Row]]] = []
    for kind, d, row in _rows(plan, stage):
        if kind == SELECT or not runs or runs[-1][0] != kind:
            runs.append((kind, d, []))
        runs[-1][2].append(row)
    words = [x for kind, d, rows in runs for row in ((kind, len(rows), d, 0), *rows) for x in row]
    return struct.pack(f"<{len(words) + 4}I", *words, END, 0, 0, 0)


def _rows(plan: Schedule, stage: Stage) -> Iterator[tuple[int, int, Row]]:
    one, nothing = plan.known[exactly(1.0)], plan.known[exactly(-0.0)]  # x + -0 == x for every x, including -0
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
        return slots[0] | MINUS, one, zero if step.i in plan.places else nothing
    x, y = slots[:2]
    if step.op == "fma":
        of_product, of_sum = (0 if sign > 0 else MINUS for sign in step.signs)
        return x | of_product, y, slots[2] | of_sum
    if step.op == "*":
        return x, y, nothing
    return (x, one, y) if step.op == "+" else (y | MINUS, one, x)
