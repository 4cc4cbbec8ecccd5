"""The same source in other languages: dependency-free C, and SymPy's formulas."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .call.arguments import check_robot
from .engine.graph.trace import Sym, Trace, trace
from .errors import ArgumentError
from .escape import c_comment, c_identifier, is_c_identifier
from .extras import extra
from .files import write_text
from .model import frames
from .model.robot import Robot, constants, expect_robot
from .terms import Term, flat
from .terms import term as term_named


@dataclass(frozen=True)
class CCode:
    """A term of a robot as C99.

    Attributes
    ----------
    name : str
        Of the function, and of both files without their suffixes.
    header, source : str
        The texts of `name`.h and `name`.c.
    """

    name: str
    header: str
    source: str

    def write(self, folder: str | Path) -> Path:
        """Write both files into a folder; returns the path of the source."""
        place = Path(folder)
        try:
            place.mkdir(parents=True, exist_ok=True)
            return self._write(place)
        except OSError as e:
            raise ArgumentError(f"export_c: {place} cannot be written ({e.strerror or e})") from None

    def _write(self, place: Path) -> Path:
        write_text(place / f"{self.name}.h", self.header)
        path = place / f"{self.name}.c"
        write_text(path, self.source)
        return path


def export_c(
    robot: Robot, term: str, folder: str | Path | None = None, *, name: str | None = None, dtype: Any = np.float64,
    **options: Any,
) -> CCode:  # fmt: skip
    """One term as a C99 function without dependencies but `math.h`, from the graph that is compiled here.

    It takes one configuration: an array for each input and one for the result, row by row.  It
    keeps no state and allocates nothing, so it may run on a microcontroller and on many threads.

    Parameters
    ----------
    robot : Robot
    term : str
        "rnea", "crba", "fk", "frame_pose", ...
    folder : path, optional
        Where ``name.c`` and ``name.h`` are written.
    name : str, optional
        Of the function; by default the robot's and the term's.
    dtype : float64 or float32
        ``double`` or ``float``.
    **options
        What the term takes besides arrays: ``frame=``, ``reference=``.

    Returns
    -------
    CCode
        With ``.name``, ``.header``, ``.source`` and ``.write(folder)``.

    Raises
    ------
    ArgumentError
        If there is no such term or the name is no C identifier.

    Examples
    --------
    >>> import dualpin as dp
    >>> print(dp.export_c(dp.load("ur5"), "gravity").header.splitlines()[-3])
    void ur5_gravity(const double q[6], double result[6]);
    """
    check_robot(robot, term)
    chosen = term_named(term)
    kind = {"d": "double", "f": "float"}.get(np.dtype(dtype).char)
    if kind is None:
        raise ArgumentError(f"export_c: dtype float64 or float32 expected, got {np.dtype(dtype)}")
    name = c_identifier(f"{robot.name}_{term}") if name is None else name
    if not isinstance(name, str) or not is_c_identifier(name):
        raise ArgumentError(f"export_c: {name!r} is no C identifier; {c_identifier(str(name))!r} would be one")
    settled = chosen.settled(robot, options)
    program = trace(robot, chosen, settled)
    shape = chosen.shape(robot, **settled)
    size = int(np.prod(shape, dtype=int))
    arguments = [f"const {kind} {key}[{n}]" for key, n in zip(chosen.inputs, program.sizes, strict=True)]
    signature = f"void {name}({', '.join(arguments)}, {kind} result[{size}])"
    detail = "".join(f", {key} {getattr(value, 'name', value)}" for key, value in sorted(settled.items()))
    about = c_comment(f"{term} of {robot.name}{detail}: result of shape {shape}, row by row. SI units, radians.")
    about = f"/* {about} */\n"
    guard = f"{name.upper()}_H"
    header = f"{about}#ifndef {guard}\n#define {guard}\n\n{_LINKAGE}\n{signature};\n\n#endif\n"
    body = "\n".join(c_lines(program, chosen, kind))
    source = f'{about}#include "{name}.h"\n\n#include <math.h>\n\n{signature}\n{{\n{body}\n}}\n'
    code = CCode(name, header, source)
    if folder is not None:
        code.write(folder)
    return code


_LINKAGE = '#ifdef __cplusplus\nextern "C"\n#endif'


def c_lines(program: Trace, term: Term, kind: str) -> list[str]:
    """The statements of a graph, one for each operation used; results are written last, inputs may be overwritten."""
    nodes, names = program.graph.nodes, {}
    suffix = "f" if kind == "float" else ""

    def number(x: float) -> str:
        text = repr(float(np.float32(x))) if suffix else repr(x)
        return f"{text}{suffix}"

    lines: list[str] = []
    for i in program.graph.live(program.outputs):
        op, *args = nodes[i]
        if op == "in":
            names[i] = f"{term.inputs[args[0]]}[{args[1]}]"
            continue
        if op == "const":
            names[i] = number(args[0]) if args[0] >= 0 else f"({number(args[0])})"
            continue
        a = [names[j] for j in args]
        text = {
            "+": "{0} + {1}", "-": "{0} - {1}", "*": "{0} * {1}", "inv": number(1.0) + " / {0}", "neg": "-{0}",
            "select": "{0} < {1} ? {2} : {3}",
        }.get(op, f"{op}{suffix}({{0}})")  # fmt: skip
        names[i] = f"t{len(lines)}"
        lines.append(f"    const {kind} {names[i]} = {text.format(*a)};")
    for k, x in enumerate(program.outputs):
        if type(x) is Sym and nodes[x.i][0] == "in":  # read before anything is written
            lines.append(f"    const {kind} r{k} = {names[x.i]};")
    for k, x in enumerate(program.outputs):
        copied = type(x) is Sym and nodes[x.i][0] == "in"
        value = f"r{k}" if copied else names[x.i] if type(x) is Sym else number(x)
        lines.append(f"    result[{k}] = {value};")
    unused = [key for key in term.inputs if not any(f"{key}[" in line for line in lines)]
    return [f"    (void){key};" for key in unused] + lines


def _decimals(robot: Robot, entry: Any) -> Any:
    """A formula whose fractions are decimals of up to fifteen digits, where they came from decimals.

    Of a robot whose constants are all symbols and whole numbers, only gravity can be a decimal; fractions that the
    algorithms make are halves and quarters, and stay.
    """
    sympy = extra("sympy", "exact", "symbolic")
    bare = robot.with_gravity([0, 0, 0])
    everywhere = any(isinstance(x, float) and not x.is_integer() for x in constants(bare))
    return entry.replace(
        lambda x: x.is_Rational and not x.is_Integer and (everywhere or x.q % 5 == 0),
        lambda x: sympy.Float(f"{float(x):.15g}"),
    )


def symbolic(robot: Robot, term: str, *, simplify: bool = True, decimals: bool = True, **given: Any) -> Any:
    """One term as SymPy expressions: the algorithm itself, run on symbols.  For small robots.

    Parameters
    ----------
    robot : Robot
        Its constants are numbers, or symbols as `dualpin.from_dh` and `dualpin.mechanisms.body` take them.
    term : str
        "crba", "coriolis", "gravity", "rnea", "fk", "link_terms", ...
    simplify : bool
        Whether SymPy simplifies each entry.
    decimals : bool
        Numbers that came from decimals are decimals in the result (9.81); False leaves the fractions that are
        computed with (981/100).
    **given
        Symbols for the inputs (``q=``, ``v=``, ...: a list, array or column each, also of functions of time as
        ``sympy.physics.mechanics.dynamicsymbols`` makes them; by default q0, q1, ..., real), and what the term
        takes besides arrays: ``frame=``, ``reference=``.

    Returns
    -------
    sympy.Expr, sympy.Matrix or sympy.Array
        By the number of axes: none, one (a column) or two, more.

    Raises
    ------
    ArgumentError
        If there is no such term, or symbols of the wrong number are given.
    DualpinError
        If SymPy is not installed.

    Notes
    -----
    All is computed with fractions, exactly; "link_terms" has the shape (links, nv, 2 nv + 1), the columns of
    M_i, C_i and g_i side by side.

    Examples
    --------
    >>> import dualpin as dp
    >>> from dualpin.model import Builder, revolute
    >>> from dualpin.spatial import UY, Inertia, Matrix3, ZERO_VECTOR, Vector3
    >>> b = Builder("pendulum")
    >>> J = Matrix3(ZERO_VECTOR, UY * 0.5, ZERO_VECTOR)
    >>> b.joint("hinge", revolute(UY), inertia=Inertia(2.0, Vector3(1.0, 0.0, 0.0), J))
    >>> dp.symbolic(b.robot(), "crba"), dp.symbolic(b.robot(), "gravity")
    (Matrix([[0.5]]), Matrix([[-9.81*cos(q0)]]))
    >>> dp.symbolic(b.robot(), "gravity", decimals=False)
    Matrix([[-981*cos(q0)/100]])
    """
    sympy = extra("sympy", "exact", "symbolic")

    expect_robot("symbolic", robot)
    chosen = term_named(term)
    inputs = []
    for x in chosen.arguments:
        key, size = x.name, x.size(robot)
        wanted = given.pop(key, None)
        symbols = list(sympy.symbols(f"{key}0:{size}", real=True) if wanted is None else np.ravel(wanted))
        if len(symbols) != size:
            raise ArgumentError(f"symbolic: {size} symbols for {key} expected, got {len(symbols)}")
        inputs.append(symbols)

    def fraction(x: Any) -> Any:
        return sympy.Rational(repr(float(x))) if isinstance(x, (int, float)) else x

    settled = chosen.settled(robot, given)
    exact = robot.lift(fraction)
    if "frame" in settled:
        settled["frame"] = exact.frame(frames.key(robot, settled["frame"]))
    entries = [sympy.sympify(x) for x in flat(chosen.compute(exact, *inputs, **settled))]
    if simplify:
        entries = [sympy.simplify(x) for x in entries]
    if decimals:
        entries = [_decimals(robot, x) for x in entries]
    shape = chosen.shape(robot, **settled)
    if len(shape) == 0:
        return entries[0]
    if len(shape) <= 2:
        return sympy.Matrix(shape[0], shape[1] if len(shape) == 2 else 1, entries)
    return sympy.Array(entries, shape)
