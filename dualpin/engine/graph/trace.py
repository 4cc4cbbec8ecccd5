"""Expression graphs: the algorithms run on symbols, which record the operations.

A `Sym` is a scalar, so algorithms run on it unchanged.  Each operation becomes a node of a `Graph`, once: equal
operations are the same node (hash-consing), exact zeros and ones are eliminated, constants are folded, signs move
outwards.  The result is the straight-line program of one term of one robot.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from types import SimpleNamespace
from typing import Any

from ...errors import DualpinError
from ...model.robot import Robot
from ...scalars import ONE, ZERO, Exact, _stumpff_closed, _stumpff_series, register
from ...terms import Options, Term, flat
from .. import tuning

Node = tuple
"""(operation, *operands): operands are indices of nodes, except those of "in" and "const"."""

ARITHMETIC = ("+", "-", "*", "inv", "neg", "sqrt", "select")
"""Operations of chunks."""

LEAVES, TRIGONOMETRIC = ("in", "const"), ("sin", "cos")
"""Nodes without operands: loaded, or constant; and those that a loop computes."""


class UntraceableError(DualpinError):
    """An algorithm branches on a value: it is not a straight-line program, so it cannot be compiled."""


class Graph:
    """Nodes in the order of their creation; operands precede their uses.

    "in" (array, position)   "const" (value)   "+" "-" "*" (a, b)   "inv" "neg" "sqrt" "sin" "cos" (a)
    "select" (x, y, a, b): a where x < y, else b
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.index: dict[Node, int] = {}

    def node(self, *key: Any) -> int:
        nodes = self.nodes
        new = len(nodes)
        i = self.index.setdefault(key, new)
        if i == new:
            if new > tuning.LARGEST_GRAPH:
                raise UntraceableError(f"more than {tuning.LARGEST_GRAPH} operations: too long to be compiled")
            nodes.append(key)
        return i

    def known(self, *key: Any) -> int | None:
        """The node, if it exists."""
        return self.index.get(key)

    def inputs(self, array: int, size: int) -> list[Sym]:
        """The symbols of one input array."""
        return [Sym(self, self.node("in", array, i)) for i in range(size)]

    def constant(self, x: float) -> Sym:
        return Sym(self, self.node("const", float(x)))

    def live(self, outputs: Iterable[Any]) -> list[int]:
        """Nodes the outputs depend on, each after its operands, depth first; see `walk`."""
        return self.walk(outputs)[0]

    def walk(self, outputs: Iterable[Any]) -> tuple[list[int], list[int]]:
        """The order of the nodes that the outputs depend on, and how often each node is used, by them and as an output.

        Each comes after its operands, depth first, since a value computed just before its use seldom has to be stored:
        where the source traverses the whole tree outwards and then inwards, this order finishes one subtree at a time.
        """
        nodes, order = self.nodes, list[int]()
        uses, done = [0] * len(nodes), bytearray(len(nodes))
        for out in outputs:
            if type(out) is not Sym:
                continue
            uses[out.i] += 1
            stack = [] if done[out.i] else [out.i]
            while stack:
                i = stack.pop()
                if i < 0:  # its operands are done
                    order.append(~i)
                    continue
                if done[i]:
                    continue
                done[i] = 1
                node = nodes[i]
                if node[0] in LEAVES:
                    order.append(i)
                elif len(node) == 3:  # nearly all, so without a loop
                    _, a, b = node
                    uses[a] += 1
                    uses[b] += 1
                    if done[a] and done[b]:
                        order.append(i)
                    else:
                        stack += (~i, b, a)
                else:
                    stack.append(~i)
                    for a in node[:0:-1]:
                        uses[a] += 1
                        stack.append(a)
        return order, uses

    def count(self, outputs: Iterable[Any]) -> dict[str, int]:
        """The number of each operation that the outputs need; "flops" is the sum of + - * inv."""
        total: dict[str, int] = {}
        for i in self.live(outputs):
            op = self.nodes[i][0]
            total[op] = total.get(op, 0) + 1
        total["flops"] = sum(total.get(op, 0) for op in ("+", "-", "*", "inv"))
        return total


