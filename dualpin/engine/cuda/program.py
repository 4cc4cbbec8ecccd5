"""From a graph to the program of one thread.

A thread has at most 255 registers, so the order matters more than on a CPU: sines and cosines are computed a few at a
time, just before their use, and a program too long for one function is cut into several, which pass values through
the thread's local memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from ...errors import DualpinError
from ..graph.schedule import Step, fused
from ..graph.trace import Node, Sym, Trace
from ..tuning import GPU_ANGLES as ANGLES
from ..tuning import GPU_LONGEST as LONGEST
from ..tuning import GPU_PART as PART
from .order import arranged


class TooLongError(DualpinError):
    """The program of a term is too long for a GPU."""


@dataclass
class Segment:
    """Sines and cosines of some angles, then a line of operations."""

    angles: list[int] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)


@dataclass
class Part:
    """Segments of one function; `reads` and `writes` are the slots of values passed between parts."""

    segments: list[Segment] = field(default_factory=list)
    reads: dict[tuple[str, int], int] = field(default_factory=dict)
    writes: dict[tuple[str, int], int] = field(default_factory=dict)


@dataclass
class Program:
    """The program with the data for code generation.

    Attributes
    ----------
    places : dict
        Node -> its positions among the results.
    constants : dict
        Results that do not depend on the inputs: position -> value.
    passed : int
        Slots of local memory for values passed between parts.
    """

    nodes: list[Node]
    sizes: list[int]
    width: int
    parts: list[Part]
    places: dict[int, list[int]]
    constants: dict[int, float]
    passed: int

    @property
    def operations(self) -> int:
        return sum(len(s.steps) for part in self.parts for s in part.segments)


def program(traced: Trace, registers: int, part: int = PART, together: int = ANGLES) -> Program:
    """The program of one thread with registers for this many numbers.

    Raises
    ------
    TooLongError
        If it is longer than `LONGEST`.
    """
    nodes, (order, _) = traced.graph.nodes, traced.walked
    steps = fused(traced)
    if len(steps) > LONGEST:
        raise TooLongError(
            f"{len(steps)} operations: too long for a GPU, where a program of at most {LONGEST} is worth it"
        )
    results = list(dict.fromkeys(x.i for x in traced.outputs if type(x) is Sym))
    line = arranged(nodes, steps, order, results, registers)
    parts = list(cut(segments(nodes, line, steps, together), part))
    places: dict[int, list[int]] = {}
    constants: dict[int, float] = {}
    for j, x in enumerate(traced.outputs):
        if type(x) is Sym:
            places.setdefault(x.i, []).append(j)
        else:
            constants[j] = x
    return Program(nodes, traced.sizes, len(traced.outputs), parts, places, constants, placed(nodes, parts))


def segments(nodes: list[Node], line: list[int], steps: dict[int, Step], together: int) -> Iterator[Segment]:
    """The operations, cut where sines and cosines have to be computed."""
    wanted = list(dict.fromkeys(nodes[i][1] for i in line if nodes[i][0] in ("sin", "cos")))  # by first use
    made: set[int] = set()
    computed: set[int] = set()
    now = Segment()
    for i in line:
        op, *args = nodes[i]
        if op in ("sin", "cos") and args[0] not in made:
            ready = [a for a in wanted if a not in made and (nodes[a][0] == "in" or a in computed)][:together]
            if now.steps or now.angles:
                yield now
            now = Segment(ready)
            made.update(ready)
        elif i in steps:
            now.steps.append(steps[i])
            computed.add(i)
    yield now


def cut(line: Iterator[Segment], most: int) -> Iterator[Part]:
    """Parts of about equal length, each of at most this many operations."""
    whole = list(line)
    total = sum(len(s.steps) for s in whole)
    size = -(-total // max(1, -(-total // most)))
    part, room = Part(), size
    for segment in whole:
        angles, steps = segment.angles, segment.steps
        while True:
            part.segments.append(Segment(angles, steps[:room]))
            angles, steps, room = [], steps[room:], room - len(steps[:room])
            if not steps:
                break
            yield part
            part, room = Part(), size
    yield part


Value = tuple[str, int]
"""("", node), or ("sin" | "cos", angle)."""


def value_of(nodes: list[Node], i: int) -> Value:
    op = nodes[i][0]
    return (op, nodes[i][1]) if op in ("sin", "cos") else ("", i)


def made_and_read(nodes: list[Node], part: Part) -> tuple[set[Value], set[Value]]:
    """The values that a part computes, and those it needs besides inputs and constants."""
    made: set[Value] = set()
    read: set[Value] = set()
    for s in part.segments:
        read.update(value_of(nodes, a) for a in s.angles)
        made.update((op, a) for a in s.angles for op in ("sin", "cos"))
        read.update(value_of(nodes, a) for step in s.steps for a in step.args)
        made.update(("", step.i) for step in s.steps)
    return made, {v for v in read if v[0] or nodes[v[1]][0] not in ("in", "const")}


def placed(nodes: list[Node], parts: list[Part]) -> int:
    """Assign slots to values that later parts read; a slot is free after the last part that reads it."""
    flow = [made_and_read(nodes, part) for part in parts]
    last = {v: n for n, (made, read) in enumerate(flow) for v in read - made}
    slot: dict[Value, int] = {}
    free: list[int] = []
    slots = 0
    for n, (part, (made, read)) in enumerate(zip(parts, flow, strict=True)):
        part.reads = {v: slot[v] for v in sorted(read - made)}
        for v in sorted(made):
            if last.get(v, -1) > n:
                if not free:
                    free.append(slots)
                    slots += 1
                slot[v] = part.writes[v] = free.pop()
        free += [slot[v] for v in part.reads if last[v] == n]
    return slots
