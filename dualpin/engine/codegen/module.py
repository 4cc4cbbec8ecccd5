"""A schedule as LLVM IR: a kernel that maps rows of numbers to rows of numbers.

    void kernel(i64 n, ptr scratch, ptr arrays, ptr strides)

`arrays` holds the addresses of the inputs and, last, of the output; `strides` the distances between rows in numbers (0
repeats a row; rows of the output are contiguous).  A tile has as many samples as a vector has lanes.  For each tile,
rows are transposed to slots (the last tile repeats its last row), stages run, and results are transposed to rows.
Loads, stores and sines are loops; only the robot's arithmetic is straight-line code.

    for each tile:   rows of inputs  ->  slots                        transpose
                     for each stage: chunks, or bytecode              straight line, interpreter
                                     slots of angles -> cos, sin      sincos
                     slots of results  ->  rows                       transpose, cacheline

Constants are read from one table by an address in a register: LLVM's own pool needs a 64-bit address for each use.
Gain: RNEA of talos 1.25 times as fast.  Stack frames are aligned to cache lines, so that spilled vectors do not cross
them: RNEA of panda 35 ns instead of 38 or 39 in most processes (Zen 4).
"""

from __future__ import annotations

from ..graph.bytecode import encoded
from ..graph.schedule import Schedule, Step, exactly
from .cacheline import transfer_for
from .host import Host
from .interpreter import constants_loop, interpreter_loop
from .number import Number
from .sincos import SinCos
from .transpose import Array
from .vector import VectorWriter

_LIBRARY = (
    "declare double @dualpin_sin(double)\ndeclare double @dualpin_cos(double)\n@dualpin_stores = external global i64\n"
)
_OPS = {"+": "fadd", "-": "fsub", "*": "fmul"}
_CHUNK_ARGS = (
    "ptr noalias readonly %in, ptr noalias %out, ptr noalias readonly %from, ptr noalias %to, "
    "ptr noalias readonly %constants"
)


