"""Writing tables: aligned text, CSV, Markdown, LaTeX, YAML, and numbers in full."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Sequence
from math import floor, log10, pi
from os import PathLike
from typing import Any

from .. import escape
from ..arguments import count
from ..errors import ArgumentError
from ..files import write_text

Rows = Sequence[Sequence[str]]


def write(path: str | PathLike[str], text: str) -> None:
    """A file of this text, or an error that names it."""
    try:
        write_text(path, text)
    except (OSError, TypeError) as e:
        reason = (isinstance(e, OSError) and e.strerror) or e
        raise ArgumentError(f"export: {path} cannot be written ({reason})") from None


def number(x: float, digits: int | None = None) -> str:
    """x with as many digits as it takes to read the same number back, or with `digits` significant ones."""
    x = float(x) + 0.0  # no negative zero
    return repr(x) if digits is None else f"{x:.{digits}g}"


ROUNDING = 1e-15
"""Rounding of numbers of size one in double precision, the default residual."""


def tidy(x: float, residual: float = 0.0, digits: int | None = None) -> str:
    """x for people: what is below the residual of a table is rounded off, and zeros at the end are left out.

    Examples
    --------
    >>> from dualpin.forms.text import tidy
    >>> tidy(0.3839999999999999), tidy(-3e-17), tidy(1.5707963267948966), tidy(90.00000000000001, 1e-13)
    ('0.384', '0', '1.570796326794897', '90')
    """
    if digits is not None:
        return number(x, digits)
    x = float(x)
    level = max(residual, ROUNDING, abs(x) * 2.0**-52)
    places = max(0, floor(-log10(level)))
    value = round(x, places) + 0.0
    if 0.0 < abs(value) < 1e-4:
        return f"{value:.{max(1, places + floor(log10(abs(value))) + 1)}g}"
    text = f"{value:.{places}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def scientific(x: str) -> str:
    r"""A number as LaTeX writes it: 1e-05 as 1 \cdot 10^{-5}."""
    mantissa, e, exponent = x.partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if e else x


def checked_digits(digits: int | None) -> None:
    if digits is not None:
        count("export: digits", digits, 1, 17)


def with_pi(x: float, digits: int | None, symbol: str) -> str:
    """Multiples of pi / 4, exact to the last bit, as such; other numbers as they are."""
    for k in (1, 2, 3, 4):
        if abs(x) == k * pi / 4:
            numerator, denominator = {1: ("", "/4"), 2: ("", "/2"), 3: ("3*", "/4"), 4: ("", "")}[k]
            if symbol != "pi":
                numerator = numerator.replace("*", "")
            return f"{'-' if x < 0 else ''}{numerator}{symbol}{denominator}"
    return number(x, digits)


def aligned(header: Sequence[str], rows: Rows) -> str:
    """Columns padded to one width, numbers to the right."""
    cells = [[escape.line(c) for c in row] for row in (header, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(header))]
    lines = ["  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in cells]
    return "\n".join([lines[0], "-" * max(map(len, lines)), *lines[1:]])


def markdown(header: Sequence[str], rows: Rows) -> str:
    """A Markdown table; special characters in names are escaped."""
    lines = [header, ["---:"] * len(header), *([escape.markdown(str(c)) for c in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def comma_separated(header: Sequence[str], rows: Rows) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([escape.csv_cell(c) for c in row] for row in rows)
    return out.getvalue()


def latex(columns: str, header: Sequence[str], rows: Rows) -> str:
    """A tabular environment that needs no packages."""
    body = [" & ".join(row) + r" \\" for row in rows]
    head = " & ".join(header) + r" \\"
    return "\n".join(
        [rf"\begin{{tabular}}{{{columns}}}", r"\hline", head, r"\hline", *body, r"\hline", r"\end{tabular}"]
    )


def rounded(data: Any, digits: int | None) -> Any:
    """Nested data with every float to `digits` significant digits."""
    if isinstance(data, float):
        return float(number(data, digits))
    if isinstance(data, dict):
        return {k: rounded(v, digits) for k, v in data.items()}
    return [rounded(v, digits) for v in data] if isinstance(data, (list, tuple)) else data


def yaml(data: Any, indent: int = 0) -> str:
    """Nested dicts and lists of scalars as YAML 1.1."""
    pad, lines = "  " * indent, []
    if isinstance(data, dict):
        for key, value in data.items():
            if isinstance(value, (dict, list)) and value and not _flat(value):
                lines += [f"{pad}{_key(key)}:", yaml(value, indent + 1)]
            else:
                lines.append(f"{pad}{_key(key)}: {_scalar(value)}")
    else:
        for value in data:
            if isinstance(value, dict):
                block = yaml(value, indent + 1)
                lines.append(f"{pad}- {block.lstrip()}")
            else:
                lines.append(f"{pad}- {_scalar(value)}")
    return "\n".join(lines)


def _flat(value: Any) -> bool:
    return isinstance(value, list) and not any(isinstance(v, (dict, list)) for v in value)


def _key(name: str) -> str:
    """A key as it is where YAML takes it for a string, else in quotes."""
    simple = re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) and name.lower() not in _YAML_WORDS
    return name if simple else escape.yaml_string(name)


_YAML_WORDS = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def _scalar(x: Any) -> str:
    if isinstance(x, list):
        return "[" + ", ".join(map(_scalar, x)) + "]"
    if isinstance(x, float):  # YAML 1.1 wants a point in the mantissa
        text = repr(x)
        return text if "." in text or "e" not in text else text.replace("e", ".0e")
    return escape.yaml_string(x) if isinstance(x, str) else json.dumps(x)


def array(name: str, values: Any, brackets: str, digits: int | None) -> str:
    """A matrix as source text: `brackets` "python" or "matlab"."""
    rows = [[number(x, digits) for x in row] for row in values]
    if brackets == "matlab":
        return f"{name} = [" + ";\n    ".join(" ".join(row) for row in rows) + "];"
    return f"{name} = np.array([\n" + "".join(f"    [{', '.join(row)}],\n" for row in rows) + "])"
