"""The code of one thread as LLVM IR: one sample, from its row of the inputs to its row of the results."""

from __future__ import annotations

from ..codegen.host import Host
from ..codegen.number import Number
from ..codegen.sincos import cos_sin
from ..graph.schedule import Step
from . import far
from .layout import Layout
from .program import Part, Program, Value, value_of
from .scalar import GLOBAL, SHARED, Scalar, address

LINE = 32  # bytes of a memory transaction
_BINARY = {"+": "fadd", "-": "fsub", "*": "fmul"}


def arguments(layout: Layout, columns: str = "s") -> str:
    """Parameters of `compute`: each array's row, the stride of its columns if it may vary, and local memory."""
    texts = []
    for k, offset in enumerate(layout.offsets):
        texts.append(f"{address(GLOBAL if offset is None else SHARED)} %x{k}")
        if layout.strided:
            texts.append(f"i64 %{columns}{k}")
    return ", ".join([*texts, "ptr %passed"])


def functions(program: Program, number: Number, layout: Layout, host: Host) -> str:
    """``void compute(...)`` and the functions it calls."""
    parts = program.parts
    texts = [far.function(number)] if any(s.angles for part in parts for s in part.segments) else []
    names = ["compute"] if len(parts) == 1 else [f"part{n}" for n in range(len(parts))]
    texts += [
        _Part(program, part, number, layout, host).function(name) for part, name in zip(parts, names, strict=True)
    ]
    if len(parts) > 1:
        calls = "\n".join(f"  call void @{name}({arguments(layout)})" for name in names)
        texts.append(
            f"define internal void @compute({arguments(layout)}) alwaysinline #0 {{\n{calls}\n  ret void\n}}\n"
        )
    return "\n".join(texts)


class _Part:
    """One function: the names of its values, and its lines."""

    def __init__(self, program: Program, part: Part, number: Number, layout: Layout, host: Host) -> None:
        self.program, self.part, self.layout = program, part, layout
        self.nodes = program.nodes
        self.e = Scalar(number, host)
        self.names: dict[Value, str] = {}
        self.result_of = {value_of(self.nodes, i): i for i in program.places}
        self.due: dict[int, dict[int, str]] = {}  # results of incomplete groups

    def function(self, name: str) -> str:
        program, part, e = self.program, self.part, self.e
        e.label("entry")
        if part is program.parts[0]:
            for j, x in program.constants.items():
                self.result(j, e.constant(x))
            for i in program.places:
                if self.nodes[i][0] == "in":
                    self.keep(("", i), self.get(i))
        for segment in part.segments:
            if segment.angles:
                self.turn(segment.angles)
            for step in segment.steps:
                self.keep(("", step.i), self.computed(step))
        for group in self.due.values():
            self.write(group)
        kind = "alwaysinline" if len(program.parts) == 1 else "noinline"
        body = "\n".join(e.lines)
        return f"define internal void @{name}({arguments(self.layout)}) {kind} #0 {{\n{body}\n  ret void\n}}\n"

    def place(self, k: int, j: int) -> tuple[str, int]:
        """The address of column j of array k, and its address space."""
        space = GLOBAL if self.layout.offsets[k] is None else SHARED
        step: int | str = self.e.value(f"mul i64 %s{k}, {j}") if self.layout.strided and j else j
        return self.e.entry(f"%x{k}", step, space), space

    def get(self, i: int, sign: int = 1) -> str:
        """The value of a node, loaded at its first use."""
        e, key = self.e, value_of(self.nodes, i)
        found = self.names.get(key)
        if found is None:
            op, *args = self.nodes[i]
            if op == "const":
                found = e.constant(args[0])
            elif op == "in":
                pointer, space = self.place(*args)
                found = e.get(pointer, space, fixed=space == GLOBAL)
            else:
                found = e.get(e.entry("%passed", self.part.reads[key]))
            self.names[key] = found
        return found if sign > 0 else e.negative(found)

    def keep(self, key: Value, x: str) -> None:
        """Store a value if other parts or the caller need it."""
        self.names[key] = x
        if key in self.part.writes:
            self.e.put(self.e.entry("%passed", self.part.writes[key]), x)
        for j in self.program.places[self.result_of[key]] if key in self.result_of else ():
            self.result(j, x)

    def result(self, j: int, x: str) -> None:
        """Store result j; in global memory together with its neighbours.

        Separate stores to parts of a line would each need a read and a write of the line.
        """
        size = 1 if self.layout.strided or self.layout.offsets[-1] is not None else LINE // self.e.number.size
        group = self.due.setdefault(j // size, {})
        group[j] = x
        if len(group) == min(size, self.program.width - j // size * size):
            self.write(self.due.pop(j // size))

    def write(self, group: dict[int, str]) -> None:
        for j, x in sorted(group.items()):
            pointer, space = self.place(len(self.program.sizes), j)
            self.e.put(pointer, x, space)

    def computed(self, step: Step) -> str:
        e, get, a = self.e, self.get, step.args
        if step.op == "fma":
            return e.fma(get(a[0], step.signs[0]), get(a[1]), get(a[2], step.signs[1]))
        if step.op in _BINARY:
            return e.binary(_BINARY[step.op], get(a[0]), get(a[1]))
        if step.op == "inv":
            return e.binary("fdiv", e.constant(1.0), get(a[0]))
        if step.op == "neg":
            result = step.i in self.program.places  # 0 - 0 is 0: no result is -0
            return e.binary("fsub", e.constant(0.0), get(a[0])) if result else e.negative(get(a[0]))
        if step.op == "sqrt":
            return e.unary("sqrt", get(a[0]))
        return e.where_less(*map(get, a))

    def turn(self, angles: list[int]) -> None:
        """Cosines and sines of several angles, with a branch for angles beyond the short reduction."""
        e, T = self.e, self.e.vector
        xs = [self.get(a) for a in angles]
        fast = [cos_sin(e, x) for x in xs]
        every = fast[0][2]
        for _, _, near in fast[1:]:
            every = e.value(f"and i1 {every}, {near}")
        before, away, on = e.here, e.new_label("away"), e.new_label("on")
        e.do(f"br i1 {every}, label %{on}, label %{away}, !prof !2")
        e.label(away)
        slow = []
        for x, (*values, near) in zip(xs, fast, strict=True):
            both = e.value(f"call {{{T}, {T}}} @far({T} {x})")
            others = [e.value(f"extractvalue {{{T}, {T}}} {both}, {n}") for n in (0, 1)]
            slow.append([e.value(f"select i1 {near}, {T} {a}, {T} {b}") for a, b in zip(values, others, strict=True)])
        e.do(f"br label %{on}")
        e.label(on)
        made = [
            [e.value(f"phi {T} [{a}, %{before}], [{b}, %{away}]") for a, b in zip(values, others, strict=True)]
            for (*values, _), others in zip(fast, slow, strict=True)
        ]
        for a, (c, s) in zip(angles, made, strict=True):
            self.keep(("cos", a), c)
            self.keep(("sin", a), s)