class Sym:
    """A scalar that remembers how it was computed: node `i` of a graph; `positive` is x if this is -x."""

    __slots__ = ("graph", "i", "positive")
    __array_ufunc__ = None

    def __init__(self, graph: Graph, i: int, positive: Sym | None = None) -> None:
        self.graph, self.i, self.positive = graph, i, positive

    def __repr__(self) -> str:
        return f"<{self.graph.nodes[self.i][0]} {self.i}>"

    @property
    def real(self) -> Sym:
        return self

    def _new(self, *key: Any) -> Sym:
        return Sym(self.graph, self.graph.node(*key))

    def __neg__(self) -> Any:
        if self.positive is not None:
            return self.positive
        graph, i = self.graph, self.i
        node = graph.nodes[i]
        if node[0] == "-":
            return Sym(graph, graph.node("-", node[2], node[1]))
        return Sym(graph, graph.node("neg", i), self)

    def __add__(self, b: Any) -> Any:
        if type(b) is not Sym:
            return self if b is ZERO else self._with_constant(b, "+")
        if b.positive is not None:
            return self - b.positive
        if self.positive is not None:
            return b - self.positive
        graph, i, j = self.graph, self.i, b.i
        if i == j:
            return self * 2.0
        return Sym(graph, graph.node("+", i, j) if i < j else graph.node("+", j, i))

    def __sub__(self, b: Any) -> Any:
        if type(b) is not Sym:
            return self if b is ZERO else self._with_constant(b, "-")
        graph, i, j = self.graph, self.i, b.i
        if i == j:
            return 0.0
        if b.positive is not None:
            return self + b.positive
        if self.positive is not None:
            return -(self.positive + b)
        index = graph.index
        if ("-", i, j) not in index:
            opposite = index.get(("-", j, i))
            if opposite is not None:
                return Sym(graph, graph.node("neg", opposite), Sym(graph, opposite))
        return Sym(graph, graph.node("-", i, j))

    def __rsub__(self, b: Any) -> Any:
        return -self + b

    def _with_constant(self, b: Any, op: str) -> Any:
        c = _number(b)
        if c is None:
            return NotImplemented
        if c == 0:
            return self
        x = self.positive
        if x is not None:  # c - x, and -x - c = -(x + c)
            return self.graph.constant(c) - x if op == "+" else -(x + c)
        return self + self.graph.constant(c) if op == "+" else self - self.graph.constant(c)

    def __mul__(self, b: Any) -> Any:
        if type(b) is not Sym:
            return 0.0 if b is ZERO else self if b is ONE else self._scaled(b)
        if self.positive is not None:
            return -(self.positive * b)
        if b.positive is not None:
            return -(self * b.positive)
        graph, i, j = self.graph, self.i, b.i
        return Sym(graph, graph.node("*", i, j) if i < j else graph.node("*", j, i))

    def _scaled(self, b: Any) -> Any:
        c = _number(b)
        if c is None:
            return NotImplemented
        if c == 0:
            return 0.0
        if c < 0:
            return -self._scaled(-c)
        if c == 1:
            return self
        if self.positive is not None:
            return -self.positive._scaled(c)
        graph = self.graph
        node = graph.nodes[self.i]
        if node[0] == "*" and graph.nodes[node[1]][0] == "const":  # c (d x) = (c d) x
            return Sym(graph, node[2])._scaled(c * graph.nodes[node[1]][1])
        # the constant's node first, so that the line above finds it
        return Sym(graph, graph.node("*", graph.node("const", c), self.i))

    def __truediv__(self, b: Any) -> Any:
        if type(b) is Sym:  # one reciprocal for all divisions by b
            x = b.positive
            return self * b._new("inv", b.i) if x is None else -(self / x)
        c = _number(b)
        if c is None:
            return NotImplemented
        # an exact zero gives inf or nan, as for arrays
        return self * (1.0 / c if c else math.copysign(math.inf, c))

    def __rtruediv__(self, b: Any) -> Any:
        c = _number(b)
        if c is None:
            return NotImplemented
        x = self.positive
        return -(c / x) if x is not None else self._new("inv", self.i) * c

    def __pow__(self, n: int) -> Any:
        if not isinstance(n, int) or n < 1:
            return NotImplemented
        return self if n == 1 else self * self ** (n - 1)

    __radd__, __rmul__ = __add__, __mul__

    def __lt__(self, b: Any) -> Choice:
        return Choice(self, b)

    def __gt__(self, b: Any) -> Choice:
        return Choice(b, self)

    def _undecided(self, *_: Any) -> bool:
        raise UntraceableError("a comparison of symbols has no answer: this term chooses its way by its numbers")

    __bool__ = __le__ = __ge__ = _undecided


class Choice:
    """x < y between symbols: it has no truth value, but `dualpin.dual.where` can select by it."""

    def __init__(self, x: Any, y: Any) -> None:
        self.x, self.y = x, y

    def choose(self, a: Any, b: Any) -> Any:
        """a where x < y, else b."""
        return select(self.x, self.y, a, b)

    __bool__ = Sym._undecided


def _number(x: Any) -> float | None:
    kind = type(x)
    if kind is float or kind is int:
        return x
    if kind is Exact:
        return float(x.n)
    return float(x) if isinstance(x, float) else None


# --- elementary functions of symbols -------------------------------------------------------------


