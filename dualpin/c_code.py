"""Straight-line programs as plain C99, for processors without an operating system.

Values are kept in one array of slots, a slot is reused after the last use of its value, and the
statements are cut into functions of at most `PART`: however a compiler is told to optimise, the stack is
the array and the frame of one such function.  No recursion, no allocation, no state, no loops; the only
calls of a library are `sin` and `cos`, and with ``math="own"`` there is none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .engine.codegen.number import DOUBLE, SINGLE, Number
from .engine.graph.trace import Sym, Trace

PART = 100
"""Statements in one function."""
FRAME = 512
"""Bytes of the stack for return addresses and saved registers of the three functions that are active at once."""
OPERATORS = {"+": "{0} + {1}", "-": "{0} - {1}", "*": "{0} * {1}", "neg": "-{0}", "select": "({0} < {1}) ? {2} : {3}"}
COUNTED = ("additions", "multiplications", "divisions", "comparisons", "sines and cosines")
_OPERATION = {
    "+": "additions", "-": "additions", "*": "multiplications", "inv": "divisions", "select": "comparisons",
    "sin": "sines and cosines", "cos": "sines and cosines",
}  # fmt: skip


@dataclass
class Program:
    """A program in C: declarations, statements, and its cost.

    Attributes
    ----------
    before : list of str
        Functions that it calls.
    body : list of str
        Lines of its own.
    slots : int
        Size of the array of slots.
    operations : dict
        How many of each kind a call does, always the same: there are no branches but choices of a value.
    """

    before: list[str]
    body: list[str]
    slots: int
    operations: dict[str, int]
    costs: dict[str, int]
    """Operations of each function that replaces a library function."""
    size: int

    @property
    def stack(self) -> int:
        """Bytes of the stack, at most: the slots, the values of one part, frames."""
        return self.size * (self.slots + PART) + FRAME


@dataclass
class _Writer:
    name: str
    number: Number
    inputs: list[str]
    """Parameters as they are declared."""
    names: list[str]
    own: bool
    lines: list[str] = field(default_factory=list)
    free: list[int] = field(default_factory=list)
    slots: int = 0
    needed: set[str] = field(default_factory=set)
    """Helpers that are called."""

    def slot(self) -> str:
        if not self.free:
            self.free.append(self.slots)
            self.slots += 1
        return f"t[{self.free.pop()}]"

    def release(self, place: str) -> None:
        self.free.append(int(place[2:-1]))

    def literal(self, x: float) -> str:
        single = self.number is SINGLE
        text = repr(float(np.float32(x))) if single else repr(float(x))
        return f"({text}f)" if single and x < 0 else f"({text})" if x < 0 else text + "f" * single


def written(program: Trace, names: list[str], name: str, number: Number, *, own: bool) -> Program:
    """The program of a term: results are written last, so they may share memory with the inputs."""
    inputs = [f"const {number.name} {key}[{n}]" for key, n in zip(names, program.sizes, strict=True)]
    w = _Writer(name, number, inputs, names, own)
    places = _statements(w, program)
    parts = [w.lines[i : i + PART] for i in range(0, len(w.lines), PART)]
    before: list[str] = []
    body: list[str] = []
    if w.slots:
        body.append(f"{number.name} t[{w.slots}];")
    for i, part in enumerate(parts):
        used = [x for x, key in zip(w.inputs, w.names, strict=True) if any(f"{key}[" in line for line in part)]
        given = [key for key in names if any(f"const {number.name} {key}[" in x for x in used)]
        head = f"static void {name}_part{i}({', '.join([*used, f'{number.name} t[{w.slots}]'])})"
        before += [f"{NOINLINE} {head};", f"{head}", "{", *(f"    {line}" for line in part), "}", ""]
        body.append(f"{name}_part{i}({', '.join([*given, 't'])});")
    unused = [key for key in names if not any(f"{key}[" in line for line in w.lines)]
    body = [*body[:1], *(f"(void){key};" for key in unused), *body[1:]] if w.slots else [f"(void){k};" for k in unused]
    body += [f"result[{k}] = {place};" for k, place in enumerate(places)]
    helpers = _helpers(w)
    return Program([*helpers, *before], body, w.slots, _counted(program), _costs(w), number.size)


NOINLINE = "DUALPIN_APART"
MACRO = f"""#if defined(__GNUC__)
#define {NOINLINE} __attribute__((noinline))
#else
#define {NOINLINE}
#endif
"""


def _statements(w: _Writer, program: Trace) -> list[str]:
    """Fills the lines; returns where each result is, or what it is."""
    nodes, (order, counted) = program.graph.nodes, program.walked
    uses = list(counted)
    kept = {x.i for x in program.outputs if type(x) is Sym}
    place: dict[int, str] = {}

    def done(i: int) -> None:
        """After a use of i."""
        uses[i] -= 1
        if not uses[i] and i not in kept and place[i].startswith("t["):
            w.release(place[i])

    pairs: dict[int, str] = {}  # slots of sines and cosines that were computed together with the other of their angle
    for i in order:
        op, *args = nodes[i]
        if op == "in":
            text = f"{w.names[args[0]]}[{args[1]}]"
            place[i] = w.slot() if i in kept else text
            if i in kept:
                w.lines.append(f"{place[i]} = {text};")
            continue
        if op == "const":
            place[i] = w.literal(args[0])
            continue
        operands = [place[a] for a in args]
        if op in ("sin", "cos") and w.own:
            place[i] = _turned(w, op, operands[0], i, program.graph.known(_OTHER[op], args[0]), uses, pairs)
        else:
            text = _expression(w, op, operands)
        for a in args:
            done(a)
        if not (op in ("sin", "cos") and w.own):
            place[i] = w.slot()  # often the slot of an operand that was just read for the last time
            w.lines.append(f"{place[i]} = {text};")
    return [place[x.i] if type(x) is Sym else w.literal(x) for x in program.outputs]


def _expression(w: _Writer, op: str, operands: list[str]) -> str:
    if op == "inv":
        return f"{w.literal(1.0)} / {operands[0]}"
    if op == "sqrt":
        w.needed.add("root")
        return f"{w.name}_root({operands[0]})"
    if op in ("sin", "cos"):
        w.needed.add("math")
        return f"{op}{'f' * (w.number is SINGLE)}({operands[0]})"
    return OPERATORS[op].format(*operands)


_OTHER = {"sin": "cos", "cos": "sin"}


def _turned(w: _Writer, op: str, x: str, i: int, other: int | None, uses: list[int], pairs: dict[int, str]) -> str:
    """Sine and cosine of an angle are computed together; the second is kept if it is used."""
    if i in pairs:
        return pairs.pop(i)
    w.needed.add("turn")
    mine, beside = w.slot(), w.slot()
    s, c = (mine, beside) if op == "sin" else (beside, mine)
    w.lines.append(f"{w.name}_turn({x}, &{s}, &{c});")
    if other is not None and uses[other]:
        pairs[other] = beside
    else:
        w.release(beside)
    return mine


def _counted(program: Trace) -> dict[str, int]:
    total = dict.fromkeys([*COUNTED, "square roots"], 0)
    for op, n in program.graph.count(program.outputs).items():
        if op == "sqrt":
            total["square roots"] += n
        elif op in _OPERATION:
            total[_OPERATION[op]] += n
    return total


# --- functions in place of a library's -----------------------------------------------------------------


def _helpers(w: _Writer) -> list[str]:
    lines: list[str] = []
    if "root" in w.needed:
        lines += _root(w)
    if "turn" in w.needed:
        lines += _turn(w)
    return lines


def _root(w: _Writer) -> list[str]:
    """The square root, by powers of 4 into [1, 4] and Newton's iteration: within 1 ulp, of normal numbers."""
    kind, k = w.number.name, w.literal
    most, steps = (9, 5) if w.number is DOUBLE else (6, 4)
    lines = [f"static {kind} {w.name}_root({kind} x)", "{", f"    {kind} m = x;", f"    {kind} scale = {k(1.0)};"]
    for power in (2**i for i in range(most, 0, -1)):
        up, half = 2.0**power, 2.0 ** (power // 2)
        for test, factor, turned in ((f"m >= {k(up)}", 1 / up, half), (f"m < {k(4.0 / up)}", up, 1 / half)):
            lines += [
                f"    if ({test})",
                "    {",
                f"        m = m * {k(factor)};",
                f"        scale = scale * {k(turned)};",
                "    }",
            ]
    lines += [f"    {kind} y = {k(0.6)} + ({k(0.4)} * m);"]
    lines += [f"    y = {k(0.5)} * (y + (m / y));"] * steps
    # for 0, negative numbers and nan the product gives 0 or nan
    lines += [
        f"    if (x > {k(0.0)})", "    {", "        y = y * scale;", "    }", "    else", "    {",
        f"        y = x * {k(0.0)};", "    }", "    return y;", "}", "",
    ]  # fmt: skip
    return lines


def _turn(w: _Writer) -> list[str]:
    """Sine and cosine by Cody and Waite's reduction and two polynomials, as in the compiled kernels."""
    number, kind, k = w.number, w.number.name, w.literal

    def polynomial(coefficients: tuple[float, ...]) -> str:
        *rest, text = map(k, coefficients)
        for c in reversed(rest):
            text = f"({c} + (z * {text}))"
        return text

    reduced = "x"
    for part in number.split:
        reduced = f"({reduced} - (m * {k(part)}))"
    return [
        f"static void {w.name}_turn({kind} x, {kind} *sine, {kind} *cosine)", "{",
        f"    const {kind} turns = x * {k(2 / np.pi)};",
        "    long n = 0L;",
        f"    {kind} r;",
        f"    if ((x >= {k(-number.reach)}) && (x <= {k(number.reach)}))",
        "    {",
        f"        const {kind} half = (turns < {k(0.0)}) ? {k(-0.5)} : {k(0.5)};",
        f"        const {kind} rounded = turns + half;",
        f"        {kind} m;",
        "        n = (long)rounded;",
        f"        m = ({kind})n;",
        f"        r = {reduced};",
        "    }",
        "    else",
        "    {",
        f"        r = ({k(0.0)} * x) / (x - x); /* no number */",
        "    }",
        f"    const {kind} z = r * r;",
        f"    const {kind} s = r + ((r * z) * {polynomial(number.sin)});",
        f"    const {kind} c = ({k(1.0)} - ({k(0.5)} * z)) + ((z * z) * {polynomial(number.cos)});",
        "    const long quarter = ((n % 4L) + 4L) % 4L;",
        f"    const {kind} swapped = ((quarter % 2L) == 0L) ? s : c;",
        f"    const {kind} other = ((quarter % 2L) == 0L) ? c : s;",
        "    *sine = (quarter >= 2L) ? -swapped : swapped;",
        "    *cosine = ((quarter == 1L) || (quarter == 2L)) ? -other : other;",
        "}", "",
    ]  # fmt: skip


def _costs(w: _Writer) -> dict[str, int]:
    """The most operations of a call of each helper, arithmetic and comparisons."""
    made = {"root": _root, "turn": _turn}
    return {
        f"{w.name}_{name}": sum(len(re.findall(r" (?:[-+*/%<>]|>=|<=|==) ", line)) for line in make(w))
        for name, make in made.items()
        if name in w.needed
    }


def example(program: Trace, inputs: list[list[float]], number: Number) -> tuple[list[float], float]:
    """The results for these inputs in double precision, and the tolerance of a run in this precision.

    An evaluation in single precision shows how sensitive the results are to rounding; the tolerance is
    sixteen times that error, scaled to this precision.
    """
    from .engine.graph.trace import evaluate

    with np.errstate(all="ignore"):
        right = [float(x) for x in evaluate(program, [[np.float64(x) for x in y] for y in inputs], np)]
        rough = [float(x) for x in evaluate(program, [[np.float32(x) for x in y] for y in inputs], np)]
    scale = max([1.0, *(abs(x) for x in right)])
    eps: Any = np.finfo(np.float32 if number is SINGLE else np.float64).eps
    error = max([0.0, *(abs(x - y) for x, y in zip(right, rough, strict=True))]) / np.finfo(np.float32).eps
    return right, 16.0 * float(eps) * max(float(error), scale)
