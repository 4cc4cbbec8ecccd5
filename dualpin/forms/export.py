"""Denavit-Hartenberg tables as text in many formats."""

from __future__ import annotations

from math import degrees as in_degrees
from typing import TYPE_CHECKING, Any

from ..arguments import choice
from ..errors import ArgumentError
from ..escape import json_text, line, matlab_string, tex
from . import text
from .chain import KINDS

if TYPE_CHECKING:
    from .khalil import KhalilTable
    from .table import DHRow, DHStep, DHTable

FORMATS = ("table", "csv", "json", "yaml", "markdown", "latex", "python", "matlab")
COLUMNS = ("theta", "d", "a", "alpha")
PLAIN = ("table", "csv", "json", "yaml", "markdown", "latex")


def dh_text(table: DHTable, format: str, degrees: bool, digits: int | None) -> str:
    """A table in one of the formats."""
    choice("export: format", format, FORMATS)
    text.checked_digits(digits)
    if format in ("json", "yaml"):
        data = text.rounded(_data(table, degrees), digits)
        return json_text(data) if format == "json" else text.yaml(data)
    if format in ("python", "matlab"):
        return _toolbox(table, format, digits)
    if format == "csv":
        unit = "_deg" if degrees else ""
        header = ("row", "joint", "kind", f"theta{unit}", "d", "a", f"alpha{unit}", "pitch")
        return text.comma_separated(header, _cells(table, degrees, digits))
    if format == "latex":
        return _latex(table, degrees, digits)
    before = "[i-1]" if table.convention == "modified" else ""
    angle = "deg" if degrees else "rad"
    titles = ("row", "joint", "kind", f"theta [{angle}]", "d [m]", f"a{before} [m]", f"alpha{before} [{angle}]")
    if format == "markdown":
        return text.markdown(titles, [row[:7] for row in _cells(table, degrees, digits)])
    order = "X(alpha, a) Z(theta, d)" if before else "Z(theta, d) X(alpha, a)"
    title = f"{line(caption(table))}, row = {order}"
    notes = [residual_line(table), *(f"note: {line(n)}" for n in table.notes)]
    return "\n".join([title, text.aligned(titles, display(table, degrees, digits)), *notes])


def caption(table: DHTable) -> str:
    """Title of the table: the robot, base and tip link, and the convention."""
    ends = f" from {table.chain.base.name} to {table.chain.tip.name}" if table.chain else ""
    return f"{table.name}{ends}: Denavit-Hartenberg, {table.convention}"


def residual_line(table: DHTable) -> str:
    """How far the table is from the robot."""
    return f"residual {table.residual:.1e}: the largest entry by which poses of table and robot differ, of 16 random q"


def display(table: DHTable, degrees: bool = False, digits: int | None = None) -> list[list[str]]:
    """row, joint, kind, theta, d, a, alpha for people: what is below the residual is rounded off (exports are not)."""
    turn = in_degrees(1.0) if degrees else 1.0

    def values(step: DHStep) -> list[str]:
        sizes = (turn * table.residual, table.residual) * 2
        four = zip(_four(step, degrees), (sizes[0], sizes[1], sizes[1], sizes[0]), strict=True)
        return [text.tidy(x, size, digits) for x, size in four]

    def end(name: str, steps: tuple[DHStep, ...]) -> list[list[str]]:
        several = len(steps) > 1
        return [
            [f"{name} {k} of {len(steps)}" if several else name, "", "", *values(s)] for k, s in enumerate(steps, 1)
        ]

    rows = [[str(i), row.joint or "", row.letter, *values(row)] for i, row in enumerate(table.rows, 1)]
    return [*end("base", table.base.steps), *rows, *end("tool", table.tool.steps)]


def _four(step: DHStep, degrees: bool) -> list[float]:
    turn = in_degrees if degrees else float
    return [turn(step.theta), step.d, step.a, turn(step.alpha)]


def _cells(table: DHTable, degrees: bool, digits: int | None) -> list[list[str]]:
    """row, joint, kind, theta, d, a, alpha, pitch as text; base and tool too."""

    def values(step: DHStep) -> list[str]:
        return [text.number(x, digits) for x in _four(step, degrees)]

    cells = [["base", "", "", *values(s), ""] for s in table.base.steps]
    for i, row in enumerate(table.rows, 1):
        pitch = text.number(row.pitch, digits) if row.letter == "H" else ""
        cells.append([str(i), row.joint or "", row.letter, *values(row), pitch])
    return cells + [["tool", "", "", *values(s), ""] for s in table.tool.steps]


