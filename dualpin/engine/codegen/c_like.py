"""A writer of LLVM IR whose calls read like C: expressions, `if_`, `for_`, early returns.

Values are assigned once: a loop has its counter, and a value that depends on a condition is selected.  So the code is
in SSA form, without a pass for it.

    with c.for_(n) as k:                  for (k = 0; k < n; k++)
        with c.if_(p.item("i64", k) < 0):     if (((int64_t *)p)[k] < 0)
            c.returns(c.null)                     return NULL;
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

_INTEGERS = {"+": "add", "-": "sub", "*": "mul", "&": "and", "|": "or", ">>": "lshr"}
_FLOATS = {"+": "fadd", "-": "fsub", "*": "fmul"}
_COMPARISONS = {
    "==": ("icmp eq", "fcmp oeq"), "!=": ("icmp ne", "fcmp une"), "<": ("icmp slt", "fcmp olt"),
    "<=": ("icmp sle", "fcmp ole"), ">": ("icmp sgt", "fcmp ogt"), ">=": ("icmp sge", "fcmp oge"),
}  # fmt: skip


class Value:
    """The result of an expression: its name and type in the IR."""

    def __init__(self, c: Writer, name: str, kind: str) -> None:
        self.c, self.name, self.type = c, name, kind

    def _with(self, op: str, b: Any) -> Value:
        floating = self.type in ("float", "double")
        other = b.name if isinstance(b, Value) else str(b)
        if op in _COMPARISONS:
            return self.c.value(f"{_COMPARISONS[op][floating]} {self.type} {self.name}, {other}", "i1")
        return self.c.value(f"{(_FLOATS if floating else _INTEGERS)[op]} {self.type} {self.name}, {other}", self.type)

    def __add__(self, b: Any) -> Value:
        return self._with("+", b)

    def __sub__(self, b: Any) -> Value:
        return self._with("-", b)

    def __mul__(self, b: Any) -> Value:
        return self._with("*", b)

    def __and__(self, b: Any) -> Value:
        return self._with("&", b)

    def __or__(self, b: Any) -> Value:
        return self._with("|", b)

    def __rshift__(self, b: Any) -> Value:
        return self._with(">>", b)

    def __lt__(self, b: Any) -> Value:
        return self._with("<", b)

    def __le__(self, b: Any) -> Value:
        return self._with("<=", b)

    def __gt__(self, b: Any) -> Value:
        return self._with(">", b)

    def __ge__(self, b: Any) -> Value:
        return self._with(">=", b)

    def __eq__(self, b: Any) -> Value:  # type: ignore[override]
        return self._with("==", b)

    def __ne__(self, b: Any) -> Value:  # type: ignore[override]
        return self._with("!=", b)

    __hash__ = None  # type: ignore[assignment]

    def to(self, how: str, kind: str) -> Value:
        """A conversion: "sext", "zext", "fpext", "ptrtoint", "inttoptr"."""
        return self.c.value(f"{how} {self.type} {self.name} to {kind}", kind)

    def at(self, kind: str, i: Any) -> Value:
        """&((kind *)this)[i]"""
        index = i.name if isinstance(i, Value) else i
        return self.c.value(f"getelementptr {kind}, ptr {self.name}, i64 {index}", "ptr")

    def item(self, kind: str, i: Any = 0, how: str = "") -> Value:
        """((kind *)this)[i]"""
        return self.c.value(f"load{how and ' atomic'} {kind}, ptr {self.at(kind, i).name}{how}", kind)


class Record:
    """A pointer to a struct; reading an attribute loads the field of that name."""

    def __init__(self, pointer: Value, fields: Mapping[str, str]) -> None:
        self._pointer, self._fields = pointer, fields

    def __getattr__(self, name: str) -> Value:
        fields, p = self._fields, self._pointer
        place = f"getelementptr {struct(fields)}, ptr {p.name}, i32 0, i32 {list(fields).index(name)}"
        return p.c.value(f"load {fields[name]}, ptr {p.c.value(place, 'ptr').name}", fields[name])


def struct(fields: Mapping[str, str]) -> str:
    return f"{{{', '.join(fields.values())}}}"


class Writer:
    """The lines of one function."""

    def __init__(self, head: str, **parameters: str) -> None:
        self.lines, self._numbers = [f"define {head.replace('()', self._list(parameters))} {{"], itertools.count(1)
        self.parameters = [Value(self, f"%{name}", kind) for name, kind in parameters.items()]
        self.null, self.open = Value(self, "null", "ptr"), True
        self._start("entry")

    @staticmethod
    def _list(parameters: Mapping[str, str]) -> str:
        return "(" + ", ".join(f"{kind} %{name}" for name, kind in parameters.items()) + ")"

    @property
    def text(self) -> str:
        return "\n".join([*self.lines, "}\n"])

    def _do(self, text: str) -> None:
        self.lines.append(f"  {text}")

    def _start(self, label: str) -> None:
        self.lines.append(f"{label}:")
        self.block, self.open = label, True

    def _labels(self, *names: str) -> list[str]:
        n = next(self._numbers)
        return [f"{name}{n}" for name in names]

    def _jump(self, label: str) -> None:
        if self.open:
            self._do(f"br label %{label}")
        self.open = False

    def value(self, text: str, kind: str) -> Value:
        name = f"%t{next(self._numbers)}"
        self._do(f"{name} = {text}")
        return Value(self, name, kind)

    def number(self, x: int | float, kind: str = "i64") -> Value:
        return Value(self, str(x), kind)

    def call(self, function: str | Value, *arguments: Value, gives: str = "void") -> Value:
        """A call and its result."""
        name = function.name if isinstance(function, Value) else f"@{function}"
        text = f"call {gives} {name}({', '.join(f'{x.type} {x.name}' for x in arguments)})"
        if gives != "void":
            return self.value(text, gives)
        self._do(text)
        return self.null

    def room(self, kind: str, count: int | Value = 1, align: int = 16) -> Value:
        """Memory on the stack."""
        n = count.name if isinstance(count, Value) else count
        return self.value(f"alloca {kind}, i64 {n}, align {align}", "ptr")

    def store(self, x: Value, place: Value) -> None:
        self._do(f"store {x.type} {x.name}, ptr {place.name}")

    def returns(self, x: Value | None = None) -> None:
        self._do("ret void" if x is None else f"ret {x.type} {x.name}")
        self.open = False

    @contextmanager
    def if_(self, condition: Value) -> Iterator[None]:
        then, after = self._labels("then", "after")
        self._do(f"br i1 {condition.name}, label %{then}, label %{after}")
        self._start(then)
        yield
        self._jump(after)
        self._start(after)

    def choose(self, condition: Value, yes: Callable[[], Value], no: Callable[[], Value]) -> Value:
        """condition ? yes() : no(); only one of them is evaluated."""
        then, other, after = self._labels("then", "else", "after")
        self._do(f"br i1 {condition.name}, label %{then}, label %{other}")
        ends = []
        for label, make in ((then, yes), (other, no)):
            self._start(label)
            x = make()
            if self.open:
                ends.append((x, self.block))
            self._jump(after)
        self._start(after)
        kind = ends[0][0].type
        return self.value(f"phi {kind} " + ", ".join(f"[{x.name}, %{block}]" for x, block in ends), kind)

    @contextmanager
    def for_(self, count: Value) -> Iterator[Value]:
        """A loop with the counter 0, 1, ... below count."""
        before, (head, body, after) = self.block, self._labels("head", "body", "after")
        self._jump(head)
        self._start(head)
        phi = len(self.lines)
        k = self.value("", "i64")
        more = k < count
        self._do(f"br i1 {more.name}, label %{body}, label %{after}")
        self._start(body)
        yield k
        again = k + 1
        self.lines[phi] = f"  {k.name} = phi i64 [0, %{before}], [{again.name}, %{self.block}]"
        self._jump(head)
        self._start(after)
