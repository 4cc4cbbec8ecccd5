"""One step of a code done wrongly: mutants of its syntax tree, of those kinds that a slip of the pen can make.

The right code is run twice, the second time in other units, with the kind of every expression noted (number, vector,
matrix, ...) and how its values grow: what stands in the place of an expression must be of the same kind and unit, so
no vector replaces a matrix, and no position a velocity.  A name is exchanged for another one of its function only
where the expressions differ in that name alone, and of all that could stand at one place one is drawn.  What is left
out of a product is a number, or a matrix without unit, such as a rotation.

References: DeMillo, Lipton and Sayward, Hints on Test Data Selection (Computer, 1978); Offutt et al., An Experimental
Determination of Sufficient Mutant Operators (ACM TOSEM, 1996).
"""

from __future__ import annotations

import ast
import copy
import random
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

READS = (ast.Name, ast.Subscript, ast.Attribute)
NOTED = (*READS, ast.BinOp, ast.UnaryOp, ast.Call)
TINY = 1e-9  # below which a value says nothing of its unit
VALUES = 64  # of an expression that are compared between units
Kind = tuple[Any, ...]
TURNS = {"sin": "cos", "cos": "sin"}


@dataclass(frozen=True)
class Mutant:
    """One change: in which function, by which operator, of what into what."""

    where: str
    operator: str
    old: str
    new: str
    number: int
    node: ast.AST

    def __str__(self) -> str:
        return f"{self.where}: {self.operator}: {self.old}  ->  {self.new}"


class Source:
    """The text of a code, whose switches for mistakes (`"name" in self.mistakes`) are off, and what runs of it saw."""

    def __init__(self, text: str, class_name: str = "Code") -> None:
        self.class_name = class_name
        self.tree = ast.fix_missing_locations(_Switches().visit(ast.parse(text)))
        for number, node in enumerate(ast.walk(self.tree)):
            node.number = number  # type: ignore[attr-defined]
        self.kinds: dict[int, set[Kind]] = {}
        self.values: list[dict[int, list[np.ndarray]]] = []

    def right(self) -> Any:
        """The class without mistakes."""
        return self._built(self.tree)

    def noting(self) -> Any:
        """The class without mistakes, which notes kind and values of every expression that it computes."""
        seen: dict[int, list[np.ndarray]] = {}
        self.values.append(seen)

        def note(number: int, x: Any) -> Any:
            if not (callable(x) or isinstance(x, ModuleType)):
                kind = _kind(x)
                self.kinds.setdefault(number, set()).add(kind)
                if kind[0] == "array" and np.any(x) and len(seen.setdefault(number, [])) < VALUES:
                    seen[number].append(np.array(x, dtype=float))
            return x

        return self._built(_Noted().visit(copy.deepcopy(self.tree)), note)

    def mutated(self, mutant: Mutant) -> Any:
        """The class with one mistake."""
        return self._built(_Replaced(mutant).visit(copy.deepcopy(self.tree)))

    def growth(self, number: int) -> np.ndarray | None:
        """How an expression grows with units, entry by entry; not-a-number where nothing says it, or not one thing."""
        here, there = (seen.get(number, []) for seen in self.values[:2])
        if len({x.shape for x in (*here, *there)}) != 1 or len(here) != len(there):
            return None
        with np.errstate(all="ignore"):
            ratio = np.array([np.where(np.abs(a) > TINY, b / a, np.nan) for a, b in zip(here, there, strict=True)])
        known = ~np.isnan(ratio)
        first = np.take_along_axis(ratio, known.argmax(axis=0)[None], axis=0)
        return np.where((np.abs(ratio - first) <= 1e-6 * np.abs(first)) | ~known, first, np.nan).max(axis=0)

    def mutants(self, rng: random.Random) -> list[Mutant]:
        """All of them, once `noting` has run in both units, in an order that is drawn; of other names one each."""
        found: dict[tuple[int, str, str], list[Mutant]] = {}
        for where, function in _functions(self.tree):
            for operator, node, new in _changes(function, self):
                made = Mutant(where, operator, _text(node), _text(new), _number(node), new)
                one_of = "" if operator == "another" else made.new
                if made.old != made.new:
                    found.setdefault((made.number, operator, one_of), []).append(made)
        drawn = [rng.choice(some) for some in found.values()]
        rng.shuffle(drawn)
        return drawn

    def _built(self, tree: ast.Module, note: Callable[[int, Any], Any] | None = None) -> Any:
        module = ModuleType("mutant")
        sys.modules[module.__name__] = module  # dataclasses look for their module
        module.__dict__["_note"] = note
        exec(compile(ast.fix_missing_locations(tree), "mutant", "exec"), module.__dict__)
        return module.__dict__[self.class_name]