def modules(plan: Schedule, number: Number, host: Host, lanes: int, parts: int = 1) -> list[str]:
    """The kernel and the functions it calls, as text; with one lane, it is for single configurations.

    With several parts, the first has the kernel and the others most of its chunks.
    """
    emit = KernelWriter(plan, number, lanes, host)
    widths = sorted({lanes, plan.together, host.lanes(number.size)} if lanes == 1 else {lanes // 2, lanes})
    declarations = [*(VectorWriter(number, w, host).declarations for w in widths), _LIBRARY]
    main, chunks, calls = [emit.rows.tables(), emit.angles.tables()], dict[str, str](), list[str]()
    linkage = "internal" if parts == 1 else ""
    for k, stage in enumerate(plan.stages):
        if plan.bytecode:
            steps = encoded(plan, stage)
            text = "\\" + steps.hex("\\")
            main.append(f'@bytecode{k} = internal constant [{len(steps)} x i8] c"{text}", align 16\n')
            calls.append(f"call void @interpret(ptr %scratch, ptr @bytecode{k})")
        for c, chunk in enumerate([] if plan.bytecode else stage.chunks):
            name = f"chunk{k}_{c}"
            chunks[name] = emit.chunk(name, chunk, linkage)
            calls.append(f"call void @{name}(ptr %scratch, ptr %out, ptr %scratch, ptr %scratch, ptr @constants)")
        calls += emit.angles.calls(k)
    if plan.bytecode:
        main += [interpreter_loop(emit.lanes()), constants_loop(emit.lanes(), plan)]
        emit.pool = {key: k for k, key in enumerate(plan.known)}
    main += emit.angles.functions()
    main += [emit.kernel(calls), emit.constant_table()]
    names = list(chunks)
    shares = [names[k * len(names) // parts : (k + 1) * len(names) // parts] for k in range(parts)]
    main += [f"declare void @{name}({_CHUNK_ARGS})" for share in shares[1:] for name in share]
    attributes = "nounwind"
    if lanes > 1:  # spilled vectors must not cross cache lines
        attributes += f" alignstack={lanes * number.size}"
    if host.width == 64:
        attributes += ' "prefer-vector-width"="512"'
    end = f'attributes #0 = {{ {attributes} "no-trapping-math"="true" }}\n!0 = !{{i32 1}}\n'
    bodies = [[*([] if k else main), *(chunks[name] for name in share)] for k, share in enumerate(shares)]
    return ["\n".join([*declarations, *body, end]) for body in bodies]


def scratch_bytes(plan: Schedule, number: Number, host: Host, lanes: int) -> int:
    """Bytes of scratch memory of a kernel, aligned to 64 bytes."""
    return (plan.slots + plan.output_slots + transfer_for(plan, number, lanes, host).spare) * lanes * number.size


class KernelWriter:
    def __init__(self, plan: Schedule, number: Number, width: int, host: Host) -> None:
        self.plan, self.number, self.width, self.host = plan, number, width, host
        self.rows = transfer_for(plan, number, width, host)
        self.angles = SinCos(plan, number, width, host)
        self.pool: dict[tuple[float, float], int] = {}  # numbers used by the straight lines

    def lanes(self) -> VectorWriter:
        return VectorWriter(self.number, self.width, self.host)

    # the straight lines

    def chunk(self, name: str, steps: list[Step], linkage: str) -> str:
        plan, e = self.plan, self.lanes()
        names: dict[int, str] = {}

        def constant(x: float) -> str:
            # by an address in a register: LLVM's own pool would need a 64-bit address for each use
            k = self.pool.setdefault(exactly(x), len(self.pool))
            return e.broadcast(e.value(f"getelementptr inbounds {self.number.name}, ptr %constants, i64 {k}"))

        def get(i: int, sign: int = 1) -> str:
            found = names.get(i)
            if found is None:
                node = plan.nodes[i]
                if node[0] == "const":
                    found = constant(node[1])
                else:
                    found = e.load("%in" if node[0] in ("in", "sin", "cos") else "%from", plan.slot[i])
                names[i] = found
            return found if sign > 0 else e.negative(found)

        for step in steps:
            a = step.args
            if step.op == "fma":
                x = e.fma(get(a[0], step.signs[0]), get(a[1]), get(a[2], step.signs[1]))
            elif step.op in _OPS:
                x = e.binary(_OPS[step.op], get(a[0]), get(a[1]))
            elif step.op == "inv":
                x = e.binary("fdiv", constant(1.0), get(a[0]))
            elif step.op == "neg":
                result = step.i in plan.places  # 0 - 0 is 0: no result is -0
                x = e.binary("fsub", e.constant(0.0), get(a[0])) if result else e.negative(get(a[0]))
            elif step.op == "sqrt":
                x = e.unary("sqrt", get(a[0]))
            else:
                x = e.where_less(*map(get, a))
            names[step.i] = x
            if step.i in plan.slot:
                e.store("%to", plan.slot[step.i], x)
            for place in plan.places.get(step.i, ()):
                e.store("%out", place, x)
        body = "\n".join(e.lines)
        return f"define {linkage} void @{name}({_CHUNK_ARGS}) noinline #0 {{\n{body}\n  ret void\n}}\n"

    # from rows to slots and back

    def constant_table(self) -> str:
        """The numbers of the straight lines, once they are written."""
        e = self.lanes()
        entries = [f"{self.number.name} {e.number_text(x)}" for x, _ in self.pool]
        return f"@constants = internal constant [{len(entries)} x {self.number.name}] [{', '.join(entries)}]\n"

    def _constants(self, e: VectorWriter) -> None:
        """Results that do not depend on the inputs."""
        for place, x in self.plan.constants.items():
            e.store("%out", place, e.constant(x))

    def _copied(self, e: VectorWriter, ops: tuple[str, ...]) -> None:
        """Results that are inputs, or sines of inputs."""
        for i, places in self.plan.places.items():
            if self.plan.nodes[i][0] in ops:
                x = e.load("%scratch", self.plan.slot[i])
                for place in places:
                    e.store("%out", place, x)

    def kernel(self, calls: list[str]) -> str:
        plan, e = self.plan, self.lanes()
        size = self.number.size
        arrays = []
        for k in range(len(plan.sizes) + 1):
            pointer = e.value(f"load ptr, ptr {e.value(f'getelementptr ptr, ptr %arrays, i64 {k}')}")
            stride = e.value(f"load i64, ptr {e.value(f'getelementptr i64, ptr %strides, i64 {k}')}")
            arrays.append(Array(pointer, e.value(f"mul i64 {stride}, {size}")))
        if not plan.direct:
            e.do(f"%out = getelementptr {e.vector}, ptr %scratch, i64 {plan.slots}")
        if not plan.direct and not plan.bytecode:
            self._constants(e)
        e.do("%last = sub i64 %n, 1")
        e.do("%any = icmp sgt i64 %n, 0")
        e.do("br i1 %any, label %tile, label %exit")
        e.label("tile")
        e.do("%b = phi i64 [0, %entry], [%b.next, %tile.end]")
        # hides from LLVM that this is the loop counter: strength reduction of hundreds of row addresses took a
        # third of the compile time and gained nothing
        e.do('%row = call i64 asm "", "=r,0"(i64 %b)')
        for k in range(len(plan.sizes)):
            self.rows.load(e, k, arrays[k], "%row", "%last")
        if self.rows.overlaps:
            e.do("%first.time = icmp eq i64 %row, 0")
            e.do("br i1 %first.time, label %begin, label %finished")
            e.label("begin")
            if self.rows.ahead:
                self.angles.some(e, 0, 0)
                calls = calls[1:]
            e.do("br label %compute")
            e.label("finished")
            e.do(f"%b.before = sub i64 %row, {self.width}")
            self.rows.store(e, arrays[-1], "%b.before", "%last")
            e.do("%some = icmp slt i64 %row, %n")
            e.do("br i1 %some, label %compute, label %exit")
            e.label("compute")
        if plan.direct:
            e.do(f"%begin.row = mul i64 %row, {arrays[-1].stride}")
            e.do(f"%out = getelementptr i8, ptr {arrays[-1].pointer}, i64 %begin.row")
            self.rows.copy_constants(e)
        self._copied(e, ("in",))
        if plan.bytecode:  # in each tile, since loads of rows may write beyond the slots of the inputs
            e.do("call void @load_constants(ptr %scratch, ptr @constants)")
            self._constants(e)
        for call in calls:
            e.do(call)
        self._copied(e, ("sin", "cos"))
        if not plan.direct and not self.rows.overlaps:
            self.rows.store(e, arrays[-1], "%row", "%last")
        e.do("br label %tile.end")
        e.label("tile.end")
        e.do(f"%b.next = add i64 %b, {self.width}")
        if self.rows.overlaps:
            e.do("br label %tile")
        else:
            e.do("%more = icmp slt i64 %b.next, %n")
            e.do("br i1 %more, label %tile, label %exit")
        e.label("exit")
        if self.rows.overlaps:
            e.do("fence seq_cst")  # orders non-temporal stores before all that follows
        body = "\n".join(e.lines)
        return (
            "define void @kernel(i64 %n, ptr %scratch, ptr %arrays, ptr %strides) #0 {\nentry:\n"
            f"{body}\n  ret void\n}}\n"
        )
