"""Export of terms: C without dependencies, and SymPy expressions."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import c_code
from .arguments import choice
from .call.arguments import check_robot
from .engine.codegen.number import DOUBLE, SINGLE, Number
from .engine.graph.trace import Trace, trace
from .errors import ArgumentError, DualpinWarning
from .escape import c_comment, c_identifier, is_c_identifier, line
from .extras import extra
from .files import write_text, writing
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
        Name of the function, and of the files without their suffixes.
    header, source : str
        The texts of `name`.h and `name`.c.
    test : str
        The text of `name`_test.c: a program that computes one example and returns 0 if the result is right.
    operations : dict
        How many of each kind a call does, always the same.
    stack : int
        Bytes of the stack that a call takes, at most.
    """

    name: str
    header: str
    source: str
    test: str = ""
    operations: Mapping[str, int] = field(default_factory=dict)
    stack: int = 0

    def write(self, folder: str | Path) -> Path:
        """Write the files, and a Makefile for all in the folder; returns the path of the source."""
        place = Path(folder)
        with writing(f"export_c: {place} cannot be written"):
            place.mkdir(parents=True, exist_ok=True)
            return self._write(place)

    def _write(self, place: Path) -> Path:
        path, makefile = place / f"{self.name}.c", place / "Makefile"
        for file, first in ((path, self.source), (path.with_suffix(".h"), self.header)):
            if file.exists() and _begin(file.read_text(errors="replace")) != _begin(first):
                raise ArgumentError(
                    f"export_c: {file} is something else ({_begin(file.read_text(errors='replace'))!r}) and is kept; "
                    "name= gives this function another name"
                )
        write_text(place / f"{self.name}.h", self.header)
        write_text(place / f"{self.name}_test.c", self.test)
        if makefile.exists() and _begin(makefile.read_text(errors="replace")) != _begin(MAKEFILE):
            warnings.warn(f"export_c: {makefile} is not ours and is kept as it is", DualpinWarning, stacklevel=4)
        else:
            write_text(makefile, MAKEFILE)
        write_text(path, self.source)
        return path


def _begin(text: str) -> str:
    """The first line, which says what a file is of."""
    return line(text.partition("\n")[0])[:100]


MAKEFILE = """# make check                                  build all and run the examples
# make check CC=arm-linux-gnueabihf-gcc LDFLAGS=-static RUN=qemu-arm
# make stack                                  what each function takes of the stack (GCC)
CFLAGS ?= -O2
WARNINGS = -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Werror
TESTS := $(patsubst %.c,%,$(wildcard *_test.c))

all: $(TESTS)

%_test: %_test.c %.c %.h
\t$(CC) $(WARNINGS) $(CFLAGS) $*_test.c $*.c $(LDFLAGS) -o $@ -lm

check: $(TESTS)
\t@for test in $(TESTS); do $(RUN) ./$$test || exit 1; done

stack:
\t@for file in $(TESTS:_test=); do \\
\t  $(CC) $(WARNINGS) $(CFLAGS) -fstack-usage -c $$file.c -o $$file.o && cat $$file.su || exit 1; \\
\tdone

clean:
\trm -f $(TESTS) *.o *.su

.PHONY: all check stack clean
"""