def _data(table: DHTable, degrees: bool) -> dict[str, Any]:
    def four(step: DHStep) -> dict[str, Any]:
        return dict(zip(COLUMNS, (x + 0.0 for x in _four(step, degrees)), strict=True))

    def one(row: DHRow) -> dict[str, Any]:
        extra: dict[str, Any] = {"q": list(row.q)}
        if row.factors != (1.0,) * len(row.q):
            extra["factors"] = list(row.factors)
        if row.letter == "H":
            extra["pitch"] = row.pitch
        return {"joint": row.joint, "kind": KINDS[row.letter], **four(row), **extra}

    return {
        "robot": table.name,
        "convention": table.convention,
        "angles": "deg" if degrees else "rad",
        "lengths": "m",
        "base": [four(s) for s in table.base.steps],
        "rows": [one(row) for row in table.rows],
        "tool": [four(s) for s in table.tool.steps],
        "residual": table.residual,
        "notes": list(table.notes),
    }


def _latex(table: DHTable, degrees: bool, digits: int | None) -> str:
    index = "{i-1}" if table.convention == "modified" else "i"
    angle = r"$^\circ$" if degrees else "rad"
    header = [
        "$i$", "joint", rf"$\theta_i$ [{angle}]", "$d_i$ [m]", f"$a_{index}$ [m]", rf"$\alpha_{index}$ [{angle}]",
    ]  # fmt: skip

    def angle_of(x: float) -> str:
        return text.scientific(text.number(x, digits) if degrees else text.with_pi(x, digits, r"\pi"))

    def length_of(x: float) -> str:
        return text.scientific(text.number(x, digits))

    def values(step: DHStep, symbols: tuple[str, str] = ("", "")) -> list[str]:
        theta, d, a, alpha = _four(step, degrees)
        shown = [_sum(symbols[0], angle_of(theta)), _sum(symbols[1], length_of(d))]
        return [f"${x}$" for x in (*shown, length_of(a), angle_of(alpha))]

    rows = [["base", "", *values(s)] for s in table.base.steps]
    for i, row in enumerate(table.rows, 1):
        symbol = {
            "R": (f"q_{{{i}}}", ""), "P": ("", f"q_{{{i}}}"), "C": (rf"\vartheta_{{{i}}}", f"s_{{{i}}}"),
            "H": (f"q_{{{i}}}", f"{length_of(row.pitch)}\\,q_{{{i}}}"), "F": ("", ""),
        }[row.letter]  # fmt: skip
        rows.append([str(i), tex(row.joint or "fixed"), *values(row, symbol)])
    rows += [["tool", "", *values(s)] for s in table.tool.steps]
    return text.latex("rlrrrr", header, rows)


def _sum(symbol: str, constant: str) -> str:
    if not symbol:
        return constant
    if constant == "0.0" or constant == "0":
        return symbol
    return f"{symbol} - {constant[1:]}" if constant.startswith("-") else f"{symbol} + {constant}"


# --- code for the Robotics Toolboxes ---------------------------------------------------------------


def _toolbox(table: DHTable, language: str, digits: int | None) -> str:
    """Links of the table in order; a cylindrical row becomes a revolute and a prismatic link."""
    links: list[str] = []
    notes = [f"q({k + 1}) = 0 always: {why}" for k, why in _still(table)] if language == "matlab" else [
        f"q[{k}] = 0 always: {why}" for k, why in _still(table)
    ]  # fmt: skip
    write = _python_link if language == "python" else _matlab_link
    for row in table.rows:
        if row.letter == "H":
            raise ArgumentError(f"export: joint {row.joint!r} is helical, which the Robotics Toolbox has not")
        if any(f != 1.0 for f in row.factors):
            notes.append(f"joint {row.joint} follows: its value is {row.factors[0]!r} times its leader's")
        theta, d, a, alpha = row.theta, row.d, row.a, row.alpha
        if row.letter == "C":
            # standard: turn, then slide and X;   modified: X and turn, then slide
            first, second = ((0.0, 0.0), (a, alpha)) if table.convention == "standard" else ((a, alpha), (0.0, 0.0))
            links.append(write(table, "R", theta, 0.0, *first, f"{row.joint}: angle", False, digits))
            links.append(write(table, "P", 0.0, d, *second, f"{row.joint}: slide", False, digits))
            continue
        kind = "P" if row.letter == "P" else "R"
        links.append(write(table, kind, theta, d, a, alpha, row.joint or "fixed", row.letter == "F", digits))
    return (_python if language == "python" else _matlab)(table, links, notes, digits)


def _still(table: DHTable) -> list[tuple[int, str]]:
    at, found = 0, []
    for row in table.rows:
        if row.letter == "F":
            found.append((at, "a fixed row between nearly parallel axes"))
        at += 2 if row.letter == "C" else 1
    return found


def _arguments(theta: float, d: float, a: float, alpha: float, kind: str, digits: int | None) -> list[tuple[str, str]]:
    angle = {"theta": text.with_pi(theta, digits, "pi"), "alpha": text.with_pi(alpha, digits, "pi")}
    own = [("d", text.number(d, digits)), ("offset", angle["theta"])]
    if kind == "P":
        own = [("theta", angle["theta"]), ("offset", text.number(d, digits))]
    return [own[0], ("a", text.number(a, digits)), ("alpha", angle["alpha"]), own[1]]


