"""From a graph to a program: order, fused operations, chunks, and a slot for every value in memory.

A kernel works on tiles: one row of a tile (a *slot*) holds one value for as many samples as the
machine has lanes.  Inputs, sines and cosines, values passed between chunks, and outputs have slots.

    stage 0   operations that compute angles (chunks)
              sines and cosines of stage 0's angles (a loop over their slots)
    stage 1   ...

Chunks are straight-line functions of at most `tuning.CHUNK` operations.  The compile time of straight-line code is more
than linear in its length, and it spills badly; with chunks compile time is linear and the code is faster.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from .. import tuning
from .trace import ARITHMETIC, LEAVES, TRIGONOMETRIC, Node, Sym, Trace

BARE = frozenset((*LEAVES, *TRIGONOMETRIC))
"""Nodes that are no operations of chunks."""


def exactly(x: float) -> tuple[float, float]:
    """A key that distinguishes 0 from -0."""
    return x, math.copysign(1.0, x)


@dataclass(slots=True)
class Step:
    """One operation: node i, and its operands after fusion ("fma" -> a b + c, signs as +1 or -1)."""

    i: int
    op: str
    args: tuple[int, ...]
    signs: tuple[int, int] = (1, 1)


@dataclass
class Stage:
    """Chunks of steps, then the angles whose sines and cosines the next stage may use."""

    chunks: list[list[Step]] = field(default_factory=list)
    angles: list[int] = field(default_factory=list)


@dataclass
class Schedule:
    """The program with all data for code generation.

    Attributes
    ----------
    slot : dict
        Node -> its slot among inputs, trigonometric values and values passed between chunks.
    sine, cosine : dict
        Angle -> slot.
    together : int
        Number of contiguous cosines, followed by their sines.
    slots : int
        The number of slots.
    places : dict
        Node -> its index among the results, which are numbered separately: its slot, or with `direct` all its
        entries of the row.
    constants : dict
        Results that do not depend on the inputs: place -> value.
    outputs : list of int
        The place of each entry of the result.
    known : dict
        For bytecode: the slots of its constants, which are contiguous.
    """

    nodes: list[Node]
    stages: list[Stage]
    slot: dict[int, int]
    sine: dict[int, int]
    cosine: dict[int, int]
    slots: int
    places: dict[int, list[int]]
    constants: dict[int, float]
    outputs: list[int]
    sizes: list[int]
    together: int = 1
    direct: bool = False
    known: dict[tuple[float, float], int] = field(default_factory=dict)

    @property
    def bytecode(self) -> bool:
        """Whether it is too long to compile; then every value has a slot."""
        return bool(self.known)

    @property
    def operations(self) -> int:
        return sum(len(chunk) for stage in self.stages for chunk in stage.chunks)

    @property
    def output_slots(self) -> int:
        return 0 if self.direct else len(self.places) + len(self.constants)


def schedule(
    program: Trace, chunk: int = tuning.CHUNK, together: int = 1, direct: bool = False,
    bytecode_from: int | None = None,
) -> Schedule:  # fmt: skip
    """Order and fuse operations, cut chunks and assign slots.

    `together` is the number of angles in one vector: so many cosines are contiguous, then their sines.
    With `direct`, results are stored directly to their row.  Programs of more operations than `bytecode_from`, or
    `tuning.BYTECODE_FROM`, are bytecode.
    """
    nodes, (order, _) = program.graph.nodes, program.walked
    steps = fused(program)
    bytecode = len(steps) > (tuning.BYTECODE_FROM if bytecode_from is None else bytecode_from)
    spare = bytecode and len(steps) <= tuning.BYTECODE_FROM  # short enough for a slot of its own for each value
    direct = direct and not bytecode
    stages = staged(nodes, order, steps, len(steps) if spare else 1 if bytecode else chunk)

    starts = [sum(program.sizes[:k]) for k in range(len(program.sizes) + 1)]
    bare = [i for i in order if nodes[i][0] in BARE]
    slot = {i: starts[nodes[i][1]] + nodes[i][2] for i in bare if nodes[i][0] == "in"}
    slots = starts[-1]
    sine, cosine = {}, {}
    for stage in stages:
        stage.angles.sort(key=lambda a: slot.get(a, slots))  # inputs in their order are often contiguous
        for k in range(0, len(stage.angles), together):
            for lane, angle in enumerate(stage.angles[k : k + together]):
                cosine[angle], sine[angle] = slots + lane, slots + together + lane
            slots += 2 * together
    for i in bare:
        if nodes[i][0] in TRIGONOMETRIC:
            slot[i] = (sine if nodes[i][0] == "sin" else cosine)[nodes[i][1]]
    known: dict[tuple[float, float], int] = {}
    if bytecode:
        numbers = {i: exactly(nodes[i][1]) for i in bare if nodes[i][0] == "const"}
        keys = dict.fromkeys([*map(exactly, (1.0, 0.0, -0.0)), *numbers.values()])
        known = {key: slots + k for k, key in enumerate(keys)}
        slot |= {i: known[key] for i, key in numbers.items()}
        slots += len(known)
    if not spare:
        slots = place_passed(stages, slot, slots)

    places: dict[int, list[int]] = {}
    constants: dict[int, float] = {}
    if direct:
        outputs = list(range(len(program.outputs)))
        for j, x in enumerate(program.outputs):
            if type(x) is Sym:
                places.setdefault(x.i, []).append(j)
            else:
                constants[j] = x
    else:
        results = [x.i if type(x) is Sym else ("constant", x) for x in program.outputs]
        number = {key: k for k, key in enumerate(dict.fromkeys(results))}
        outputs = [number[key] for key in results]
        places = {key: [k] for key, k in number.items() if isinstance(key, int)}
        constants = {k: key[1] for key, k in number.items() if not isinstance(key, int)}
    if spare:
        slots = place_all(steps, places, slot, slots)
    return Schedule(
        nodes, stages, slot, sine, cosine, slots, places, constants, outputs, program.sizes, together, direct, known
    )


def fused(program: Trace) -> dict[int, Step]:
    """Steps by node; a product used once, by a sum, becomes part of it: a b + c in one operation.

    This is not left to the compiler, so that every vector width gives the same bits.
    """
    nodes, (order, uses) = program.graph.nodes, program.walked
    steps: dict[int, Step] = {}
    once: dict[int, int] = {}  # products that are used once and not yet part of a sum, and their places in the order
    for n, i in enumerate(order):
        node = nodes[i]
        op = node[0]
        if op == "*":
            if uses[i] == 1:
                once[i] = n
            else:
                steps[i] = Step(i, op, node[1:])
        elif op == "+" or op == "-":
            _, a, b = node
            p = a if a in once else None
            if b in once and (p is None or once[b] > once[a]):
                p = b  # the later product; the other is still in a register
            if p is None:
                steps[i] = Step(i, op, (a, b))
            else:
                del once[p]
                signs = (1, 1) if op == "+" else (1, -1) if p == a else (-1, 1)  # x y - b, a - x y
                _, x, y = nodes[p]
                steps[i] = Step(i, "fma", (x, y, b if p == a else a), signs)
        elif op in ARITHMETIC:
            steps[i] = Step(i, op, node[1:])
    for i in once:
        steps[i] = Step(i, "*", nodes[i][1:])
    return steps


def staged(nodes: list[Node], order: list[int], steps: dict[int, Step], chunk: int) -> list[Stage]:
    """Assign each step to a stage, the latest before all its uses."""
    angles = _angles(nodes, order)
    last = max(angles.values(), default=-1) + 1
    stage = [last] * len(nodes)
    for a, n in angles.items():
        stage[a] = n
    if any(nodes[a][0] not in LEAVES for a in angles):
        for i in reversed(order):
            op, n = nodes[i][0], stage[i]
            if n < last and op not in LEAVES and op not in TRIGONOMETRIC:
                for a in nodes[i][1:]:
                    if n < stage[a]:
                        stage[a] = n
    lines: list[list[Step]] = [[] for _ in range(last + 1)]
    for i in order:
        if i in steps:
            lines[stage[i]].append(steps[i])
    stages = []
    for n, line in enumerate(lines):
        count = -(-len(line) // chunk)
        size = -(-len(line) // count) if count else 1
        cut = [line[k : k + size] for k in range(0, len(line), size)]
        stages.append(Stage(cut, [a for a in angles if angles[a] == n]))
    return stages


def _angles(nodes: list[Node], order: list[int]) -> dict[int, int]:
    """Each angle, in order, with the stage that computes its sine and cosine: how many of them lie before it."""
    turned = {nodes[i][1] for i in order if nodes[i][0] in TRIGONOMETRIC}
    if all(nodes[a][0] in LEAVES for a in turned):  # as usual: they are inputs
        return {a: 0 for a in order if a in turned}
    level = [0] * len(nodes)
    for i in order:
        node = nodes[i]
        if node[0] not in LEAVES:
            level[i] = max(map(level.__getitem__, node[1:])) + (node[0] in TRIGONOMETRIC)
    return {a: level[a] for a in order if a in turned}


def place_all(steps: dict[int, Step], places: dict[int, list[int]], slot: dict[int, int], slots: int) -> int:
    """A slot of its own for each value, that of a result among the results, which follow the slots.

    For bytecode that serves until there is machine code: to find slots that are free takes half as long as the rest of
    the schedule.
    """
    inside = [i for i in steps if i not in places]
    slot.update(zip(inside, range(slots, slots + len(inside)), strict=True))
    slots += len(inside)
    slot.update((i, slots + places[i][0]) for i in steps if i in places)
    return slots


def place_passed(stages: list[Stage], slot: dict[int, int], slots: int) -> int:
    """Slots for values that another chunk, or the loop of sines and cosines, reads.

    A slot is free after the last chunk that reads it, so that no chunk reads and writes the same one:
    the pointers of a chunk are then noalias.
    """
    made: dict[int, int] = {}  # value -> the chunk, or loop, that computes it
    last: dict[int, int] = {}  # value -> the last other one that reads it
    n = 0
    for stage in stages:
        for chunk in stage.chunks:
            for step in chunk:
                for a in step.args:
                    if made.get(a, n) != n:
                        last[a] = n
                made[step.i] = n
            n += 1
        for a in stage.angles:
            if a in made:
                last[a] = n
        n += 1
    ends: dict[int, list[int]] = {}
    for a, n in last.items():
        ends.setdefault(n, []).append(a)
    free: list[int] = []
    n = 0
    for stage in stages:
        for chunk in (*stage.chunks, []):  # and the loop of sines and cosines
            for step in chunk:
                if step.i in last:
                    if free:
                        slot[step.i] = free.pop()
                    else:
                        slot[step.i], slots = slots, slots + 1
            free += [slot[a] for a in ends.get(n, ())]
            n += 1
    return slots