def export_c(
    robot: Robot, term: str, folder: str | Path | None = None, *, name: str | None = None, dtype: Any = np.float64,
    math: str = "libm", **options: Any,
) -> CCode:  # fmt: skip
    """One term as a C99 function, from the graph that is compiled here.

    It takes one configuration: an array for each input and one for the result, row by row.  It keeps no
    state, allocates nothing and does the same number of operations whatever it is given, so it may run
    on a microcontroller, in an interrupt and on many threads.  Of libraries it calls `sin` and `cos`, or
    none at all.  The header says how many operations a call does and how much of the stack it takes.

    Parameters
    ----------
    robot : Robot
    term : str
        "rnea", "crba", "fk", "frame_pose", ...
    folder : path, optional
        Where ``name.c`` and ``name.h`` are written, ``name_test.c``, which computes an example, and a
        ``Makefile`` for it: ``make check``.
    name : str, optional
        Of the function; by default the robot's and the term's.
    dtype : float64 or float32
        ``double`` or ``float``.
    math : "libm" or "own"
        Whether sines and cosines are those of ``math.h`` or polynomials of its own: good to 2 ulp for angles
        up to 1e8 rad (1e3 in single precision), beyond that no number.
    **options
        What the term takes besides arrays: ``frame=``, ``reference=``.

    Returns
    -------
    CCode
        With ``.name``, ``.header``, ``.source``, ``.test``, ``.operations``, ``.stack`` and ``.write(folder)``.

    Raises
    ------
    ArgumentError
        If there is no such term, the name is no C identifier, or the folder has files of that name of something else.

    Examples
    --------
    >>> import dualpin as dp
    >>> code = dp.export_c(dp.load("ur5"), "gravity")
    >>> print(code.header.splitlines()[-3])
    void ur5_gravity(const double q[6], double result[6]);
    >>> code.operations["multiplications"] < 100, code.stack < 2048
    (True, True)
    """
    check_robot(robot, term)
    chosen = term_named(term)
    number = {"d": DOUBLE, "f": SINGLE}.get(np.dtype(dtype).char)
    if number is None:
        raise ArgumentError(f"export_c: dtype float64 or float32 expected, got {np.dtype(dtype)}")
    own = choice("export_c: math", math, ("libm", "own")) == "own"
    name = c_identifier(f"{robot.name}_{term}") if name is None else name
    if not isinstance(name, str) or not is_c_identifier(name):
        raise ArgumentError(f"export_c: {name!r} is no C identifier; {c_identifier(str(name))!r} would be one")
    settled = chosen.settled(robot, options)
    graph = trace(robot, chosen, settled)
    shape = chosen.shape(robot, **settled)
    size = int(np.prod(shape, dtype=int))
    kind = number.name
    arguments = [f"const {kind} {key}[{n}]" for key, n in zip(chosen.inputs, graph.sizes, strict=True)]
    signature = f"void {name}({', '.join(arguments)}, {kind} result[{size}])"
    detail = "".join(f", {key} {getattr(value, 'name', value)}" for key, value in sorted(settled.items()))
    about = c_comment(f"{term} of {robot.name}{detail}: result of shape {shape}, row by row. SI units, radians.")
    about = f"/* {about} */\n"
    made = c_code.written(graph, list(chosen.inputs), name, number, own=own)
    guard = f"DUALPIN_{name}_H"  # in its own case: names may differ by nothing else
    header = f"{about}{_costs(name, made)}#ifndef {guard}\n#define {guard}\n\n{_LINKAGE}\n{signature};\n\n#endif\n"
    body = "\n".join(f"    {x}" for x in made.body)
    needs = "" if own else "#include <math.h>\n\n"
    before = "\n".join([c_code.MACRO, *made.before])
    source = f'{about}#include "{name}.h"\n\n{needs}{before}\n{signature}\n{{\n{body}\n}}\n'
    code = CCode(name, header, source, _test(robot, chosen, graph, name, number), made.operations, made.stack)
    if folder is not None:
        code.write(folder)
    return code


_LINKAGE = '#ifdef __cplusplus\nextern "C"\n#endif'


def _costs(name: str, made: c_code.Program) -> str:
    """The cost of a call, as stated in the header."""
    each = ", ".join(f"{n} {what}" for what, n in made.operations.items() if n)
    inner = "".join(f" {helper} does at most {n} operations." for helper, n in made.costs.items())
    return (
        f"/* A call does {each or 'no operations'}, always, and takes at most {made.stack} bytes of the stack.{inner}\n"
        "   It keeps nothing, allocates nothing and does not call itself; the result may be one of the inputs. */\n"
    )


def _test(robot: Robot, term: Term, graph: Trace, name: str, number: Number) -> str:
    """A program that computes one example."""
    q, v, a = robot.sample(seed=0)
    rng = np.random.default_rng(0)
    known = {"v": v, "a": a}
    inputs = [
        (q if x.configuration else known.get(x.name, rng.uniform(-1, 1, x.size(robot)))).ravel().tolist()
        for x in term.arguments
    ]
    expected, bound = c_code.example(graph, inputs, number)
    suffix = "f" if number is SINGLE else ""

    def array(what: str, values: Sequence[float]) -> str:
        numbers = ", ".join(f"{float(np.float32(x)) if suffix else x!r}{suffix}" for x in values)
        return f"static const {number.name} {what}[{max(1, len(values))}] = {{ {numbers or '0'} }};"

    size = len(expected)
    return f"""/* One example of {name}: returns 0 if it comes out right. */
#include "{name}.h"

#include <stdio.h>

{chr(10).join(array(f"{name}_given_{key}", x) for key, x in zip(term.inputs, inputs, strict=True))}
{array(f"{name}_expected", expected)}
static {number.name} {name}_result[{max(1, size)}];

int main(void)
{{
    double {name}_worst = 0.0;
    int {name}_i;
    {name}({", ".join([*(f"{name}_given_{key}" for key in term.inputs), f"{name}_result"])});
    for ({name}_i = 0; {name}_i < {size}; {name}_i++)
    {{
        const double {name}_error = (double){name}_result[{name}_i] - (double){name}_expected[{name}_i];
        const double {name}_distance = ({name}_error < 0.0) ? -{name}_error : {name}_error;
        {name}_worst = ({name}_distance <= {name}_worst) ? {name}_worst : {name}_distance;
    }}
    (void)printf("{name}: %g of %g\\n", {name}_worst, {bound!r});
    return ({name}_worst <= {bound!r}) ? 0 : 1;
}}
"""


def _decimals(robot: Robot, entry: Any) -> Any:
    """A formula with decimals of up to fifteen digits in place of fractions that came from decimals.

    If all constants of a robot are symbols and whole numbers, only gravity can be a decimal; fractions made by the
    algorithms are halves and quarters, and remain.
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