def _python_link(
    table: DHTable,
    kind: str,
    theta: float,
    d: float,
    a: float,
    alpha: float,
    name: str,
    fixed: bool,
    digits: int | None,
) -> str:
    kind_name = ("Revolute" if kind == "R" else "Prismatic") + ("DH" if table.convention == "standard" else "MDH")
    given = ", ".join(f"{k}={v}" for k, v in _arguments(theta, d, a, alpha, kind, digits))
    still = ", qlim=[0.0, 0.0]" if fixed else ""
    return f"        {kind_name}({given}{still}),  # {line(name)}"


def _matlab_link(
    table: DHTable,
    kind: str,
    theta: float,
    d: float,
    a: float,
    alpha: float,
    name: str,
    fixed: bool,
    digits: int | None,
) -> str:
    given = ", ".join(f"'{k}', {v}" for k, v in _arguments(theta, d, a, alpha, kind, digits))
    still = ", 'qlim', [0 0]" if fixed else ""
    joint = "revolute" if kind == "R" else "prismatic"
    return f"    Link('{joint}', {given}{still}, '{table.convention}')  % {line(name)}"


def _python(table: DHTable, links: list[str], notes: list[str], digits: int | None) -> str:
    return "\n".join([
        "from math import pi", "", "import numpy as np",
        "from roboticstoolbox import DHRobot, PrismaticDH, PrismaticMDH, RevoluteDH, RevoluteMDH",
        "from spatialmath import SE3", "",
        *(f"# {line(note)}" for note in notes),
        text.array("base", table.base.matrix, "python", digits),
        text.array("tool", table.tool.matrix, "python", digits),
        "robot = DHRobot(", "    [", *links, "    ],", f"    name={table.name!r},",
        "    base=SE3(base, check=False),", "    tool=SE3(tool, check=False),", ")", "",
    ])  # fmt: skip


def _matlab(table: DHTable, links: list[str], notes: list[str], digits: int | None) -> str:
    return "\n".join([
        *(f"% {line(note)}" for note in notes),
        text.array("base", table.base.matrix, "matlab", digits),
        text.array("tool", table.tool.matrix, "matlab", digits),
        "links = [", *links, "];",
        f"robot = SerialLink(links, 'name', {matlab_string(table.name)}, 'base', base, 'tool', tool);", "",
    ])  # fmt: skip


# --- trees -------------------------------------------------------------------------------------------


def khalil_text(table: KhalilTable, format: str, degrees: bool, digits: int | None) -> str:
    """A Khalil-Kleinfinger table in one of the formats."""
    choice("export: format", format, PLAIN)
    text.checked_digits(digits)
    turn = in_degrees if degrees else float
    names = ("gamma", "b", "alpha", "d", "theta", "r")
    values = [[turn(r.gamma), r.b, turn(r.alpha), r.d, turn(r.theta), r.r] for r in table.rows]
    if format in ("json", "yaml"):
        data = {
            "robot": table.source.name, "convention": "khalil-kleinfinger", "angles": "deg" if degrees else "rad",
            "base": {"theta": turn(float(table.base.real)), "r": float(table.base.dual)}, "tips": table.tips,
            "rows": [
                {"number": r.number, "antecedent": r.antecedent, "sigma": r.sigma, "kind": KINDS[r.letter],
                 "name": r.name,
                 **dict(zip(names, (x + 0.0 for x in v), strict=True)), "q": list(r.q), "pitch": r.pitch}
                for r, v in zip(table.rows, values, strict=True)
            ],
        }  # fmt: skip
        data = text.rounded(data, digits)
        return json_text(data) if format == "json" else text.yaml(data)
    cells = [
        [str(r.number), str(r.antecedent), r.letter, r.name, *(text.number(x, digits) for x in v)]
        for r, v in zip(table.rows, values, strict=True)
    ]
    header = ["j", "a(j)", "kind", "joint", *names]
    if format == "csv":
        unit = "_deg" if degrees else ""
        return text.comma_separated([h + unit if h in ("gamma", "alpha", "theta") else h for h in header], cells)
    if format == "markdown":
        return text.markdown(header, cells)
    if format == "latex":
        symbols = [r"$\gamma$", "$b$", r"$\alpha$", "$d$", r"$\theta$", "$r$"]
        return text.latex("rrllrrrrrr", ["$j$", "$a(j)$", "kind", "joint", *symbols], [
            [*row[:3], tex(row[3]), *(f"${text.scientific(x)}$" for x in row[4:])] for row in cells
        ])  # fmt: skip
    angle = "deg" if degrees else "rad"
    return (
        f"{line(table.source.name)}: Khalil-Kleinfinger, Z(gamma, b) X(alpha, d) Z(theta, r), {angle} and m\n"
        + text.aligned(header, cells)
    )