def _kind(x: Any) -> Kind:
    """What an expression must have in common with what stands in its place."""
    if isinstance(x, (bool, int, np.integer, str)):
        return (type(x).__name__,)
    if isinstance(x, (float, list, tuple, np.ndarray)):
        try:
            return "array", np.asarray(x, dtype=float).shape
        except (TypeError, ValueError):
            return type(x).__name__, len(x) if isinstance(x, (list, tuple)) else 0
    return (type(x).__name__,)


def _changes(function: ast.FunctionDef, source: Source) -> Iterator[tuple[str, ast.AST, ast.AST]]:
    """(operator, what is replaced, what replaces it) for every step of a function."""
    kinds = source.kinds
    names = [n for n in _inside(function) if isinstance(n, READS) and kinds.get(_number(n))]

    def same(a: ast.AST, b: ast.AST) -> bool:
        """Whether runs saw the same kinds of both, and no other unit."""
        one, other = (kinds.get(_number(x)) for x in (a, b))
        if not one or one != other:
            return False
        grows = [g for x in (a, b) if (g := source.growth(_number(x))) is not None]
        return len(grows) < 2 or not (np.abs(grows[0] - grows[1]) > 1e-6 * np.abs(grows[0])).any()

    def number(a: ast.AST) -> bool:
        return isinstance(a, ast.Constant) or kinds.get(_number(a)) in ({("array", ())}, {("int",)})

    def square(a: ast.AST) -> bool:
        return all(k[0] == "array" and len(k[1]) == 2 and k[1][0] == k[1][1] for k in kinds.get(_number(a), {(0,)}))

    for n in _inside(function):
        if isinstance(n, ast.BinOp):
            yield from _of_operands(n, same, square, number)
        elif isinstance(n, ast.Call) and _text(n.func).split(".")[-1] == "cross" and len(n.args) == 2:
            yield "order", n, ast.Call(n.func, n.args[::-1], n.keywords)
        elif isinstance(n, ast.Call) and isinstance(n.func, ast.Attribute) and n.func.attr in TURNS:
            yield "sine", n, ast.Call(ast.Attribute(n.func.value, TURNS[n.func.attr], n.func.ctx), n.args, n.keywords)
        elif isinstance(n, ast.AugAssign):
            yield "not added", n, ast.Assign([n.target], n.value)
            yield "left out", n, ast.Pass()
        elif isinstance(n, ast.UnaryOp) and isinstance(n.op, ast.USub):
            yield "sign", n, n.operand
        elif isinstance(n, (ast.If, ast.IfExp)):
            for taken in (True, False):
                other = copy.copy(n)
                other.test = ast.Constant(taken)
                yield "case", n, other
        elif isinstance(n, ast.For):
            for rest in ("[1:]", "[:-1]"):
                fewer = ast.parse(f"list({_text(n.iter)}){rest}", mode="eval").body
                yield "one fewer", n.iter, fewer
        if isinstance(n, ast.Attribute) and n.attr == "T" and same(n, n.value):
            yield "transposed", n, n.value
        if isinstance(n, READS) and kinds.get(_number(n)):
            yield from (("another", n, x) for x in names if same(n, x) and _one_name(_text(n), _text(x)))


