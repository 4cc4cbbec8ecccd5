"""The order of operations: one with few live values.

A thread has registers for about a hundred numbers; further live values are spilled to memory.  Operations are taken
depth first from the results, the deepest operand first, so that values which are computed quickly are computed late.
(Sethi & Ullman 1970, for trees)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..graph.schedule import Step
from ..graph.trace import Node


def arranged(
    nodes: list[Node], steps: dict[int, Step], order: Sequence[int], outputs: Sequence[int], registers: int
) -> list[int]:
    """Operations, sines and cosines, each after its operands: the given order if no other is better."""
    depth = depths(nodes, steps, order)
    candidates = [
        [i for i in order if operands(nodes, steps, i)],
        list(depth_first(nodes, steps, outputs, depth)),
        list(depth_first(nodes, steps, outputs[::-1], depth)),
    ]
    return min(candidates, key=lambda line: waiting(nodes, steps, line, registers))


def operands(nodes: list[Node], steps: dict[int, Step], i: int) -> tuple[int, ...]:
    """The operands of an operation after fusion."""
    if i in steps:
        return steps[i].args
    op, *args = nodes[i]
    return (args[0],) if op in ("sin", "cos") else ()


def depths(nodes: list[Node], steps: dict[int, Step], order: Sequence[int]) -> dict[int, int]:
    """The length of the longest chain of operations to each value."""
    depth: dict[int, int] = {}
    for i in order:
        args = operands(nodes, steps, i)
        if args:
            depth[i] = 1 + max(depth.get(a, 0) for a in args)
    return depth


def depth_first(
    nodes: list[Node], steps: dict[int, Step], outputs: Sequence[int], depth: dict[int, int]
) -> Iterator[int]:
    """Each value after its operands, the deepest operand first."""
    done: set[int] = set()

    def pending(i: int) -> Iterator[int]:
        return iter(sorted(operands(nodes, steps, i), key=lambda a: -depth.get(a, 0)))

    for out in outputs:
        if out in done:
            continue
        done.add(out)
        stack = [(out, pending(out))]
        while stack:
            i, rest = stack[-1]
            for a in rest:
                if a not in done:
                    done.add(a)
                    stack.append((a, pending(a)))
                    break
            else:
                if i in depth:
                    yield i
                stack.pop()


def waiting(nodes: list[Node], steps: dict[int, Step], line: Sequence[int], registers: int) -> int:
    """The number of live values beyond the registers, summed over the operations."""
    last: dict[int, int] = {}
    for n, i in enumerate(line):
        for a in operands(nodes, steps, i):
            last[a] = n
    ends = [0] * (len(line) + 1)
    total = alive = 0
    made = set(line)
    for a, n in last.items():
        if a in made:
            ends[n] += 1
    for n, i in enumerate(line):
        alive += (i in last) - ends[n]
        total += max(0, alive - registers)
    return total
