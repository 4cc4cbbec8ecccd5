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

Words = list[int]


def encoded(plan: Schedule, stage: Stage) -> bytes:
    """The steps of a stage."""
    words: Words = []
    for kind, d, rows in _runs(plan, stage):
        words += (kind, len(rows) // 4, d, 0)
        words += rows
    return struct.pack(f"<{len(words) + 4}I", *words, END, 0, 0, 0)


def _runs(plan: Schedule, stage: Stage) -> Iterator[tuple[int, int, Words]]:
    """Runs of one kind, with the fourth operand of a select: its rows, each of four words (to, a, b, c)."""
    slot, places = plan.slot, plan.places
    one, zero, nothing = (plan.known[exactly(x)] for x in (1.0, 0.0, -0.0))  # x + -0 == x for every x, including -0
    run: Words = []  # of products and sums
    for chunk in stage.chunks:
        for step in chunk:
            i, op, args = step.i, step.op, step.args
            results = [plan.slots + place for place in places[i]] if i in places else []
            to = slot[i] if i in slot else results[0]
            x = slot[args[0]]
            if op == "fma":
                (of_product, of_sum), c = step.signs, slot[args[2]]
                x, c = x if of_product > 0 else x | MINUS, c if of_sum > 0 else c | MINUS
                run += (to, x, slot[args[1]], c)
            elif op == "*":
                run += (to, x, slot[args[1]], nothing)
            elif op == "+":
                run += (to, x, one, slot[args[1]])
            elif op == "-":
                run += (to, slot[args[1]] | MINUS, one, x)
            elif op == "neg":  # no result is -0
                run += (to, x | MINUS, one, zero if i in places else nothing)
            else:
                if run:
                    yield MULTIPLY, 0, run
                    run = []
                if op == "select":
                    _, y, a, b = (slot[k] for k in args)
                    yield SELECT, b, [to, x, y, a]
                else:
                    yield (INVERT, 0, [to, x, one, 0]) if op == "inv" else (ROOT, 0, [to, x, 0, 0])
            for place in results:
                if place != to:
                    run += (place, to, one, nothing)
    if run:
        yield MULTIPLY, 0, run