def select(x: Any, y: Any, a: Any, b: Any) -> Any:
    """a where x < y, else b."""
    graph = next(s.graph for s in (x, y, a, b) if type(s) is Sym)
    args = (s if type(s) is Sym else graph.constant(float(s)) for s in (x, y, a, b))
    return Sym(graph, graph.node("select", *(s.i for s in args)))


def _stumpff(k: int, y: Sym) -> Any:
    near, far = select(y, 1.0, y, 0.0), select(y, 1.0, 1.0, y)
    return select(y, 1.0, _stumpff_series(k, near), _stumpff_closed(k, far, LIBRARY))


HALVINGS, ODD_TERMS = 3, 13  # tan of an eighth of the angle is below 0.2, and 0.2^26 / 27 below 1e-19


def _atan2(y: Any, x: Any) -> Any:
    """The angle of (x, y) by halving it, tan(a / 2) = t / (1 + sqrt(1 + t^2)), and Gregory's series.

    Good to 4 eps where x^2 + y^2 neither overflows nor underflows; 0 at the origin.
    """
    length = LIBRARY.sqrt(x * x + y * y)
    across = length + select(x, 0.0, -x, x)
    t = y / select(0.0, across, across, 1.0)
    for _ in range(HALVINGS - 1):
        t = t / (1.0 + LIBRARY.sqrt(1.0 + t * t))
    s, total = t * t, 0.0
    for i in range(ODD_TERMS, -1, -1):
        total = 1.0 / (2 * i + 1) - s * total
    angle = t * total * 2.0**HALVINGS
    return select(x, 0.0, select(y, 0.0, -math.pi, math.pi) - angle, angle)


class _Library(SimpleNamespace):
    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise UntraceableError(f"{name} of a symbol cannot be compiled")


LIBRARY = _Library(
    sin=lambda x: x._new("sin", x.i), cos=lambda x: x._new("cos", x.i), sqrt=lambda x: x._new("sqrt", x.i),
    stumpff=_stumpff, atan2=_atan2,
)  # fmt: skip
register(Sym, LIBRARY)


# --- a term of a robot ----------------------------------------------------------------------------


class Trace:
    """The straight-line program of one term: its graph, the sizes of its inputs, and its outputs.

    Attributes
    ----------
    outputs : list
        Symbols, or plain numbers where the result does not depend on the inputs.
    """

    def __init__(self, graph: Graph, sizes: Sequence[int], outputs: Sequence[Any]) -> None:
        self.graph, self.sizes = graph, list(sizes)
        self.outputs: list[Any] = [x if type(x) is Sym else float(x) + 0.0 for x in outputs]  # no -0

    @cached_property
    def walked(self) -> tuple[list[int], list[int]]:
        """The order of its nodes and the number of their uses; see `Graph.walk`."""
        return self.graph.walk(self.outputs)

    @property
    def flops(self) -> int:
        return self.graph.count(self.outputs)["flops"]


def trace(robot: Robot, term: Term, options: Options) -> Trace:
    """The term, run on symbols.

    Raises
    ------
    UntraceableError
        If the term branches on a value.
    """
    for x in (x for j in robot for x in (*robot.gravity, *j.inertia.parameters, *j.placement.position)):
        if _number(x) is None:
            raise UntraceableError(f"the constants of {robot.name} are {type(x).__name__}, which cannot be compiled")
    graph, sizes = Graph(), term.sizes(robot)
    symbols = [graph.inputs(k, n) for k, n in enumerate(sizes)]
    outputs = list(flat(term.compute(robot, *symbols, **options)))
    return Trace(graph, sizes, outputs)


def evaluate(program: Trace, inputs: Sequence[Sequence[Any]], functions: Any = math) -> list[Any]:
    """Evaluate a graph for given inputs, node by node, in the arithmetic of the inputs."""
    nodes, value = program.graph.nodes, {}
    for i in program.walked[0]:
        op, *args = nodes[i]
        if op == "in":
            value[i] = inputs[args[0]][args[1]]
        elif op == "const":
            value[i] = args[0]
        elif op == "select":
            x, y, a, b = (value[j] for j in args)
            value[i] = a if x < y else b
        else:
            value[i] = _MEANING[op](functions, *(value[j] for j in args))
    return [value[x.i] if type(x) is Sym else x for x in program.outputs]


_MEANING: dict[str, Any] = {
    "+": lambda _, a, b: a + b,
    "-": lambda _, a, b: a - b,
    "*": lambda _, a, b: a * b,
    "inv": lambda _, a: 1 / a,
    "neg": lambda _, a: -a,
    "sqrt": lambda f, a: f.sqrt(a),
    "sin": lambda f, a: f.sin(a),
    "cos": lambda f, a: f.cos(a),
}
