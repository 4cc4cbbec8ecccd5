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

from .schedule import Schedule, Stage, exactly

MULTIPLY, INVERT, ROOT, SELECT, END = range(5)
MINUS = 1 << 31  # added to the index of a slot: its negative

Row = tuple[int, int, int, int]
"""(to, a, b, c), or before each run of one kind (kind, count, d, 0), d the fourth operand of a select."""


def encoded(plan: Schedule, stage: Stage) -> bytes:
    """The steps of a stage."""
    words: list[int] = []
    run, count = -1, 0  # the kind of the current run, and where its count is
    for kind, d, row in _rows(plan, stage):
        if kind != run or kind == SELECT:
            run, count = kind, len(words) + 1
            words += (kind, 0, d, 0)
        words[count] += 1
        words += row
    return struct.pack(f"<{len(words) + 4}I", *words, END, 0, 0, 0)


def _rows(plan: Schedule, stage: Stage) -> Iterator[tuple[int, int, Row]]:
    slot, places = plan.slot, plan.places
    one, zero, nothing = (plan.known[exactly(x)] for x in (1.0, 0.0, -0.0))  # x + -0 == x for every x, including -0
    for chunk in stage.chunks:
        for step in chunk:
            i, op, args = step.i, step.op, step.args
            results = [plan.slots + place for place in places[i]] if i in places else []
            to = slot[i] if i in slot else results[0]
            x = slot[args[0]]
            if op == "fma":
                (of_product, of_sum), c = step.signs, slot[args[2]]
                x, c = x if of_product > 0 else x | MINUS, c if of_sum > 0 else c | MINUS
                yield MULTIPLY, 0, (to, x, slot[args[1]], c)
            elif op == "*":
                yield MULTIPLY, 0, (to, x, slot[args[1]], nothing)
            elif op == "+":
                yield MULTIPLY, 0, (to, x, one, slot[args[1]])
            elif op == "-":
                yield MULTIPLY, 0, (to, slot[args[1]] | MINUS, one, x)
            elif op == "neg":  # no result is -0
                yield MULTIPLY, 0, (to, x | MINUS, one, zero if i in places else nothing)
            elif op == "inv":
                yield INVERT, 0, (to, x, one, 0)
            elif op == "sqrt":
                yield ROOT, 0, (to, x, 0, 0)
            else:
                _, y, a, b = (slot[k] for k in args)
                yield SELECT, b, (to, x, y, a)
            for place in results:
                if place != to:
                    yield MULTIPLY, 0, (place, to, one, nothing)