def _of_operands(
    n: ast.BinOp,
    same: Callable[[ast.AST, ast.AST], bool],
    square: Callable[[ast.AST], bool],
    number: Callable[[ast.AST], bool],
) -> Iterator[tuple[str, ast.AST, ast.AST]]:
    """Of a sum, a difference or a product."""
    left, right = n.left, n.right
    if isinstance(n.op, (ast.Add, ast.Sub)):
        adds = isinstance(n.op, ast.Add)
        yield "sign", n, ast.BinOp(left, ast.Sub() if adds else ast.Add(), right)
        if same(n, left):
            yield "left out", n, left
        if same(n, right):
            yield "left out", n, right if adds else ast.UnaryOp(ast.USub(), right)
    if isinstance(n.op, (ast.Mult, ast.MatMult, ast.Div)):
        if same(n, left) or number(right):
            yield "left out", n, left
        if not isinstance(n.op, ast.Div) and (same(n, right) or number(left)):
            yield "left out", n, right
    if isinstance(n.op, ast.MatMult):
        if same(left, right):
            yield "order", n, ast.BinOp(right, ast.MatMult(), left)
            yield "by elements", n, ast.BinOp(left, ast.Mult(), right)
        for side in (left, right):
            if square(side) and not (isinstance(side, ast.Attribute) and side.attr == "T"):
                other = ast.Attribute(side, "T", ast.Load())
                yield "transposed", n, ast.BinOp(*((other, n.op, right) if side is left else (left, n.op, other)))


def _one_name(a: str, b: str) -> bool:
    """Whether two expressions differ in one name or number."""
    one, other = (re.findall(r"\w+|\W", x) for x in (a, b))
    return len(one) == len(other) and sum(x != y for x, y in zip(one, other, strict=True)) == 1


def _functions(tree: ast.AST, inside: str = "") -> Iterator[tuple[str, ast.FunctionDef]]:
    for n in ast.iter_child_nodes(tree):
        if isinstance(n, ast.FunctionDef):
            yield inside + n.name, n
        elif isinstance(n, ast.ClassDef):
            yield from _functions(n, f"{n.name}.")


def _inside(function: ast.FunctionDef) -> list[ast.AST]:
    return [n for statement in function.body for n in ast.walk(statement)]


def _number(node: ast.AST) -> int:
    """Which node of the right code it is."""
    return getattr(node, "number", -1)


def _text(node: ast.AST) -> str:
    if isinstance(node, ast.If):
        return f"if {_text(node.test)}"
    return ast.unparse(ast.fix_missing_locations(copy.copy(node)))


class _Noted(ast.NodeTransformer):
    """Every expression that is read inside a function passes `_note`."""

    def visit_FunctionDef(self, n: ast.FunctionDef) -> ast.AST:
        n.body = [_Each().visit(statement) for statement in n.body]
        return n


class _Each(ast.NodeTransformer):
    def generic_visit(self, n: ast.AST) -> ast.AST:
        super().generic_visit(n)
        if isinstance(n, NOTED) and isinstance(getattr(n, "ctx", ast.Load()), ast.Load):
            number = ast.Constant(_number(n))
            return ast.copy_location(ast.Call(ast.Name("_note", ast.Load()), [number, n], []), n)
        return n


class _Replaced(ast.NodeTransformer):
    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant

    def visit(self, n: ast.AST) -> Any:
        if _number(n) == self.mutant.number:
            return ast.copy_location(copy.deepcopy(self.mutant.node), n)
        return self.generic_visit(n)


class _Switches(ast.NodeTransformer):
    """Cases that a planted mistake switches on are left out."""

    def visit_Compare(self, n: ast.Compare) -> ast.AST:
        if isinstance(n.left, ast.Constant) and _text(n.comparators[0]) == "self.mistakes":
            return ast.Constant(isinstance(n.ops[0], ast.NotIn))
        return self.generic_visit(n)

    def visit_BoolOp(self, n: ast.BoolOp) -> ast.AST:
        self.generic_visit(n)
        neutral = isinstance(n.op, ast.And)
        values = [x for x in n.values if not (isinstance(x, ast.Constant) and x.value is neutral)]
        decided = [x for x in values if isinstance(x, ast.Constant) and x.value is (not neutral)]
        if decided or not values:
            return ast.Constant(neutral != bool(decided))
        return values[0] if len(values) == 1 else ast.BoolOp(n.op, values)

    def visit_If(self, n: ast.If) -> Any:
        self.generic_visit(n)
        if isinstance(n.test, ast.Constant):
            return n.body if n.test.value else n.orelse or ast.Pass()
        return n

    def visit_IfExp(self, n: ast.IfExp) -> ast.AST:
        self.generic_visit(n)
        if isinstance(n.test, ast.Constant):
            return n.body if n.test.value else n.orelse
        return n
